//! Tests that look at several parts at once, and the shapes that they use.

mod bad_input;
mod directions;
mod lattice;
pub(crate) mod manifold;
mod mesh;
mod reconstruction;
mod shapes;
mod spread;
