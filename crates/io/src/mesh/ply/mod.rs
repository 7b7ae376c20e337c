//! PLY: points with attributes and meshes, as text and in both binary orders, in and out.

mod header;
mod read;
mod recipe;
mod rows;
mod scalar;
#[cfg(test)]
mod tests;
mod write;

pub use read::read_ply;
pub(crate) use recipe::recipe_comments;
pub use recipe::{is_ply, recipe_of};
pub use write::{Encoding, PlyFile, write_ply};
