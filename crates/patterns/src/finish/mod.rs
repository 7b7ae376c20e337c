//! From the optimised output to placements, and the last check of exact outlines.

pub(crate) mod clearance;
pub(crate) mod placements;
