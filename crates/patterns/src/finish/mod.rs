//! From the optimised output to placements: bending, and the last check of exact outlines.

pub(crate) mod clearance;
pub(crate) mod deform;
pub(crate) mod placements;
