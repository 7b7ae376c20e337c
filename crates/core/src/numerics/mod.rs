//! Tools of computing that know nothing of shapes: sets, pairs, orders, linear equations, least squares.

mod conjugate_gradients;
mod disjoint_sets;
pub mod pairing;
mod precedence;
mod predictions;

pub use conjugate_gradients::{Equations, conjugate_gradients};
pub use disjoint_sets::DisjointSets;
pub use precedence::{Precedence, Vote, precedence};
pub use predictions::{NormalEquations, Prediction, Pull};
