//! Points of the result.

use arabesque_core::Vector;

/// A point with what it carries.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}
