//! Points sorted by where they lie: an index of known points, one that grows, the lattice of cells below both; and lists by number.

mod buckets;
mod grid;
mod lattice;
mod numbered;

pub use buckets::Buckets;
pub use grid::GridIndex;
pub use lattice::Lattice;
pub use numbered::{Number, Numbered};
