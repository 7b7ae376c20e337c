//! Points, boxes and transforms, in the plane and in space alike.

mod bounds;
mod cells;
mod matrix;
pub(crate) mod periodic;
mod similarity;
mod spread;
mod vector;
mod warp;

pub use bounds::Bounds;
pub use cells::{cell_index, cell_place};
pub use matrix::Matrix;
pub use similarity::Similarity;
pub use spread::Spread;
pub use vector::Vector;
pub use warp::{Warp, warp};
