//! Points with normals as a surface by themselves, without a mesh: where its nearest point is, where a ray meets it, how it bends.

mod clusters;
mod estimate;
mod grid;
mod points;
mod variation;

pub use clusters::clusters;
pub use estimate::{EstimatedNormals, estimated_normals, spacing_of};
pub use points::{Foot, OrientedPoints};
pub use variation::thinnest_direction;
