//! Patterns of our own, and what spoils them.

use arabesque_core::{
    Bounds, Class, Contents, Curve, Element, Exemplar, Matrix, Outline, Path, Role, Similarity, Stage, Stream, Vector,
};

/// Sides of exemplars and pages.
pub(crate) const SMALL: f64 = 240.0;
pub(crate) const LARGE: f64 = 600.0;
/// Least distance of the middles of things.
const CORE: f64 = 20.0;

/// A thing that is drawn: a flag on a pole (class 0) or a disc (class 1).
#[derive(Clone, Copy)]
pub(crate) struct Thing {
    pub(crate) class: usize,
    pub(crate) at: Vector<2>,
    pub(crate) turn: f64,
}

/// What spoils a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spoil {
    Holes,
    Jitter,
    Overlap,
    Turned,
    Pasted,
}

fn shape(thing: &Thing) -> Outline<2> {
    let flag = [(0.0, 0.0), (1.2, 0.0), (1.2, 6.0), (8.0, 4.5), (1.2, 9.0), (1.2, 12.0), (0.0, 12.0)];
    let disc = (0..24_u32).map(|k| {
        let turn = f64::from(k) / 24.0 * std::f64::consts::TAU;
        Vector::xy(turn.cos(), turn.sin()) * 5.0
    });
    let ring: Vec<Vector<2>> =
        if thing.class == 0 { flag.map(|(x, y)| Vector::xy(x - 2.5, y - 6.0)).to_vec() } else { disc.collect() };
    let motion = Similarity::about(Vector::ZERO, thing.at, Matrix::rotation(thing.turn), 1.0);
    Outline { rings: vec![ring] }.transformed(&motion)
}

/// Things thrown at random, none near to another, until hardly any finds room.
pub(crate) fn tossed(seed: u64, side: f64) -> Vec<Thing> {
    let mut random = Stream::new(seed, Stage::TEST, 0);
    let mut things: Vec<Thing> = Vec::new();
    let mut missed = 0;
    while missed < 3000 {
        // Beyond the border as well, where nothing would be in the way otherwise.
        let (low, high) = (-2.0 * CORE, side + 2.0 * CORE);
        let at = Vector::xy(random.range(low, high), random.range(low, high));
        if things.iter().any(|t| (t.at - at).norm() < CORE) {
            missed += 1;
            continue;
        }
        missed = 0;
        let class = usize::from(random.unit() < 0.4);
        things.push(Thing { class, at, turn: random.range(-0.12, 0.12) });
    }
    things.retain(|t| (0..2).all(|k| (0.0..side).contains(&t.at[k])));
    things
}

/// Things as what is measured.
pub(crate) fn drawn(things: &[Thing], side: f64) -> Exemplar<2> {
    let first = things.iter().find(|t| t.class == 0).map_or(0.0, |t| t.turn);
    let element = |thing: &Thing| {
        let outline = shape(thing);
        let turn = if thing.class == 0 { thing.turn - first } else { 0.0 };
        Element {
            class: thing.class,
            centre: outline.centroid().unwrap(),
            pose: Similarity { rotation: Matrix::rotation(turn), ..Similarity::identity() },
            outline,
            colour: [[0.1, 0.3, 0.6], [0.8, 0.2, 0.1]][thing.class],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    };
    let classes = ["flag", "disc"].map(|name| Class { name: name.into() }).to_vec();
    let window = Bounds::new(Vector::ZERO, Vector::splat(side));
    Exemplar::new("tossed", things.iter().map(element).collect(), classes, window).unwrap()
}

/// A page of things, spoiled.
pub(crate) fn spoiled(things: &[Thing], exemplar: &[Thing], how: Spoil) -> Vec<Thing> {
    let mut random = Stream::new(9, Stage::TEST, how as u64);
    match how {
        Spoil::Holes => {
            let holes: Vec<Vector<2>> =
                (0..5).map(|_| Vector::xy(random.range(80.0, 520.0), random.range(80.0, 520.0))).collect();
            things.iter().filter(|t| holes.iter().all(|h| (t.at - *h).norm() > 1.6 * CORE)).copied().collect()
        }
        Spoil::Jitter => {
            let off = |random: &mut Stream| random.range(-0.5, 0.5) * CORE;
            things.iter().map(|t| Thing { at: t.at + Vector::xy(off(&mut random), off(&mut random)), ..*t }).collect()
        }
        Spoil::Overlap => {
            let mut moved = things.to_vec();
            for k in (0..moved.len()).step_by(9) {
                let (at, others) = (moved[k].at, things.iter().enumerate().filter(|(j, _)| *j != k));
                let near = others.min_by(|a, b| (a.1.at - at).norm().total_cmp(&(b.1.at - at).norm())).unwrap().1.at;
                moved[k].at = at + (near - at) * 0.65;
            }
            moved
        }
        Spoil::Turned => {
            let turned = |(k, t): (usize, &Thing)| if k % 3 == 0 { Thing { turn: t.turn + 1.2, ..*t } } else { *t };
            things.iter().enumerate().map(turned).collect()
        }
        Spoil::Pasted => {
            let steps = (LARGE / SMALL).ceil() as usize;
            let shifts = (0..steps * steps).map(|k| Vector::xy((k % steps) as f64, (k / steps) as f64) * SMALL);
            let all = shifts.flat_map(|shift| exemplar.iter().map(move |t| Thing { at: t.at + shift, ..*t }));
            all.filter(|t| t.at[0] < LARGE && t.at[1] < LARGE).collect()
        }
    }
}

/// A net of strokes: a square grid whose nodes are moved a little, few edges missing.
pub(crate) fn net(seed: u64, side: f64) -> Vec<[Vector<2>; 2]> {
    let step = 20.0;
    let count = (side / step) as usize + 1;
    let mut random = Stream::new(seed, Stage::TEST, 1);
    let nodes: Vec<Vector<2>> = (0..count * count)
        .map(|k| {
            let jitter = Vector::xy(random.range(-5.0, 5.0), random.range(-5.0, 5.0));
            Vector::xy((k % count) as f64, (k / count) as f64) * step + jitter
        })
        .collect();
    let mut edges = Vec::new();
    for k in 0..nodes.len() {
        let right = (k % count + 1 < count).then_some(k + 1);
        let below = (k + count < nodes.len()).then_some(k + count);
        for other in [right, below].into_iter().flatten() {
            if random.unit() > 0.03 {
                edges.push([nodes[k], nodes[other]]);
            }
        }
    }
    edges
}

/// Strokes as what is measured.
pub(crate) fn stroked(edges: &[[Vector<2>; 2]], side: f64) -> Exemplar<2> {
    let curve = |edge: &[Vector<2>; 2]| Curve { path: Path::polyline(edge), style: 0, width: 1.0, colour: [0.0; 3] };
    let styles = vec![Class { name: "line".into() }];
    let contents = Contents { curves: edges.iter().map(curve).collect(), styles, ..Contents::default() };
    Exemplar::with_curves("net", contents, Bounds::new(Vector::ZERO, Vector::splat(side))).unwrap()
}
