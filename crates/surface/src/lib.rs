//! Surfaces of points and triangles.

mod directions;
mod mesh;
mod spread;
#[cfg(test)]
mod tests;

pub use directions::{Bend, Curvature, DirectionField, Directions, SurfaceFrame, curvatures};
pub use mesh::{Closest, Found, MeshIndex, MeshReport};
pub use spread::{inside_grid, scatter, shell_grid};
