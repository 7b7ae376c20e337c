//! Questions about straight segments: what of them is nearest, and where they cross.

use crate::space::Vector;

/// A straight segment: start and end.
pub type Segment<const D: usize> = (Vector<D>, Vector<D>);

/// Where the point of a segment that is nearest to `p` lies: 0 at its start, 1 at its end. 0 on a segment without a length.
pub fn nearest_share<const D: usize>((a, b): Segment<D>, p: Vector<D>) -> f64 {
    let along = b - a;
    ((p - a).dot(along) / along.norm2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

/// The point of a segment that is nearest to `p`.
pub fn nearest<const D: usize>((a, b): Segment<D>, p: Vector<D>) -> Vector<D> {
    a + (b - a) * nearest_share((a, b), p)
}

/// Distance of `p` from a segment.
pub fn distance<const D: usize>(segment: Segment<D>, p: Vector<D>) -> f64 {
    (nearest(segment, p) - p).norm()
}

/// Where two straight lines cross, each given by a point and a direction: the multiples of either direction that lead there.
/// `None` when the lines are parallel.
#[inline]
pub fn lines_cross((p, way): (Vector<2>, Vector<2>), (q, other): (Vector<2>, Vector<2>)) -> Option<[f64; 2]> {
    let turn = way.cross(other);
    let between = q - p;
    (turn != 0.0).then(|| [between.cross(other) / turn, between.cross(way) / turn])
}

/// Where the straight lines through two segments cross: the share of each, from 0 to 1 where the segments themselves do.
/// `None` when they are parallel. Callers decide whether the ends belong to a segment.
#[inline]
pub fn crossing((a, b): Segment<2>, (c, d): Segment<2>) -> Option<[f64; 2]> {
    lines_cross((a, b - a), (c, d - c))
}

/// The x at which a segment passes the height `y`; an end on it counts for what lies above. `None` where it does not pass.
#[inline]
pub fn crossing_at_height((a, b): Segment<2>, y: f64) -> Option<f64> {
    ((a[1] > y) != (b[1] > y)).then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
}

/// Whether two segments cross; an end of the one on the line through the other counts for one side of it only.
#[inline]
pub fn crosses((a, b): Segment<2>, (p, q): Segment<2>) -> bool {
    let side = |v: Vector<2>| (q - p).cross(v - p) > 0.0;
    let other = |v: Vector<2>| (b - a).cross(v - a) > 0.0;
    side(a) != side(b) && other(p) != other(q)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = Vector<2>> {
        (-10.0..10.0, -10.0..10.0).prop_map(|(x, y)| Vector::xy(x, y))
    }

    proptest! {
        #[test]
        fn nothing_of_a_segment_is_nearer_than_the_nearest_point(a in point(), b in point(), p in point(), t in 0.0..1.0) {
            prop_assert!(distance((a, b), p) <= (a + (b - a) * t - p).norm() + 1e-9);
            prop_assert!((nearest((a, b), nearest((a, b), p)) - nearest((a, b), p)).norm() < 1e-9);
        }

        #[test]
        fn both_lines_lead_to_their_crossing(a in point(), b in point(), c in point(), d in point()) {
            prop_assume!((b - a).cosine(d - c).abs() < 0.99 && (b - a).norm() > 0.1 && (d - c).norm() > 0.1);
            let [t, u] = crossing((a, b), (c, d)).unwrap();
            prop_assert!((a + (b - a) * t - c - (d - c) * u).norm() < 1e-6);
            let inner = |share: f64| share > 1e-9 && share < 1.0 - 1e-9;
            let outer = |share: f64| !(-1e-9..=1.0 + 1e-9).contains(&share);
            prop_assert!(!(inner(t) && inner(u)) || crosses((a, b), (c, d)));
            prop_assert!(!(outer(t) || outer(u)) || !crosses((a, b), (c, d)));
        }

        #[test]
        fn a_segment_passes_the_heights_between_its_ends(a in point(), b in point(), t in 0.01..0.99) {
            prop_assume!((b[1] - a[1]).abs() > 1e-3);
            let p = a + (b - a) * t;
            prop_assert!((crossing_at_height((a, b), p[1]).unwrap() - p[0]).abs() < 1e-6);
            prop_assert_eq!(crossing_at_height((a, b), a[1].max(b[1]) + 1.0), None);
        }
    }

    #[test]
    fn a_segment_without_length_is_its_start() {
        let a = Vector([1.0, 2.0, 3.0]);
        assert_eq!(nearest((a, a), Vector::ZERO), a);
    }

    #[test]
    fn parallel_lines_do_not_cross() {
        let along = Vector::xy(2.0, 1.0);
        assert_eq!(crossing((Vector::ZERO, along), (Vector::xy(0.0, 1.0), Vector::xy(0.0, 1.0) + along)), None);
    }
}
