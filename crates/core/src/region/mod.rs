//! Areas: outlines with their boolean operations, shapes that answer distances, and domains.

mod domain;
mod outline;
mod shape;

pub use domain::{Domain, Region};
pub use outline::{FillRule, Outline, Ring, ring_area};
pub use shape::Shape;
