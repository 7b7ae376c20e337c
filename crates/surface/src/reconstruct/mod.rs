//! From points to a mesh.

mod parts;
mod report;
mod run;
mod sheet;

pub use run::{Reconstruction, reconstruct};
