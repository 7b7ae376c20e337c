//! Repeats in one direction: which of the two vectors is the repeat, and which is there for the cell alone.

use arabesque_core::{Bounds, Vector};

use crate::repeat::description::{Extent, Repeat};

/// Lengths that differ by less than this share of the frame are the same.
const SAME: f64 = 1e-6;

impl Repeat {
    /// The translation of a frieze or of stripes in a frame; `None` for what repeats in two directions.
    pub fn step(&self, window: &Bounds<2>) -> Option<Vector<2>> {
        let [a, b] = self.lattice.vectors;
        match self.extent {
            Extent::Plane => None,
            Extent::Stripes(along) => Some(if a.cross(along).abs() >= b.cross(along).abs() { a } else { b }),
            Extent::Frieze => {
                // The other one is the frame from side to side, which holds the repeat more than once.
                let size = window.size();
                let side = |v: Vector<2>| size[usize::from(v[1].abs() > v[0].abs())];
                let is_frame = |v: Vector<2>| (v.norm() - side(v)).abs() <= SAME * size.norm();
                Some(if is_frame(a) && !is_frame(b) { b } else { a })
            }
        }
    }
}
