//! The surface at which a field is zero, as triangles.

mod cases;
mod clean;
mod cut;
mod march;
mod patch;

pub(crate) use clean::{crumbs, pinches};
pub(crate) use cut::{beyond_border, cut};
pub(crate) use march::march;
pub(crate) use patch::Patch;
