//! Smooth paths through many points.

use arabesque_core::{Cubic, Vector, arc_lengths, cubic_at};

/// Runs of so many points or fewer are not split further.
const MIN_POINTS: usize = 2;

/// Places at which a cubic is compared with the points.
const LOOKS: usize = 32;

/// Cubics along a run of points, within `tolerance` of it and without corners. `ends`: unit directions of travel at its
/// first and last point.
pub(crate) fn fit(points: &[Vector<2>], ends: [Vector<2>; 2], tolerance: f64) -> Vec<Cubic<2>> {
    let (Some(&a), Some(&b)) = (points.first(), points.last()) else { return Vec::new() };
    if a == b && points.len() <= MIN_POINTS {
        return Vec::new();
    }
    let arcs = arc_lengths(points);
    let third = arcs[arcs.len() - 1] / 3.0;
    let cubic = [a, a + ends[0] * third, b - ends[1] * third, b];
    if points.len() <= MIN_POINTS || misfit(&cubic, points, &arcs) <= tolerance {
        return vec![cubic];
    }
    let half = 0.5 * arcs[arcs.len() - 1];
    let middle = arcs.partition_point(|s| *s < half).clamp(1, points.len() - 2);
    let way = (points[middle + 1] - points[middle - 1]).unit_or_zero();
    let mut cubics = fit(&points[..=middle], [ends[0], way], tolerance);
    cubics.extend(fit(&points[middle..], [way, ends[1]], tolerance));
    cubics
}

/// Largest distance of a cubic from the run of points at the same share of its length.
fn misfit(cubic: &Cubic<2>, points: &[Vector<2>], arcs: &[f64]) -> f64 {
    let length = arcs[arcs.len() - 1];
    let apart = |k: usize| {
        let t = k as f64 / LOOKS as f64;
        let next = arcs.partition_point(|s| *s < t * length).clamp(1, points.len() - 1);
        let (from, to) = (arcs[next - 1], arcs[next]);
        let share = ((t * length - from) / (to - from).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (points[next - 1] + (points[next] - points[next - 1]) * share - cubic_at(cubic, t)).norm()
    };
    (1..LOOKS).map(apart).fold(0.0, f64::max)
}

/// A place on a path, and the unit direction in which the path passes it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage {
    pub(crate) place: Vector<2>,
    pub(crate) way: Vector<2>,
}

/// A cubic from one passage to another, an arc of a circle where there is one.
pub(crate) fn arc(from: Passage, to: Passage) -> Cubic<2> {
    let (Passage { place: a, way: out }, Passage { place: b, way: on }) = (from, to);
    let turn = out.angle_to(on).abs();
    let reach = (b - a).norm() / (3.0 * (0.25 * turn).cos().powi(2));
    [a, a + out * reach, b - on * reach, b]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(n: usize, turn: f64) -> Vec<Vector<2>> {
        (0..=n).map(|k| turn * k as f64 / n as f64).map(|a| Vector::xy(a.cos(), a.sin()) * 10.0).collect()
    }

    #[test]
    fn half_a_circle_takes_few_cubics() {
        let points = circle(200, std::f64::consts::PI);
        let cubics = fit(&points, [Vector::xy(0.0, 1.0), Vector::xy(0.0, -1.0)], 0.02);
        assert!(cubics.len() <= 8, "{}", cubics.len());
        for c in &cubics {
            assert!((cubic_at(c, 0.5).norm() - 10.0).abs() < 0.03);
        }
        assert!(cubics.windows(2).all(|w| w[0][3] == w[1][0]));
    }

    #[test]
    fn a_straight_run_is_one_cubic() {
        let points: Vec<_> = (0..50).map(|k| Vector::xy(f64::from(k), 2.0)).collect();
        assert_eq!(fit(&points, [Vector::xy(1.0, 0.0); 2], 0.01).len(), 1);
    }

    #[test]
    fn an_arc_is_a_quarter_circle() {
        let start = Passage { place: Vector::xy(1.0, 0.0), way: Vector::xy(0.0, 1.0) };
        let c = arc(start, Passage { place: Vector::xy(0.0, 1.0), way: Vector::xy(-1.0, 0.0) });
        assert!((cubic_at(&c, 0.5).norm() - 1.0).abs() < 1e-3);
    }
}
