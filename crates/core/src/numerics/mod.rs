//! Tools of computing that know nothing of shapes: sets, pairs, linear equations.

mod conjugate_gradients;
mod disjoint_sets;
pub mod pairing;

pub use conjugate_gradients::{Equations, conjugate_gradients};
pub use disjoint_sets::DisjointSets;
