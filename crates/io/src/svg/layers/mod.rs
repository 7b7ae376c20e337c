//! What lies on what in a drawing: strokes on one geometry as one stroke with several paints, and the order of the
//! layers.

pub(crate) mod coincide;
pub(crate) mod covering;
pub(crate) mod levels;
pub(crate) mod order;
pub(crate) mod stacks;
pub(crate) mod visible;
