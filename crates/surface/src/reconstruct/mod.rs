//! From points to a mesh.

mod lid;
mod parts;
mod report;
mod run;
mod sheet;

pub use run::{Reconstruction, reconstruct};
