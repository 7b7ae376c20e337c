//! Points sorted by where they lie.

mod grid;

pub use grid::GridIndex;
