//! Directions along a surface: which way a pattern runs on a mesh.

mod curvature;
mod field;
mod sources;
mod transport;

pub use curvature::{Curvature, curvatures};
pub use field::{DirectionField, SurfaceFrame};
pub use sources::{Bend, Directions};
