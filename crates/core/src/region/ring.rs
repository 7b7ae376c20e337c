//! Questions about closed polygons, whose last point is joined to the first.

use crate::{
    region::segment::{Segment, crossing_at_height},
    space::Vector,
};

/// The edges of a ring, the one from the last point to the first at the end.
pub fn edges(ring: &[Vector<2>]) -> impl Iterator<Item = Segment<2>> + '_ {
    (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()]))
}

/// Signed area of a ring: positive when it turns from x towards y.
pub fn area(ring: &[Vector<2>]) -> f64 {
    edges(ring).map(|(a, b)| a.cross(b)).sum::<f64>() * 0.5
}

/// Whether `p` is covered by what lies between `edges`, those of one ring or of several: an odd number of them is to its right.
pub fn covers(edges: impl IntoIterator<Item = Segment<2>>, p: Vector<2>) -> bool {
    let is_right = |edge: &Segment<2>| crossing_at_height(*edge, p[1]).is_some_and(|x| p[0] < x);
    edges.into_iter().filter(is_right).count() % 2 == 1
}

/// Whether a ring turns one way all along, once around: then it cannot cross itself.
pub fn is_convex(ring: &[Vector<2>]) -> bool {
    let n = ring.len();
    let edge = |k: usize| ring[(k + 1) % n] - ring[k % n];
    let mut turned = 0.0;
    let mut sign = 0.0;
    for k in 0..n {
        let (a, b) = (edge(k), edge(k + 1));
        let cross = a.cross(b);
        if cross * sign < 0.0 || a.norm2() == 0.0 {
            return false;
        }
        if cross != 0.0 {
            sign = cross.signum();
        }
        turned += cross.atan2(a.dot(b));
    }
    n >= 3 && (turned.abs() - std::f64::consts::TAU).abs() < 1e-6
}

/// How often a ring turns around `p`: 0 outside, negative where it turns from y towards x.
pub fn winding(ring: &[Vector<2>], p: Vector<2>) -> i32 {
    let mut turns = 0;
    for (a, b) in edges(ring) {
        if (a[1] <= p[1]) != (b[1] <= p[1]) {
            let right = (b - a).cross(p - a) > 0.0;
            turns += match (b[1] > a[1], right) {
                (true, true) => 1,
                (false, false) => -1,
                _ => 0,
            };
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn star(points: usize) -> Vec<Vector<2>> {
        let corner = |k: usize| {
            let turn = k as f64 / points as f64 * std::f64::consts::TAU;
            Vector::xy(turn.cos(), turn.sin()) * if k.is_multiple_of(2) { 10.0 } else { 4.0 }
        };
        (0..points).map(corner).collect()
    }

    proptest! {
        #[test]
        fn a_ring_turns_once_around_what_it_covers(x in -11.0..11.0, y in -11.0..11.0) {
            let (mut ring, p) = (star(14), Vector::xy(x, y));
            prop_assert_eq!(winding(&ring, p), i32::from(covers(edges(&ring), p)));
            ring.reverse();
            prop_assert_eq!(winding(&ring, p), -i32::from(covers(edges(&ring), p)));
        }
    }

    #[test]
    fn a_ring_inside_another_leaves_a_hole() {
        let (outer, inner) = (star(4), star(4).into_iter().map(|p| p * 0.2).collect::<Vec<_>>());
        let all = || edges(&outer).chain(edges(&inner));
        assert!(!covers(all(), Vector::xy(0.1, 0.2)) && covers(all(), Vector::xy(5.0, 0.2)));
    }

    #[test]
    fn stars_are_not_convex() {
        assert!(is_convex(&star(4)) && !is_convex(&star(14)) && !is_convex(&[]));
        let twice: Vec<_> = [star(4), star(4)].concat();
        assert!(!is_convex(&twice), "twice around");
    }

    #[test]
    fn area_has_a_sign() {
        let mut square = [(0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (0.0, 3.0)].map(|(x, y)| Vector::xy(x, y));
        assert_eq!(area(&square), 6.0);
        square.reverse();
        assert_eq!(area(&square), -6.0);
        assert_eq!(area(&[]), 0.0);
    }
}
