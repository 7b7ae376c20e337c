//! Tests that look at several parts at once, and the shapes that they use.

mod mesh;
pub(crate) mod shapes;
