//! Points of the result.

use arabesque_core::Vector;

/// A point with what it carries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    pub(crate) at: Vector<3>,
    pub(crate) normal: Vector<3>,
    pub(crate) colour: [f32; 3],
    /// How far the surface around is from a plane, in the texture.
    pub(crate) variation: f32,
    /// The point of the texture that it stands for.
    pub(crate) source: u32,
    /// Whether it lies along a seam.
    pub(crate) is_at_seam: bool,
    /// The loose piece that it belongs to, from 1 on; 0 for none.
    pub(crate) piece: u32,
    /// Where it lies from the middle of its piece.
    pub(crate) from: [f32; 2],
}

impl Sample {
    /// The middle of its piece, at its own height.
    pub(crate) fn middle(&self) -> Vector<3> {
        self.at - Vector([f64::from(self.from[0]), f64::from(self.from[1]), 0.0])
    }
}
