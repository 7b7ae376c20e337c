//! Points sorted by where they lie: an index of known points, one that grows, and the lattice of cells below both.

mod buckets;
mod grid;
mod lattice;

pub use buckets::Buckets;
pub use grid::GridIndex;
pub use lattice::Lattice;
