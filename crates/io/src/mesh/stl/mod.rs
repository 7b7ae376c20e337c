//! STL: triangles that share nothing, as text or bytes, in; equal corners become one vertex.

mod binary;
mod read;
mod text;
mod weld;

pub use read::{is_stl, read_stl};
