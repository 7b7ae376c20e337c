//! Patterns by what one cell of a lattice holds, and exemplars cut out of them.

use arabesque_core::{Bounds, Class, Contents, Curve, Element, Exemplar, Outline, Path, Role, Similarity, Vector};

/// A closed shape.
#[derive(Clone, Debug)]
pub(crate) struct Motif {
    pub(crate) ring: Vec<Vector<2>>,
    pub(crate) class: usize,
}

/// A piece of a stroke; pieces of one style whose ends meet are one line.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) points: Vec<Vector<2>>,
    pub(crate) style: usize,
}

/// What the cells of a lattice hold.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub(crate) vectors: [Vector<2>; 2],
    pub(crate) motifs: Vec<Motif>,
    pub(crate) pieces: Vec<Piece>,
}

pub(crate) fn xy(x: f64, y: f64) -> Vector<2> {
    Vector::xy(x, y)
}

pub(crate) fn polygon(centre: Vector<2>, radius: f64, corners: usize, start: f64) -> Vec<Vector<2>> {
    let at = |k: usize| std::f64::consts::TAU * k as f64 / corners as f64 + start;
    (0..corners).map(|k| centre + xy(at(k).cos(), at(k).sin()) * radius).collect()
}

pub(crate) fn rectangle(min: Vector<2>, max: Vector<2>) -> Vec<Vector<2>> {
    vec![min, xy(max[0], min[1]), max, xy(min[0], max[1])]
}

/// A number in [-1, 1] that looks random, the same each time.
pub(crate) fn noise(i: i64, j: i64, k: u64) -> f64 {
    let mut x =
        (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (j as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F) ^ (k << 17);
    for _ in 0..3 {
        x ^= x >> 31;
        x = x.wrapping_mul(0x9FB2_1C65_1E98_DF25);
        x ^= x >> 27;
    }
    (x % 2_000_001) as f64 / 1e6 - 1.0
}

impl Pattern {
    pub(crate) fn of_motifs(vectors: [Vector<2>; 2], motifs: Vec<Motif>) -> Self {
        Self { vectors, motifs, pieces: Vec::new() }
    }

    pub(crate) fn of_pieces(vectors: [Vector<2>; 2], pieces: Vec<Piece>) -> Self {
        Self { vectors, motifs: Vec::new(), pieces }
    }

    /// Larger or smaller.
    pub(crate) fn scaled(&self, by: f64) -> Self {
        let map = |points: &[Vector<2>]| points.iter().map(|p| *p * by).collect();
        Self {
            vectors: self.vectors.map(|v| v * by),
            motifs: self.motifs.iter().map(|m| Motif { ring: map(&m.ring), class: m.class }).collect(),
            pieces: self.pieces.iter().map(|p| Piece { points: map(&p.points), style: p.style }).collect(),
        }
    }

    pub(crate) fn shorter(&self) -> f64 {
        self.vectors[0].norm().min(self.vectors[1].norm())
    }

    pub(crate) fn at(&self, node: [i64; 2]) -> Vector<2> {
        self.vectors[0] * node[0] as f64 + self.vectors[1] * node[1] as f64
    }

    /// The nodes whose cells may reach into a box.
    pub(crate) fn nodes(&self, bounds: &Bounds<2>) -> Vec<[i64; 2]> {
        let [a, b] = self.vectors;
        let points = self.motifs.iter().flat_map(|m| &m.ring).chain(self.pieces.iter().flat_map(|p| &p.points));
        let content = Bounds::around(points.copied());
        let measure = a.cross(b);
        let room = Bounds::new(bounds.min - content.max, bounds.max - content.min);
        let corners = rectangle(room.min, room.max);
        let range = |k: usize| {
            let of = |v: &Vector<2>| if k == 0 { v.cross(b) / measure } else { a.cross(*v) / measure };
            let low = corners.iter().map(of).fold(f64::INFINITY, f64::min).floor() as i64;
            let high = corners.iter().map(of).fold(f64::NEG_INFINITY, f64::max).ceil() as i64;
            low..=high
        };
        range(0).flat_map(|i| range(1).map(move |j| [i, j])).collect()
    }

    /// Outlines that reach into a box, with their classes.
    pub(crate) fn outlines(&self, bounds: &Bounds<2>) -> Vec<(Outline<2>, usize)> {
        let mut found = Vec::new();
        for node in self.nodes(bounds) {
            let by = self.at(node);
            for motif in &self.motifs {
                let ring: Vec<_> = motif.ring.iter().map(|&p| p + by).collect();
                let outline = Outline { rings: vec![ring] };
                if outline.bounds().intersects(bounds) {
                    found.push((outline, motif.class));
                }
            }
        }
        found
    }

    /// Lines in a box, cut at its edges, with their styles.
    pub(crate) fn lines(&self, bounds: &Bounds<2>) -> Vec<(Vec<Vector<2>>, usize)> {
        let mut whole: Vec<(Vec<Vector<2>>, usize)> = Vec::new();
        for node in self.nodes(bounds) {
            let by = self.at(node);
            whole.extend(self.pieces.iter().map(|p| (p.points.iter().map(|&q| q + by).collect(), p.style)));
        }
        let joined = join(whole, 1e-6 * self.shorter());
        joined.into_iter().flat_map(|(line, style)| cut(&line, bounds).into_iter().map(move |l| (l, style))).collect()
    }

    /// What a frame shows.
    pub(crate) fn exemplar(&self, window: Bounds<2>) -> Exemplar<2> {
        let outlines = self.outlines(&window);
        exemplar(&outlines, &self.lines(&window), window)
    }
}

/// Colours of classes.
const COLOURS: [[f64; 3]; 6] =
    [[0.1, 0.1, 0.1], [0.8, 0.2, 0.2], [0.2, 0.6, 0.3], [0.2, 0.3, 0.8], [0.9, 0.8, 0.2], [0.6, 0.2, 0.6]];

/// An exemplar of outlines and lines in a frame. What the frame cuts is context.
pub(crate) fn exemplar(
    outlines: &[(Outline<2>, usize)],
    lines: &[(Vec<Vector<2>>, usize)],
    window: Bounds<2>,
) -> Exemplar<2> {
    let frame = Outline { rings: vec![rectangle(window.min, window.max)] };
    let slack = window.grown(1e-9 * window.size().norm());
    let mut elements = Vec::new();
    for (outline, class) in outlines {
        let is_whole = outline.points().all(|p| slack.contains(p));
        let shown = if is_whole { outline.clone() } else { outline.intersection(&frame) };
        let Some(centre) = shown.centroid().filter(|_| shown.area() > 1e-6 * outline.area()) else { continue };
        let role = if is_whole { Role::Source } else { Role::Context };
        let pose = Similarity::shift(centre);
        elements.push(Element {
            class: *class,
            centre,
            pose,
            outline: shown,
            colour: COLOURS[*class],
            lean: [Vector::ZERO; 3],
            role,
        });
    }
    let curve = |(points, style): &(Vec<Vector<2>>, usize)| Curve {
        path: Path::polyline(points),
        style: *style,
        width: 0.001 * window.size().norm(),
        colour: COLOURS[*style],
    };
    let names = |count: usize| (0..count).map(|k| Class { name: k.to_string() }).collect();
    let contents = Contents {
        elements,
        classes: names(COLOURS.len()),
        curves: lines.iter().map(curve).collect(),
        styles: names(COLOURS.len()),
        ..Contents::default()
    };
    Exemplar::with_curves("drawing", contents, window).unwrap()
}

/// Joins lines of one style where exactly two ends meet.
fn join(lines: Vec<(Vec<Vector<2>>, usize)>, slack: f64) -> Vec<(Vec<Vector<2>>, usize)> {
    let ends: Vec<Vector<2>> = lines.iter().flat_map(|(l, _)| [l[0], l[l.len() - 1]]).collect();
    let bounds = Bounds::around(ends.iter().copied()).grown(1.0);
    let index = arabesque_core::GridIndex::new(&ends, slack, &arabesque_core::Domain::Box(bounds));
    let partner = |e: usize| {
        let mut near = Vec::new();
        index.within(ends[e], slack, |k, _| near.push(k));
        near.retain(|&k| k != e && lines[k / 2].1 == lines[e / 2].1);
        match near[..] {
            [one] => Some(one),
            _ => None,
        }
    };
    let mut used = vec![false; lines.len()];
    let mut joined = Vec::new();
    for k in 0..lines.len() {
        if used[k] {
            continue;
        }
        // Back to the first piece, then along.
        let (mut end, mut count) = (2 * k, 0);
        while let Some(before) = partner(end).filter(|&b| b / 2 != k && count < lines.len()) {
            (end, count) = (before ^ 1, count + 1);
        }
        let mut points = Vec::new();
        loop {
            used[end / 2] = true;
            let piece = &lines[end / 2].0;
            let way: Vec<_> = if end % 2 == 0 { piece.clone() } else { piece.iter().rev().copied().collect() };
            points.extend(way.into_iter().skip(usize::from(!points.is_empty())));
            match partner(end ^ 1) {
                Some(next) if !used[next / 2] => end = next,
                _ => break,
            }
        }
        joined.push((points, lines[k].1));
    }
    joined
}

/// The parts of a line that lie in a box.
pub(crate) fn cut(line: &[Vector<2>], bounds: &Bounds<2>) -> Vec<Vec<Vector<2>>> {
    let mut parts: Vec<Vec<Vector<2>>> = Vec::new();
    for w in line.windows(2) {
        let (a, d) = (w[0], w[1] - w[0]);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for k in 0..2 {
            let (low, high) = ((bounds.min[k] - a[k]) / d[k], (bounds.max[k] - a[k]) / d[k]);
            if d[k] == 0.0 {
                if a[k] < bounds.min[k] || a[k] > bounds.max[k] {
                    to = -1.0;
                }
            } else {
                from = from.max(low.min(high));
                to = to.min(low.max(high));
            }
        }
        if to <= from {
            continue;
        }
        let (p, q) = (if from <= 0.0 { w[0] } else { a + d * from }, if to >= 1.0 { w[1] } else { a + d * to });
        match parts.last_mut() {
            Some(part) if from <= 0.0 && part.last() == Some(&p) => part.push(q),
            _ => parts.push(vec![p, q]),
        }
    }
    parts
}
