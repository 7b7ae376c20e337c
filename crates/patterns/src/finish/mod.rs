//! From the optimised output to placements, the last check of exact outlines, and the order of
//! painting.

pub(crate) mod clearance;
pub(crate) mod loose;
pub(crate) mod order;
pub(crate) mod placements;
pub(crate) mod solids;
