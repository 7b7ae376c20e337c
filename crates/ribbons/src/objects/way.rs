//! A curve as objects are laid along it: places by arc length, and the corners that no object may lie across.

use arabesque_core::Vector;

use crate::geometry::cage::Cage;

/// A curve has a corner where it turns by more than this, in radians, between a piece and the one after the next.
const CORNER: f64 = 0.52;
/// Most pieces in a row at which a corner is seen.
const LONGEST: usize = 3;

/// A place at which the curve turns sharply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// The stretch of the curve that turns, by arc length.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// By how much, in radians.
    pub(crate) turn: f64,
    /// 1 where it turns towards the lower side of the ribbon, else -1.
    pub(crate) inner: f64,
}

impl Corner {
    /// How far from the corner an object must end whose outline has `points`, by their distance from that end and from the middle row,
    /// so that it stays `half` of a gap on its own side.
    pub(crate) fn room(&self, points: impl Iterator<Item = [f64; 2]>, half: f64) -> f64 {
        let (sin, cos) = (0.5 * self.turn).sin_cos();
        points.map(|[away, y]| (half + self.inner * y * sin) / cos.max(0.05) - away).fold(0.0, f64::max)
    }
}

/// The middle of a ribbon by arc length.
#[derive(Debug)]
pub(crate) struct Way<'a, const D: usize> {
    cage: &'a Cage<D>,
    arcs: Vec<f64>,
}

impl<'a, const D: usize> Way<'a, D> {
    pub(crate) fn new(cage: &'a Cage<D>) -> Self {
        let mut arcs = vec![0.0];
        let mut arc = 0.0;
        for pair in cage.rungs.windows(2) {
            arc += (pair[1].centre() - pair[0].centre()).norm();
            arcs.push(arc);
        }
        Self { cage, arcs }
    }

    pub(crate) fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    pub(crate) fn closed(&self) -> bool {
        self.cage.closed
    }

    /// The piece at arc length `s`, and the share of it.
    fn piece(&self, s: f64) -> (usize, f64) {
        let s = if self.closed() { s.rem_euclid(self.length().max(1e-300)) } else { s };
        let k = self.arcs.partition_point(|&a| a <= s).clamp(1, self.cage.len()) - 1;
        let part = self.arcs[k + 1] - self.arcs[k];
        (k, if part > 0.0 { ((s - self.arcs[k]) / part).clamp(0.0, 1.0) } else { 0.0 })
    }

    /// The point at arc length `s`.
    pub(crate) fn point(&self, s: f64) -> Vector<D> {
        let (k, share) = self.piece(s);
        let (a, b) = (self.cage.rungs[k].centre(), self.cage.rungs[k + 1].centre());
        a + (b - a) * share
    }

    /// Across the ribbon at arc length `s`: a unit vector.
    pub(crate) fn down(&self, s: f64) -> Vector<D> {
        let (k, share) = self.piece(s);
        let (a, b) = (self.cage.rungs[k].down(), self.cage.rungs[k + 1].down());
        (a + (b - a) * share).unit_if_longer(1e-9).unwrap_or(a)
    }

    /// Half of the width of the ribbon at arc length `s`.
    pub(crate) fn half_width(&self, s: f64) -> f64 {
        let (k, share) = self.piece(s);
        let [a, b] = [k, k + 1].map(|k| 0.5 * (self.cage.rungs[k].bottom - self.cage.rungs[k].top).norm());
        a + (b - a) * share
    }

    /// Where the curve is `chord` away from its point at `from` for the first time after that; `None` where it turns too much for that.
    pub(crate) fn reach(&self, from: f64, chord: f64) -> Option<f64> {
        let start = self.point(from);
        let mut s = from + chord;
        for _ in 0..12 {
            let missing = chord - (self.point(s) - start).norm();
            s += missing;
            if missing.abs() < 1e-4 * chord {
                return (s - from < 1.5 * chord).then_some(s);
            }
        }
        None
    }

    /// The corners, in order.
    pub(crate) fn corners(&self) -> Vec<Corner> {
        let n = self.cage.len();
        let chord = |k: usize| self.cage.rungs[k + 1].centre() - self.cage.rungs[k].centre();
        let turn = |a: usize, b: usize| chord(a).cosine(chord(b)).clamp(-1.0, 1.0).acos();
        let before = |k: usize| (k + n - 1) % n;
        let after = |k: usize| (k + 1) % n;
        let inside = |k: usize| n > 3 && (self.closed() || (k > 0 && k + 1 < n));
        let amount = |k: usize| turn(before(k), after(k));
        let sharp = |k: usize| inside(k) && amount(k) > CORNER;
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for k in (0..n).filter(|&k| sharp(k)) {
            match runs.last_mut() {
                Some(run) if run.1 + 1 == k => run.1 = k,
                _ => runs.push((k, k)),
            }
        }
        // What turns on and on is a tight bend, in which small objects may lie.
        runs.retain(|run| run.1 - run.0 < LONGEST);
        let narrowed = |(a, b): (usize, usize)| match b - a {
            // Both see the same turn.
            1 if amount(b) > amount(a) => (b, b),
            1 => (a, a),
            _ => (a, b),
        };
        runs.into_iter()
            .map(narrowed)
            .map(|run| self.corner(run, [chord(before(run.0)), chord(after(run.1))]))
            .collect()
    }

    fn corner(&self, (a, b): (usize, usize), [before, after]: [Vector<D>; 2]) -> Corner {
        let turn = before.cosine(after).clamp(-1.0, 1.0).acos();
        let towards = after.unit_or_zero() - before.unit_or_zero();
        let inner = if towards.dot(self.down(0.5 * (self.arcs[a] + self.arcs[b + 1]))) > 0.0 { 1.0 } else { -1.0 };
        Corner { from: self.arcs[a], to: self.arcs[b + 1], turn, inner }
    }
}
