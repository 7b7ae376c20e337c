//! Geometry as it comes and goes in files of three dimensions: points with attributes, and triangles.

mod mesh;
mod points;

pub use mesh::{MeshPart, TriangleMesh};
pub use points::PointSet;
