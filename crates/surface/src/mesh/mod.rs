//! Triangle meshes: the nearest point, inside and outside, and what is wrong with one.

mod crossings;
mod index;
mod report;
pub(crate) mod topology;
mod triangle;

pub(crate) use index::raising;
pub use index::{Closest, MeshIndex};
pub use report::{Found, MeshReport};
