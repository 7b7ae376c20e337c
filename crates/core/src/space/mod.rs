//! Points, boxes and transforms, in the plane and in space alike.

mod bounds;
mod similarity;
mod vector;

pub use bounds::Bounds;
pub use similarity::Similarity;
pub use vector::{Matrix, Vector};
