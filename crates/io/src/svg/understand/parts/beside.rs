//! Whether the frame cut a thing that lies whole elsewhere: the rings in a net that are drawn with its pen.

use arabesque_core::{Bounds, Outline, Vector, segment};

use crate::svg::shape::{adjacency::Edge, extent::longer};

/// How far a part may lie from the outline of the whole, as a share of its size.
const NEAR: f64 = 0.02;
/// Places along a part that are looked at.
const LOOKED_AT: usize = 48;
/// Work for a place and an edge.
pub(crate) const PAIR: u64 = 3;

/// Whether the part, or the whole, of something that reaches a side of the frame lies along a whole thing that is moved there; with how
/// many pairs of places and edges were looked at.
pub(crate) fn is_part_of(part: &[&Outline<2>], whole: &[&Outline<2>], frame: &Bounds<2>) -> (bool, u64) {
    let extent = |outlines: &[&Outline<2>]| outlines.iter().fold(Bounds::EMPTY, |all, o| all.union(&o.bounds()));
    let (there, here) = (extent(part), extent(whole));
    let near = NEAR * longer(&here);
    if (0..2).any(|k| there.size()[k] > here.size()[k] + near) {
        return (false, 1);
    }
    let edges: Vec<Edge> = whole.iter().flat_map(|outline| outline.edges()).collect();
    let is_seen = |p: &Vector<2>| frame.contains(*p);
    let along = |(a, b): Edge| [0.2, 0.4, 0.6, 0.8].map(|t| a + (b - a) * t);
    let places: Vec<Vector<2>> =
        part.iter().flat_map(|outline| outline.edges()).flat_map(along).filter(is_seen).collect();
    let places: Vec<Vector<2>> = places.iter().step_by(places.len().div_ceil(LOOKED_AT).max(1)).copied().collect();
    let mut looked = 0;
    // What is left of it ends where the whole does, at one end along each axis.
    let shift = |ends: [bool; 2]| {
        let at = |b: &Bounds<2>, k: usize| if ends[k] { b.max[k] } else { b.min[k] };
        Vector::xy(at(&there, 0) - at(&here, 0), at(&there, 1) - at(&here, 1))
    };
    let found = [[false, false], [true, false], [false, true], [true, true]].into_iter().any(|ends| {
        let by = shift(ends);
        places.iter().all(|p| {
            looked += edges.len() as u64;
            let at_frame = (0..2).any(|k| (p[k] - frame.min[k]).min(frame.max[k] - p[k]) <= near);
            at_frame || edges.iter().any(|&e| segment::distance(e, *p - by) <= near)
        })
    });
    (found && !places.is_empty(), looked)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn ring(x: f64, r: f64) -> Outline<2> {
        let at = |r: f64, k: u32| {
            let (sin, cos) = (f64::from(k) / 32.0 * TAU).sin_cos();
            Vector::xy(x + r * cos, 50.0 + r * sin)
        };
        let outer = (0..32).map(|k| at(r + 1.0, k)).collect();
        Outline { rings: vec![outer, (0..32).rev().map(|k| at(r - 1.0, k)).collect()] }
    }

    fn is_part(part: &Outline<2>, whole: &Outline<2>) -> bool {
        is_part_of(&[part], &[whole], &Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0))).0
    }

    #[test]
    fn a_ring_that_reaches_over_the_frame_is_part_of_one_like_it() {
        assert!(is_part(&ring(3.0, 9.0), &ring(50.0, 9.0)));
        let mut half = ring(0.0, 9.0);
        half.rings.iter_mut().flatten().for_each(|p| p[0] = p[0].max(0.0));
        assert!(is_part(&half, &ring(50.0, 9.0)));
        assert!(!is_part(&ring(3.0, 9.0), &ring(50.0, 7.0)) && !is_part(&ring(3.0, 5.0), &ring(50.0, 9.0)));
    }

    #[test]
    fn a_strand_of_a_net_is_none() {
        let line = [(0.0, 44.0), (8.0, 40.0), (8.0, 42.0), (0.0, 46.0)].map(|(x, y)| Vector::xy(x, y));
        assert!(!is_part(&Outline { rings: vec![line.to_vec()] }, &ring(50.0, 9.0)));
    }
}
