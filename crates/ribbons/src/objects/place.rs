//! One object at one place of a curve: rigid where the curve hardly leaves it, else bent along the curve.

use arabesque_core::{Bounds, Patch, Vector};

use crate::{
    geometry::{
        cage::{Form, Rung},
        space::unrolled,
    },
    objects::{find::Object, way::Way},
    pieces::piece::Piece,
};

/// Farthest that the curve may leave a rigid object, in heights of the exemplar.
const SAG: f64 = 0.1;
/// Length of a slice of a bent object, in heights of the exemplar.
const SLICE: f64 = 0.03;
/// Most of its room on the inner side of a bend that a bent object may fill.
const FILLED: f64 = 0.9;
/// Samples along an object at which the curve is looked at.
const SAMPLES: usize = 12;
/// How far ink may reach over the border of the ribbon, in pixels.
const OVER: f64 = 1.0;

/// An object on the curve.
#[derive(Clone, Debug)]
pub(crate) struct Placed<const D: usize> {
    /// Where its ink ends, by arc length.
    pub(crate) to: f64,
    pub(crate) pieces: Vec<Piece<D>>,
    /// Its outline.
    pub(crate) points: Vec<Vector<D>>,
    pub(crate) bounds: Bounds<D>,
}

impl<const D: usize> Placed<D> {
    /// Whether it stays `least` away from `other`.
    pub(crate) fn clears(&self, other: &Self, least: f64) -> bool {
        if !self.bounds.grown(least).intersects(&other.bounds) {
            return true;
        }
        let square = least * least;
        self.points.iter().all(|p| other.points.iter().all(|q| (*p - *q).norm2() >= square))
    }
}

/// Why an object cannot lie at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Obstacle {
    /// The curve ends before it does.
    End,
    /// The ribbon is narrower than it.
    Width,
    /// The curve is bent too tightly for it.
    Bend,
    /// It would lie on a place to avoid, or on another object.
    Taken,
}

/// What lies at a place, or why nothing can.
pub(crate) type Tried<T> = std::result::Result<T, Obstacle>;

/// How objects of one kind are placed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placing<'a, const D: usize> {
    pub(crate) way: &'a Way<'a, D>,
    /// User units per pixel.
    pub(crate) scale: f64,
    /// Height of the exemplar, in user units.
    pub(crate) height: f64,
    /// Whether ink may reach over the border of the ribbon.
    pub(crate) relax: bool,
}

impl<const D: usize> Placing<'_, D> {
    /// `object` with its left end at arc length `from` and its right end at `end` at the latest.
    pub(crate) fn place(&self, object: &Object, from: f64, end: f64) -> Tried<Placed<D>> {
        let length = object.length() * self.scale;
        if from + length > end + 1e-6 * self.height {
            return Err(Obstacle::End);
        }
        if !self.relax && !self.is_wide_enough(object, from, from + length) {
            return Err(Obstacle::Width);
        }
        match self.rigid(object, from, length) {
            Some(rigid) if rigid.to > end + 1e-6 * self.height => Err(Obstacle::End),
            Some(rigid) => Ok(rigid),
            None => self.bent(object, from, length),
        }
    }

    fn is_wide_enough(&self, object: &Object, from: f64, to: f64) -> bool {
        let [up, down] = object.reach();
        let room = (0..=2).map(|k| self.way.half_width(from + (to - from) * 0.5 * f64::from(k)));
        let room = room.fold(f64::INFINITY, f64::min) / self.scale + OVER;
        up <= room && down <= room
    }

    /// The object as it is, where the curve leaves its chord by little.
    fn rigid(&self, object: &Object, from: f64, length: f64) -> Option<Placed<D>> {
        let to = self.way.reach(from, length)?;
        let (a, b) = (self.way.point(from), self.way.point(to));
        let along = (b - a).unit_if_longer(1e-9 * self.height)?;
        let across = self.way.down(0.5 * (from + to));
        let down = (across - along * across.dot(along)).unit_if_longer(1e-6)?;
        let off = |k: usize| {
            let p = self.way.point(from + (to - from) * k as f64 / SAMPLES as f64) - a;
            p - along * p.dot(along)
        };
        let offs: Vec<Vector<D>> = (0..=SAMPLES).map(off).collect();
        if offs.iter().any(|o| o.norm() > SAG * self.height) {
            return None;
        }
        // In the middle between the chord and the curve.
        let mean = offs.iter().fold(Vector::ZERO, |sum, o| sum + *o) * (1.0 / offs.len() as f64);
        let origin = a + mean;
        let at = |x: f64, y: f64| origin + (along * x + down * y) * self.scale;
        let [x0, x1, y0, y1] = object.shown;
        let texture = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(Vector);
        let corners = texture.map(|p| at(p[0] - object.left, p[1] - object.middle));
        let patch = Patch { source: object.source, corners, texture };
        let points: Vec<Vector<D>> = object.outline.iter().map(|p| at(p[0], p[1])).collect();
        let pieces = vec![Piece { patch, shift: Vec::new() }];
        Some(Placed { to, pieces, bounds: Bounds::around(points.iter().copied()), points })
    }

    /// The object in slices that follow the curve.
    fn bent(&self, object: &Object, from: f64, length: f64) -> Tried<Placed<D>> {
        let [x0, x1, y0, y1] = object.shown;
        let half = (object.middle - y0).max(y1 - object.middle);
        let n = ((x1 - x0) * self.scale / (SLICE * self.height)).ceil().max(2.0) as usize;
        let x = |k: usize| x0 + (x1 - x0) * k as f64 / n as f64;
        let arc = |x: f64| from + (x - object.left) * self.scale;
        let rung = |k: usize| {
            let (centre, down) = (self.way.point(arc(x(k))), self.way.down(arc(x(k))) * (half * self.scale));
            Rung { top: centre - down, bottom: centre + down }
        };
        let rungs: Vec<Rung<D>> = (0..=n).map(rung).collect();
        let mut pieces = Vec::with_capacity(n);
        for (k, pair) in rungs.windows(2).enumerate() {
            let (chord, turn) = (pair[1].centre() - pair[0].centre(), pair[1].down() - pair[0].down());
            if half * self.scale * turn.norm() > FILLED * chord.norm() {
                return Err(Obstacle::Bend);
            }
            let Form { foot, top, bottom } = unrolled(&pair[0], &pair[1], self.scale);
            let corner = Vector::xy(x(k), object.middle) - foot * 0.5;
            let texture = [Vector::ZERO, top, bottom, foot].map(|p| corner + p);
            let corners = [pair[0].top, pair[1].top, pair[1].bottom, pair[0].bottom];
            pieces.push(Piece { patch: Patch { source: object.source, corners, texture }, shift: Vec::new() });
        }
        let at = |p: &[f64; 2]| {
            let s = from + p[0] * self.scale;
            self.way.point(s) + self.way.down(s) * (p[1] * self.scale)
        };
        let points: Vec<Vector<D>> = object.outline.iter().map(at).collect();
        let bounds = Bounds::around(points.iter().copied());
        Ok(Placed { to: from + length, pieces, points, bounds })
    }
}
