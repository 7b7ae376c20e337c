//! The vectors of a lattice, and how far two phases are apart.

use arabesque_core::{Error, Result, Vector};

use super::links::Link;

/// How much rather a row slips along its neighbour than leaves its line.
const STIFF: f64 = 4.0;
/// How little a neighbour in another row says of where things lie along a row.
const SLIP: f64 = 0.05;
/// What a neighbour says that does not agree at all.
const FAINT: f64 = 1e-3;
/// Vectors are shortened so often at most.
const STEPS: usize = 64;

/// The vectors of a lattice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// The vectors, as short as they can be.
    pub(super) vectors: [Vector<2>; 2],
    pub(super) shorter: f64,
    /// The direction of rows that slip, of length 1.
    rows: Option<Vector<2>>,
    /// The vectors along and across the rows, stretched across them, and as short as they then can be.
    stretched: [Vector<2>; 2],
}

impl Cell {
    pub(super) fn new(vectors: [Vector<2>; 2], rows: Option<Vector<2>>) -> Result<Self> {
        let [a, b] = vectors;
        let is_sound = a.is_finite() && b.is_finite() && a.cross(b).abs() > 1e-6 * a.norm() * b.norm();
        if !is_sound {
            return Err(Error::parameter("lattice", format!("{a:?}, {b:?}"), "two vectors that are not parallel"));
        }
        let vectors = reduced(a, b);
        let shorter = vectors[0].norm().min(vectors[1].norm());
        let rows = rows.and_then(|way| way.unit_if_longer(1e-12));
        let [u, v] = vectors.map(|vector| rows.map_or(vector, |way| stretched(vector, way)));
        Ok(Self { vectors, shorter, rows, stretched: reduced(u, v) })
    }

    /// The shortest vector that differs from `v` by one of the lattice.
    pub(super) fn folded(&self, v: Vector<2>) -> Vector<2> {
        nearest(self.vectors, v)
    }

    /// The vector that differs from `v` by one of the lattice and leaves rows least.
    fn slipped(&self, v: Vector<2>) -> Vector<2> {
        match self.rows {
            None => self.folded(v),
            Some(way) => released(nearest(self.stretched, stretched(v, way)), way),
        }
    }

    /// How far a link can be trusted: where nothing slips there is no way around a pole, and all links count alike.
    pub(super) fn trust(&self, link: &Link) -> f64 {
        if self.rows.is_some() { link.trust } else { 1.0 }
    }

    /// By how much a neighbour would change a phase that is off by `off`, and with which weight along and across rows.
    pub(super) fn change(&self, off: Vector<2>, link: &Link) -> Change {
        let off = self.slipped(off);
        let agrees = 1.0 - (2.0 * self.share(off)).min(1.0);
        let weight = agrees * agrees + FAINT;
        let Some(rows) = self.rows else { return Change { off, weights: [weight; 2] } };
        let weight = weight * self.trust(link);
        let along = link.way.cosine(rows).powi(4);
        let across = off.dot(left(rows)) / self.spread(left(rows));
        let in_line = ((1.0 - (2.0 * across.abs()).min(1.0)).powi(2) + FAINT) * self.trust(link);
        Change { off, weights: [weight * (SLIP + along), in_line] }
    }

    /// How far a phase is off along a way, in shares of a cell; slips of rows count little.
    pub(super) fn misfit(&self, off: Vector<2>, way: Vector<2>) -> f64 {
        let off = self.slipped(off);
        match self.rows {
            None => self.share(off),
            Some(rows) => {
                let along = (off.dot(rows) / self.spread(rows)).abs() * (SLIP + way.cosine(rows).powi(4));
                let across = (off.dot(left(rows)) / self.spread(left(rows))).abs();
                along.max(across)
            }
        }
    }

    /// Adds up changes: what they come to.
    pub(super) fn mean(&self, changes: impl Iterator<Item = Change>) -> Option<Vector<2>> {
        let (mut sums, mut weights) = ([0.0; 2], [0.0; 2]);
        let axes = self.axes();
        for change in changes {
            for k in 0..2 {
                sums[k] += change.off.dot(axes[k]) * change.weights[k];
                weights[k] += change.weights[k];
            }
        }
        (weights[0] > 0.0 && weights[1] > 0.0)
            .then(|| axes[0] * (sums[0] / weights[0]) + axes[1] * (sums[1] / weights[1]))
    }

    fn axes(&self) -> [Vector<2>; 2] {
        let along = self.rows.unwrap_or(Vector([1.0, 0.0]));
        [along, left(along)]
    }

    /// The direction of rows that slip, of length 1.
    pub(super) fn rows(&self) -> Option<Vector<2>> {
        self.rows
    }

    /// How far apart the lattice repeats along rows that slip, and how far apart rows are.
    pub(super) fn spreads(&self) -> [f64; 2] {
        self.axes().map(|way| self.spread(way))
    }

    /// The larger coordinate in terms of the vectors.
    fn share(&self, v: Vector<2>) -> f64 {
        let [a, b] = self.vectors;
        let measure = a.cross(b);
        (v.cross(b) / measure).abs().max((a.cross(v) / measure).abs())
    }

    /// How far apart the lattice repeats along a direction: along rows, and from row to row.
    fn spread(&self, way: Vector<2>) -> f64 {
        let [a, b] = self.vectors;
        let cell = a.cross(b).abs();
        match self.rows {
            Some(rows) if rows.dot(way).abs() > 0.5 => {
                // The vector of the lattice that lies along the rows.
                let [u, v] = self.stretched;
                let along = if u.cosine(Vector([1.0, 0.0])).abs() > v.cosine(Vector([1.0, 0.0])).abs() { u } else { v };
                along.norm()
            }
            Some(rows) => cell / self.spread(rows),
            None => self.shorter,
        }
    }
}

/// What a neighbour says of a phase.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    off: Vector<2>,
    weights: [f64; 2],
}

fn left(v: Vector<2>) -> Vector<2> {
    Vector([-v[1], v[0]])
}

/// Along and across rows, longer across them.
fn stretched(v: Vector<2>, rows: Vector<2>) -> Vector<2> {
    Vector([v.dot(rows), STIFF * v.dot(left(rows))])
}

fn released(v: Vector<2>, rows: Vector<2>) -> Vector<2> {
    rows * v[0] + left(rows) * (v[1] / STIFF)
}

/// The shortest two vectors of a lattice.
fn reduced(mut a: Vector<2>, mut b: Vector<2>) -> [Vector<2>; 2] {
    for _ in 0..STEPS {
        if b.norm2() < a.norm2() {
            std::mem::swap(&mut a, &mut b);
        }
        let steps = (a.dot(b) / a.norm2()).round();
        if steps == 0.0 {
            break;
        }
        b -= a * steps;
    }
    [a, b]
}

/// The shortest vector that differs from `v` by one of a lattice of two short vectors.
fn nearest([a, b]: [Vector<2>; 2], v: Vector<2>) -> Vector<2> {
    let measure = a.cross(b);
    let (s, t) = ((v.cross(b) / measure).round(), (a.cross(v) / measure).round());
    let rest = v - a * s - b * t;
    let mut best = rest;
    for (i, j) in [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, -1.0)]
    {
        let other = rest + a * i + b * j;
        if other.norm2() < best.norm2() {
            best = other;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bricks(rows: Option<Vector<2>>) -> Cell {
        Cell::new([Vector([1.0, 1.0]), Vector([-1.0, 1.0])], rows).unwrap()
    }

    #[test]
    fn what_is_folded_is_the_shortest() {
        let cell = bricks(None);
        let rest = cell.folded(Vector([2.1, 0.05]));
        assert!((rest - Vector([0.1, 0.05])).norm() < 1e-9);
        assert!(cell.misfit(Vector([2.0, 0.0]), Vector([0.3, 0.0])) < 1e-9);
    }

    #[test]
    fn rows_slip_rather_than_leave_their_line() {
        let [whole, slipping] = [None, Some(Vector([1.0, 0.0]))].map(bricks);
        // Half a brick along is as near to the next row as to the own one.
        let off = Vector([0.97, 0.02]);
        let up = Vector([0.0, 0.3]);
        assert!(whole.misfit(off, up) > 0.4);
        assert!(slipping.misfit(off, up) < 0.1);
        assert!(slipping.misfit(Vector([0.0, 0.5]), up) > 0.4);
        let change = slipping.mean([slipping.change(off, &Link { to: 0, way: up, trust: 1.0 })].into_iter()).unwrap();
        assert!((change - off).norm() < 1e-9);
        assert!((slipping.spread(Vector([1.0, 0.0])) - 2.0).abs() < 1e-9);
        assert!((slipping.spread(Vector([0.0, 1.0])) - 1.0).abs() < 1e-9);
    }
}
