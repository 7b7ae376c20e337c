//! Surfaces of points and triangles.

mod cloud;
mod dipoles;
mod directions;
mod implicit;
mod isosurface;
mod mesh;
mod params;
mod reconstruct;
mod spread;
#[cfg(test)]
mod tests;
mod tree;

pub use directions::{Bend, Curvature, DirectionField, Directions, SurfaceFrame, curvatures};
pub use mesh::{Closest, Found, MeshIndex, MeshReport};
pub use params::{Method, Normals, Parts, SurfaceParams};
pub use reconstruct::{Reconstruction, reconstruct};
pub use spread::{inside_grid, scatter, shell_grid};
