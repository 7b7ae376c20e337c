//! Pieces of a picture laid somewhere else.

use crate::space::Vector;

/// A quadrilateral that shows part of an exemplar picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch<const D: usize> {
    /// Which exemplar picture.
    pub source: usize,
    /// Top left, top right, bottom right and bottom left corner in the output.
    pub corners: [Vector<D>; 4],
    /// The same corners in the picture, in pixels from its top left corner; they may lie above or below the picture, where it is
    /// transparent.
    pub texture: [Vector<2>; 4],
}
