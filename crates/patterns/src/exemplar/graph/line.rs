//! A connected part of a curve.

use arabesque_core::Measured;

/// A connected part of an exemplar curve.
#[derive(Clone, Debug)]
pub(crate) struct Line<const D: usize> {
    pub(crate) measured: Measured<D>,
    /// Index into the curves.
    pub(crate) curve: u32,
    /// Half of this is how far its ink reaches.
    pub(crate) width: f64,
    /// Whether the window cuts it at its start, at its end.
    pub(crate) is_cut: [bool; 2],
    /// Knots along it, by arc length: (arc, knot).
    pub(crate) stops: Vec<(f64, u32)>,
}
