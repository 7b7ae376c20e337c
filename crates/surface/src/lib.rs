//! Surfaces of points and triangles.

mod mesh;
#[cfg(test)]
mod tests;

pub use mesh::{Closest, Found, MeshIndex, MeshReport};
