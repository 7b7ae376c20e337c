//! Geometry as it comes and goes in files of three dimensions: points with attributes, and triangles; lines on squared paper.

mod mesh;
mod points;
mod ruling;

pub use mesh::{MeshPart, TriangleMesh};
pub use points::PointSet;
pub use ruling::{Ruling, corners, ruling};
