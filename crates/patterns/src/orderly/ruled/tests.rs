#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use arabesque_core::{
    Bounds, Budget, Class, Contents, Curve, Domain, Exemplar, Path, Request, Stage, Stream, Unobserved, Vector, corners,
};

use super::Ruled;

const CELL: f64 = 10.0;

/// Strokes of one style in a frame of this side.
fn drawn(lines: Vec<Vec<Vector<2>>>, side: f64) -> Exemplar<2> {
    let curve = |line: Vec<Vector<2>>| Curve { path: Path::polyline(&line), style: 0, width: 1.0, colour: [0.0; 3] };
    let curves = lines.into_iter().map(curve).collect();
    let contents = Contents { curves, styles: vec![Class { name: "a".into() }], ..Contents::default() };
    Exemplar::with_curves("t", contents, Bounds::new(Vector::ZERO, Vector::xy(side, side))).unwrap()
}

/// A wall to the right of, or below, each of 10 by 10 nodes: no rings, since walls lead right and down alone.
fn walls() -> Exemplar<2> {
    let mut stream = Stream::new(5, Stage::TEST, 0);
    let nodes = (0..100).map(|k| Vector::xy(CELL * f64::from(k % 10), CELL * f64::from(k / 10)));
    let wall = |p: Vector<2>| {
        let step = if stream.unit() < 0.5 { Vector::xy(CELL, 0.0) } else { Vector::xy(0.0, CELL) };
        vec![p, p + step]
    };
    drawn(nodes.map(wall).collect(), 95.0)
}

fn lines(ruled: &Ruled, exemplar: &Exemplar<2>, domain: Domain<2>, seed: u64) -> Vec<Vec<Vector<2>>> {
    let request = Request { seed, ..Request::new(domain) };
    let outcome = ruled.fill(exemplar, &request, &mut Unobserved).unwrap().unwrap();
    outcome.curves.iter().map(|drawn| corners(&drawn.path).unwrap()).collect()
}

#[test]
fn walls_stay_on_their_lines_whatever_the_seed() {
    let exemplar = walls();
    let ruled = Ruled::new(&exemplar, &Budget::default()).unwrap().unwrap();
    let page = Bounds::new(Vector::ZERO, Vector::xy(205.0, 155.0));
    for seed in 0..5 {
        let made = lines(&ruled, &exemplar, Domain::Box(page), seed);
        assert!(made.len() > 50);
        for pair in made.iter().flat_map(|line| line.windows(2)) {
            let step = pair[1] - pair[0];
            assert!(step[0].abs() < 1e-9 || step[1].abs() < 1e-9, "{pair:?}");
            let k = usize::from(step[0].abs() > 1e-9);
            let steps = pair[0][1 - k.min(1)] / CELL;
            let across = if step[0].abs() < 1e-9 { pair[0][0] / CELL } else { pair[0][1] / CELL };
            assert!((across - across.round()).abs() < 1e-9, "{pair:?} {steps}");
        }
    }
    let again = |seed| lines(&ruled, &exemplar, Domain::Box(page), seed);
    assert_eq!(again(1), again(1));
    assert_ne!(again(1), again(2));
}

#[test]
fn no_ring_is_closed_where_the_exemplar_has_none() {
    let exemplar = walls();
    let ruled = Ruled::new(&exemplar, &Budget::default()).unwrap().unwrap();
    assert!(ruled.sheet.is_forest);
    let made = lines(&ruled, &exemplar, Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(300.0, 300.0))), 3);
    let mut steps = std::collections::BTreeSet::new();
    let node = |p: Vector<2>| p.0.map(|x| (x / CELL).round() as i64);
    for pair in made.iter().flat_map(|line| line.windows(2)) {
        let (a, b) = (node(pair[0]), node(pair[1]));
        let way = [(b[0] - a[0]).signum(), (b[1] - a[1]).signum()];
        let mut at = a;
        while at != b {
            let next = [at[0] + way[0], at[1] + way[1]];
            assert!(steps.insert((at.min(next), at.max(next))), "a step is drawn once");
            at = next;
        }
    }
    let mut nodes: Vec<[i64; 2]> = steps.iter().flat_map(|s| [s.0, s.1]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let mut sets = arabesque_core::DisjointSets::new(nodes.len());
    let mut rings = 0;
    for (a, b) in &steps {
        let [i, j] = [a, b].map(|n| nodes.binary_search(n).unwrap());
        if sets.of(i) == sets.of(j) {
            rings += 1;
        }
        sets.join(i, j);
    }
    assert!(rings * 100 <= steps.len(), "{rings} rings of {} steps", steps.len());
}

#[test]
fn slanted_lines_never_cross_where_they_never_do() {
    let mut stream = Stream::new(9, Stage::TEST, 0);
    let cells = (0..100).map(|k| (CELL * f64::from(k % 10), CELL * f64::from(k / 10)));
    let slanted = cells.map(|(x, y)| {
        let up = stream.unit() < 0.5;
        let (a, b) = if up { (y, y + CELL) } else { (y + CELL, y) };
        vec![Vector::xy(x, a), Vector::xy(x + CELL, b)]
    });
    let exemplar = drawn(slanted.collect(), 100.0);
    let ruled = Ruled::new(&exemplar, &Budget::default()).unwrap().unwrap();
    let made = lines(&ruled, &exemplar, Domain::Torus(Bounds::new(Vector::ZERO, Vector::xy(200.0, 160.0))), 1);
    let mut cells = std::collections::BTreeSet::new();
    for pair in made.iter().flat_map(|line| line.windows(2)) {
        let step = pair[1] - pair[0];
        let count = (step[0].abs() / CELL).round() as usize;
        for k in 0..count {
            let middle = pair[0] + step * ((k as f64 + 0.5) / count as f64);
            let cell = [(middle[0] / CELL).floor() as i64, (middle[1] / CELL).floor() as i64];
            assert!(cells.insert([cell[0].rem_euclid(20), cell[1].rem_euclid(16)]), "two lines in one cell: {cell:?}");
        }
    }
    assert!(cells.len() >= 288, "{} of 320 cells have their line", cells.len());
}

#[test]
fn strokes_that_bend_lie_on_no_paper() {
    let mut exemplar = walls();
    exemplar.curves[0].path.cubics[0][1] += Vector::xy(1.0, 1.0);
    assert!(Ruled::new(&exemplar, &Budget::default()).unwrap().is_none());
}
