//! Patterns that repeat, continued exactly.
//!
//! An exemplar that a lattice explains says everything about how it goes on: elements are put at the places of the
//! lattice, each with the small deviation of the one it is copied from; strokes and filled areas are the pieces of one cell, joined
//! from cell to cell. Nothing is optimised, so nothing slips or drifts. Where only the places repeat, what lies at them is
//! chosen by what lies beside what in the exemplar. Fields that vary bend the lattice, and break it where they must
//! (`bend`).

pub(crate) mod admit;
pub(crate) mod areas;
pub(crate) mod bend;
pub(crate) mod choice;
pub(crate) mod cut;
pub(crate) mod elements;
pub(crate) mod fill;
pub(crate) mod grid;
pub(crate) mod joints;
pub(crate) mod kept;
pub(crate) mod lost;
pub(crate) mod strokes;

pub(crate) use fill::Filled;
pub use fill::Regular;
