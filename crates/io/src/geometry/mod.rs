//! Points with attributes and triangles, whatever file they come from.

pub(crate) mod attributes;
pub(crate) mod columns;
mod found;
mod polygon;
mod read;
mod weld;

pub(crate) use columns::Columns;
pub use found::{Cloud, Geometry};
pub(crate) use polygon::Polygons;
pub use read::{Kind, kind_of, read_geometry, recipe_of};
pub use weld::welded;
