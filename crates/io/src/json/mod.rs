//! JSON: results with everything that is known of them, one document for each job.

pub mod broken;
pub mod fill;
pub mod geometry;
pub mod placed;
pub mod placements;
pub mod ribbon;
mod warning;

pub use fill::{Frame, recipe_of, write_json};
