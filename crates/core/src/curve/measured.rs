//! Paths by arc length.

use crate::{
    curve::path::{Path, cubic_at, cubic_part, steps},
    space::Vector,
};

/// Where along a path something is.
#[derive(Clone, Copy, Debug)]
struct Knot {
    segment: u32,
    parameter: f64,
    arc: f64,
}

/// A path that is measured along its length.
#[derive(Clone, Debug)]
pub struct Measured<const D: usize> {
    path: Path<D>,
    knots: Vec<Knot>,
    points: Vec<Vector<D>>,
}

impl<const D: usize> Measured<D> {
    /// Measures `path`, its chords within `tolerance` of it.
    pub fn new(path: Path<D>, tolerance: f64) -> Self {
        let (mut knots, mut points) = (Vec::new(), Vec::new());
        let mut arc = 0.0;
        for (s, c) in path.cubics.iter().enumerate() {
            let n = steps(c, tolerance).max(2);
            for k in usize::from(s > 0)..=n {
                let parameter = k as f64 / n as f64;
                let p = cubic_at(c, parameter);
                arc += points.last().map_or(0.0, |q: &Vector<D>| (p - *q).norm());
                points.push(p);
                knots.push(Knot { segment: s as u32, parameter, arc });
            }
        }
        Self { path, knots, points }
    }

    /// Number of points that `path` is flattened to when it is measured with `tolerance`.
    pub fn count(path: &Path<D>, tolerance: f64) -> usize {
        path.cubics.iter().map(|c| steps(c, tolerance).max(2)).sum::<usize>() + 1
    }

    /// The path.
    pub fn path(&self) -> &Path<D> {
        &self.path
    }

    /// Whether it is closed.
    pub fn is_closed(&self) -> bool {
        self.path.closed
    }

    /// Length of the chords.
    pub fn length(&self) -> f64 {
        self.knots.last().map_or(0.0, |k| k.arc)
    }

    /// The points that the path was flattened to.
    pub fn points(&self) -> &[Vector<D>] {
        &self.points
    }

    /// Arc length at point `k` of [`Measured::points`].
    pub fn arc_of(&self, k: usize) -> f64 {
        self.knots[k].arc
    }

    /// `arc` brought into the path: around the back on a closed one, to the nearer end on an open one.
    pub fn wrap(&self, arc: f64) -> f64 {
        let length = self.length();
        if self.path.closed && length > 0.0 { arc.rem_euclid(length) } else { arc.clamp(0.0, length) }
    }

    /// Segment and parameter at `arc`, which lies in the path.
    fn locate(&self, arc: f64) -> (usize, f64) {
        let next = self.knots.partition_point(|k| k.arc < arc).clamp(1, self.knots.len() - 1);
        let (a, b) = (self.knots[next - 1], self.knots[next]);
        let share = if b.arc > a.arc { ((arc - a.arc) / (b.arc - a.arc)).clamp(0.0, 1.0) } else { 0.0 };
        let start = if a.segment == b.segment { a.parameter } else { 0.0 };
        (b.segment as usize, start + share * (b.parameter - start))
    }

    /// Point at `arc`.
    pub fn point(&self, arc: f64) -> Vector<D> {
        let (s, t) = self.locate(self.wrap(arc));
        cubic_at(&self.path.cubics[s], t)
    }

    /// The part from arc length `from` to `to`, backwards when `to < from`. On a closed path both may lie beyond its ends.
    pub fn part(&self, from: f64, to: f64) -> Path<D> {
        if to < from {
            return self.part(to, from).reversed();
        }
        let length = self.length();
        if !self.path.closed || length <= 0.0 {
            return Path { cubics: self.within(from.max(0.0), to.min(length)), closed: false };
        }
        let turn = (from / length).floor() * length;
        let (mut a, mut b) = (from - turn, to - turn);
        let mut cubics = Vec::new();
        while b > length {
            cubics.extend(self.within(a, length));
            (a, b) = (0.0, b - length);
        }
        cubics.extend(self.within(a, b));
        Path { cubics, closed: false }
    }

    fn within(&self, from: f64, to: f64) -> Vec<[Vector<D>; 4]> {
        if to <= from {
            return Vec::new();
        }
        let ((s0, t0), (s1, t1)) = (self.locate(from), self.locate(to));
        (s0..=s1)
            .filter_map(|s| {
                let a = if s == s0 { t0 } else { 0.0 };
                let b = if s == s1 { t1 } else { 1.0 };
                (b - a > 1e-9).then(|| cubic_part(&self.path.cubics[s], a, b))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Measured<2> {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)].map(|(x, y)| Vector::xy(x, y));
        Measured::new(Path { closed: true, ..Path::polyline(&corners) }, 1e-3)
    }

    #[test]
    fn arc_length_goes_around_a_square() {
        let square = square();
        assert!((square.length() - 4.0).abs() < 1e-12);
        assert!((square.point(2.5) - Vector::xy(0.5, 1.0)).norm() < 1e-12);
        assert!((square.point(-0.25) - Vector::xy(0.0, 0.25)).norm() < 1e-12);
    }

    #[test]
    fn a_part_keeps_the_corners_and_may_cross_the_start() {
        assert_eq!(Measured::count(square().path(), 1e-3), square().points().len());
        let part = square().part(3.5, 5.5);
        assert_eq!(part.cubics.len(), 3);
        assert!((part.start().unwrap() - Vector::xy(0.0, 0.5)).norm() < 1e-12);
        assert!((part.end().unwrap() - Vector::xy(1.0, 0.5)).norm() < 1e-12);
        let back = square().part(5.5, 3.5);
        assert!((back.start().unwrap() - Vector::xy(1.0, 0.5)).norm() < 1e-12);
    }
}
