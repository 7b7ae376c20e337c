//! Tests that look at several parts at once, and the shapes that they use.

mod directions;
mod mesh;
mod shapes;
mod spread;
