//! Elements in their places while they are laid out and moved.

use arabesque_core::{Bounds, Buckets, Build, Domain, Matrix, Request, Vector};

use super::{form::Form, wall};

/// Elements, each as samples in a row.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies<const D: usize> {
    pub(super) points: Vec<Vector<D>>,
    pub(super) list: Vec<Body>,
}

/// An element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub(super) source: usize,
    /// Its first sample among the points.
    pub(super) first: usize,
    /// Size relative to its source.
    pub(super) scale: f64,
    /// Which kept element it is: then it stays where it is.
    pub(super) frozen: Option<usize>,
}

impl<const D: usize> Bodies<D> {
    pub(super) fn push(&mut self, source: usize, samples: &[Vector<D>], scale: f64, frozen: Option<usize>) {
        self.list.push(Body { source, first: self.points.len(), scale, frozen });
        self.points.extend_from_slice(samples);
    }

    /// Those of which something is in a domain or nearer to the box around it than `margin`.
    pub(super) fn near(&self, forms: &[Form<D>], request: &Request<D>, margin: f64) -> Self {
        let around = request.domain.bounds().grown(margin * request.fields.scale.range().1);
        let mut kept = Self::default();
        for body in &self.list {
            let samples = self.samples(body, &forms[body.source]);
            if body.frozen.is_some() || samples.iter().any(|p| around.contains(*p)) {
                kept.push(body.source, samples, body.scale, body.frozen);
            }
        }
        kept
    }

    /// Takes some out.
    pub(super) fn drop(&mut self, forms: &[Form<D>], is_gone: &[bool]) {
        let mut kept = Self::default();
        for (body, _) in self.list.iter().zip(is_gone).filter(|(_, gone)| !**gone) {
            kept.push(body.source, self.samples(body, &forms[body.source]), body.scale, body.frozen);
        }
        *self = kept;
    }

    pub(super) fn samples(&self, body: &Body, form: &Form<D>) -> &[Vector<D>] {
        &self.points[body.first..body.first + form.len()]
    }
}

/// A stretch of an element: all that is no farther than `radius` from the way between its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) body: u32,
    pub(super) class: u32,
    /// Its ends among all points.
    pub(super) ends: [u32; 2],
    pub(super) radius: f64,
}

/// The pieces of an element.
pub(super) fn pieces_of<const D: usize>(n: usize, body: &Body, form: &Form<D>) -> impl Iterator<Item = Piece> {
    let radii = &form.soft.radii;
    form.pieces.iter().map(move |p| {
        let radius = 0.5 * (radii[p[0] as usize] + radii[p[1] as usize]) * body.scale;
        let ends = p.map(|k| body.first as u32 + k);
        Piece { body: n as u32, class: form.class as u32, ends, radius }
    })
}

/// The place of the way from `a` to `b` nearest to `p`, as a share of it.
pub(super) fn foot<const D: usize>(p: Vector<D>, [a, b]: [Vector<D>; 2]) -> f64 {
    let along = b - a;
    let length2 = along.norm2();
    if length2 > 0.0 { ((p - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 }
}

/// The places of two ways that are nearest to one another, as shares of them.
pub(super) fn nearest<const D: usize>(first: [Vector<D>; 2], second: [Vector<D>; 2]) -> [f64; 2] {
    let (u, v, w) = (first[1] - first[0], second[1] - second[0], first[0] - second[0]);
    let (a, e, f) = (u.norm2(), v.norm2(), v.dot(w));
    if a <= 0.0 {
        return [0.0, foot(first[0], second)];
    }
    if e <= 0.0 {
        return [foot(second[0], first), 0.0];
    }
    let (b, c) = (u.dot(v), u.dot(w));
    let area = a * e - b * b;
    let s = if area > 1e-9 * a * e { ((b * f - c * e) / area).clamp(0.0, 1.0) } else { 0.5 };
    let t = (b * s + f) / e;
    if t < 0.0 {
        [(-c / a).clamp(0.0, 1.0), 0.0]
    } else if t > 1.0 {
        [((b - c) / a).clamp(0.0, 1.0), 1.0]
    } else {
        [s, t]
    }
}

/// Samples of a source with sample `at` at a place. A strand goes on from there step by step, each turned by the field where it starts, and
/// along walls that are in its way. Returns its scale.
pub(super) fn walked<const D: usize>(
    form: &Form<D>,
    (at, place): (usize, Vector<D>),
    request: &Request<D>,
    into: &mut Vec<Vector<D>>,
) -> f64 {
    let samples = &form.soft.samples;
    let fields = &request.fields;
    let scale = fields.scale.at(place);
    let turn = |p: Vector<D>| fields.orientation.as_ref().map_or_else(Matrix::identity, |o| o.at(p));
    into.clear();
    let has_walls = wall::is_there(request);
    if form.soft.build != Build::Strand || (fields.orientation.is_none() && !has_walls) {
        let turn = turn(place);
        into.extend(samples.iter().map(|p| place + turn.apply(*p - samples[at]) * scale));
        return scale;
    }
    into.resize(samples.len(), place);
    let ways: [Vec<usize>; 2] = [(at..samples.len()).collect(), (0..=at).rev().collect()];
    for way in &ways {
        let mut carried = Matrix::identity();
        for pair in way.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let here = into[from];
            let mut step = carried.apply(turn(here).apply(samples[to] - samples[from])) * scale;
            if has_walls {
                let kept = wall::within(request, here + step, form.soft.radii[to] * scale);
                if kept != here + step {
                    let along = (kept - here).unit_or_zero() * step.norm();
                    carried = turning(step, along).compose(&carried);
                    step = along;
                }
            }
            into[to] = here + step;
        }
    }
    scale
}

/// The rotation that takes the direction of one offset to that of another and leaves what is across both.
fn turning<const D: usize>(from: Vector<D>, to: Vector<D>) -> Matrix<D> {
    let (u, v) = (from.unit_or_zero(), to.unit_or_zero());
    let both = 1.0 + u.dot(v);
    if both < 1e-6 {
        return Matrix::identity();
    }
    let column = |c: usize| {
        let mut x = Vector::ZERO;
        x[c] = 1.0;
        x - (u + v) * (x.dot(u + v) / both) + v * (2.0 * x.dot(u))
    };
    let columns: [Vector<D>; D] = std::array::from_fn(column);
    Matrix(std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r])))
}

/// The pieces that are laid out so far, by place.
pub(super) struct Laid<const D: usize> {
    pub(super) bodies: Bodies<D>,
    pub(super) pieces: Vec<Piece>,
    buckets: Buckets<D>,
    /// Half of the longest piece, and the thickest.
    pub(super) half: f64,
    pub(super) thickest: f64,
}

impl<const D: usize> Laid<D> {
    /// Nothing, in a box; `half` and `thickest` are those of what will come.
    pub(super) fn new(bounds: Bounds<D>, cell: f64, half: f64, thickest: f64) -> Self {
        let buckets = Buckets::new(&Domain::Box(bounds), cell, cell);
        Self { bodies: Bodies::default(), pieces: Vec::new(), buckets, half, thickest }
    }

    pub(super) fn push(
        &mut self,
        source: usize,
        form: &Form<D>,
        samples: &[Vector<D>],
        scale: f64,
        frozen: Option<usize>,
    ) {
        let n = self.bodies.list.len();
        self.bodies.push(source, samples, scale, frozen);
        for piece in pieces_of(n, &self.bodies.list[n], form) {
            let middle = (self.point(piece.ends[0]) + self.point(piece.ends[1])) * 0.5;
            self.buckets.insert(self.pieces.len() as u32, middle);
            self.pieces.push(piece);
        }
    }

    /// The box around all samples.
    pub(super) fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.bodies.points.iter().copied())
    }

    fn point(&self, k: u32) -> Vector<D> {
        self.bodies.points[k as usize]
    }

    /// Calls `visit(piece, distance)` for the pieces whose middle line may be within `radius` of a place, with its distance from that.
    /// Returns what it cost.
    pub(super) fn near(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(&Piece, f64)) -> u64 {
        self.buckets.near(p, radius + self.half, |n| {
            let piece = &self.pieces[n as usize];
            let ends = piece.ends.map(|k| self.point(k));
            let t = foot(p, ends);
            visit(piece, (ends[0] + (ends[1] - ends[0]) * t - p).norm());
        })
    }

    /// Distance from a place to the nearest surface, negative inside, no more than `most`; and what it cost.
    pub(super) fn gap(&self, p: Vector<D>, most: f64) -> (f64, u64) {
        let mut gap = most;
        let cost = self.near(p, most + self.thickest, |piece, d| gap = gap.min(d - piece.radius));
        (gap, cost)
    }
}
