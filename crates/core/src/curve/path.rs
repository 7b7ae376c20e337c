//! Paths of cubic Bézier segments: the geometry of a stroke.

use crate::space::{Bounds, Similarity, Vector};

/// A cubic Bézier segment: start, two control points, end.
pub type Cubic<const D: usize> = [Vector<D>; 4];

/// The straight segment from `a` to `b`, its control points at the thirds.
pub fn straight<const D: usize>(a: Vector<D>, b: Vector<D>) -> Cubic<D> {
    [a, a + (b - a) * (1.0 / 3.0), b + (a - b) * (1.0 / 3.0), b]
}

/// Point of a cubic at parameter `t` in [0, 1].
pub fn cubic_at<const D: usize>(c: &Cubic<D>, t: f64) -> Vector<D> {
    let u = 1.0 - t;
    c[0] * (u * u * u) + c[1] * (3.0 * u * u * t) + c[2] * (3.0 * u * t * t) + c[3] * (t * t * t)
}

/// The part of a cubic from parameter `a` to `b`; backwards when `b < a`.
pub fn cubic_part<const D: usize>(c: &Cubic<D>, a: f64, b: f64) -> Cubic<D> {
    let slope = |t: f64| {
        let u = 1.0 - t;
        ((c[1] - c[0]) * (u * u) + (c[2] - c[1]) * (2.0 * u * t) + (c[3] - c[2]) * (t * t)) * (b - a)
    };
    let (p, q) = (cubic_at(c, a), cubic_at(c, b));
    [p, p + slope(a), q - slope(b), q]
}

/// A connected run of cubics, each starting where the one before ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path<const D: usize> {
    /// The segments, in order.
    pub cubics: Vec<Cubic<D>>,
    /// Whether the end of the last segment is joined to the start of the first; the two points coincide then.
    pub closed: bool,
}

impl<const D: usize> Path<D> {
    /// The open path through `points`, straight from each to the next. Coincident neighbours count once.
    pub fn polyline(points: &[Vector<D>]) -> Self {
        let steps = points.windows(2).filter(|w| w[0] != w[1]);
        Self { cubics: steps.map(|w| straight(w[0], w[1])).collect(), closed: false }
    }

    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.cubics.is_empty()
    }

    /// First point.
    pub fn start(&self) -> Option<Vector<D>> {
        self.cubics.first().map(|c| c[0])
    }

    /// Last point.
    pub fn end(&self) -> Option<Vector<D>> {
        self.cubics.last().map(|c| c[3])
    }

    /// The same path the other way round.
    pub fn reversed(&self) -> Self {
        let cubics = self.cubics.iter().rev().map(|c| [c[3], c[2], c[1], c[0]]).collect();
        Self { cubics, closed: self.closed }
    }

    /// Every control point moved by `f`.
    pub fn map(&self, mut f: impl FnMut(Vector<D>) -> Vector<D>) -> Self {
        Self { cubics: self.cubics.iter().map(|c| c.map(&mut f)).collect(), closed: self.closed }
    }

    /// The path moved by a similarity.
    pub fn transformed(&self, by: &Similarity<D>) -> Self {
        self.map(|p| by.apply(p))
    }

    /// Box around the control points, which holds the path.
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.cubics.iter().flatten().copied())
    }

    /// Points along the path, no farther than `tolerance` from it between two of them.
    pub fn flatten(&self, tolerance: f64) -> Vec<Vector<D>> {
        let mut points: Vec<_> = self.start().into_iter().collect();
        for c in &self.cubics {
            let n = steps(c, tolerance);
            points.extend((1..=n).map(|k| cubic_at(c, k as f64 / n as f64)));
        }
        points
    }
}

/// Number of equal parameter steps that keep chords of `c` within `tolerance`, from the bound on the second derivative.
pub(crate) fn steps<const D: usize>(c: &Cubic<D>, tolerance: f64) -> usize {
    let bend = |a: Vector<D>, b: Vector<D>, d: Vector<D>| (a - b * 2.0 + d).norm();
    let second = 6.0 * bend(c[0], c[1], c[2]).max(bend(c[1], c[2], c[3]));
    ((second / (8.0 * tolerance.max(f64::MIN_POSITIVE))).sqrt().ceil()).clamp(1.0, 256.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc() -> Cubic<2> {
        let k = 0.552_284_75;
        [Vector::xy(1.0, 0.0), Vector::xy(1.0, k), Vector::xy(k, 1.0), Vector::xy(0.0, 1.0)]
    }

    #[test]
    fn a_flattened_arc_stays_within_tolerance() {
        let path = Path { cubics: vec![arc()], closed: false };
        let points = path.flatten(1e-3);
        assert!(points.len() < 40);
        for w in points.windows(2) {
            assert!((1.0 - ((w[0] + w[1]) * 0.5).norm()).abs() < 1.3e-3);
        }
    }

    #[test]
    fn a_part_lies_on_the_whole_and_turns_round() {
        let part = cubic_part(&arc(), 0.7, 0.2);
        for k in 0..=4 {
            let t = f64::from(k) / 4.0;
            assert!((cubic_at(&part, t) - cubic_at(&arc(), 0.7 - 0.5 * t)).norm() < 1e-12);
        }
    }

    #[test]
    fn a_polyline_skips_coincident_points() {
        let p = Vector::xy(1.0, 2.0);
        let path = Path::polyline(&[Vector::ZERO, p, p, Vector::xy(3.0, 0.0)]);
        assert_eq!(path.cubics.len(), 2);
        assert_eq!(path.reversed().start(), path.end());
    }
}
