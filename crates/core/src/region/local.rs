//! The part of polygons that matters in a box.

use crate::{
    region::{Ring, ring},
    space::{Bounds, Vector},
};

/// Rings that cover, by the even-odd rule, the same of `bounds` as `rings` do. Edges that reach into the box are the same to the last
/// bit; what goes on outside is told with as few corners as will do.
pub(super) fn reduced(rings: &[Ring<2>], bounds: &Bounds<2>) -> Vec<Ring<2>> {
    rings.iter().filter_map(|ring| reduced_ring(ring, bounds)).collect()
}

/// A corner that lies on the same side outside of the box as the corners before and after it can go: the triangle of the three, by which
/// the area changes, lies there too.
fn reduced_ring(ring: &[Vector<2>], bounds: &Bounds<2>) -> Option<Ring<2>> {
    let mut kept: Vec<(Vector<2>, u8)> = Vec::new();
    for &p in ring {
        let here = sides(p, bounds);
        while let [.., (_, before), (_, last)] = kept[..]
            && before & last & here != 0
        {
            kept.pop();
        }
        kept.push((p, here));
    }
    let all = kept.iter().fold(u8::MAX, |all, (_, sides)| all & sides);
    (kept.len() >= 3 && all == 0).then(|| kept.into_iter().map(|(p, _)| p).collect())
}

/// The sides of the box on which a point lies outside, one bit each.
fn sides(p: Vector<2>, bounds: &Bounds<2>) -> u8 {
    let bit = |is_out: bool, k: u8| u8::from(is_out) << k;
    bit(p[0] < bounds.min[0], 0)
        | bit(p[0] > bounds.max[0], 1)
        | bit(p[1] < bounds.min[1], 2)
        | bit(p[1] > bounds.max[1], 3)
}

/// The rings cut off at the sides of a box. Where they leave and enter again, they run along its sides.
pub(super) fn cut(rings: &[Ring<2>], bounds: &Bounds<2>) -> Vec<Ring<2>> {
    let sides = [(0, 1.0, bounds.min[0]), (0, -1.0, bounds.max[0]), (1, 1.0, bounds.min[1]), (1, -1.0, bounds.max[1])];
    let cut = |ring: &Ring<2>| sides.iter().fold(ring.clone(), |ring, &side| cut_at(&ring, side));
    rings.iter().map(cut).filter(|ring| ring.len() >= 3).collect()
}

/// What of a ring lies on the far side of a line along the other axis.
fn cut_at(points: &[Vector<2>], (axis, sign, at): (usize, f64, f64)) -> Ring<2> {
    let depth = |p: Vector<2>| sign * (p[axis] - at);
    let mut left = Vec::new();
    for (a, b) in ring::edges(points) {
        let (from, to) = (depth(a), depth(b));
        if from >= 0.0 {
            left.push(a);
        }
        if (from < 0.0) != (to < 0.0) {
            let mut crossing = a + (b - a) * (from / (from - to));
            crossing.0[axis] = at;
            left.push(crossing);
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

    #[test]
    fn nothing_changes_in_the_box() {
        let mut s = Stream::new(7, Stage::TEST, 0);
        let mut inside = 0;
        for round in 0..200 {
            let ring: Ring<2> = (0..40).map(|_| Vector::xy(s.range(-10.0, 10.0), s.range(-10.0, 10.0))).collect();
            let (a, b) =
                (Vector::xy(s.range(-9.0, 5.0), s.range(-9.0, 5.0)), Vector::xy(s.range(0.1, 4.0), s.range(0.1, 4.0)));
            let bounds = Bounds::new(a, a + b);
            let (less, parts) =
                (reduced(std::slice::from_ref(&ring), &bounds), cut(std::slice::from_ref(&ring), &bounds));
            assert!(less.iter().map(Vec::len).sum::<usize>() <= ring.len());
            for _ in 0..20 {
                let p = a + Vector::xy(b[0] * s.range(0.001, 0.999), b[1] * s.range(0.001, 0.999));
                let covers = |rings: &[Ring<2>]| ring::covers(rings.iter().flat_map(|r| ring::edges(r)), p);
                let want = covers(std::slice::from_ref(&ring));
                inside += usize::from(want);
                assert_eq!((covers(&less), covers(&parts)), (want, want), "{round}: {p:?}");
            }
        }
        assert!((500..3500).contains(&inside), "{inside}");
    }

    #[test]
    fn teeth_far_away_go() {
        let tooth = |k: i32| Vector::xy(f64::from(k), if k % 2 == 0 { 0.0 } else { 9.0 });
        let mut comb: Ring<2> = (0..1000).map(tooth).collect();
        comb.extend([Vector::xy(999.0, -1.0), Vector::xy(0.0, -1.0)]);
        let bounds = Bounds::new(Vector::xy(500.0, 3.0), Vector::xy(503.0, 5.0));
        let less = reduced(&[comb], &bounds);
        assert!(less.len() == 1 && less[0].len() < 14, "{less:?}");
    }
}
