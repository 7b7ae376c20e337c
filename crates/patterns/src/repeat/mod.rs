//! The repeat of an exemplar: by which translations it goes over into itself.
//!
//! Everything that can be recognised again is a mark: whole elements, and on lines their ends, their crossings and the
//! places where they pass through one of a few directions. Offsets of marks of one kind are votes for a translation;
//! one that takes nearly every mark to another, wherever the frame shows what should be there, is a repeat. The two
//! shortest that are independent span the lattice, which least squares over all marks then place exactly
//! ([Pauly 2008] for voting in the space of transformations, [Liu 2004] for near-regular lattices).

pub(crate) mod description;
pub(crate) mod find;
pub(crate) mod lattice;
pub(crate) mod lines;
pub(crate) mod looks;
pub(crate) mod marks;
pub(crate) mod near;
pub(crate) mod offsets;
pub(crate) mod one_way;
pub(crate) mod orbits;
pub(crate) mod seamless;
pub(crate) mod straight;
pub(crate) mod support;
pub(crate) mod symmetry;
pub(crate) mod tile;
pub(crate) mod unknown;

pub use description::{Explains, Extent, Repeat};
pub use find::find;
pub use lattice::Lattice;
pub use marks::Anchor;
pub use seamless::NearTile;
pub use symmetry::{FriezeGroup, PlaneGroup, Symmetry, symmetry};
pub use tile::TileFit;
