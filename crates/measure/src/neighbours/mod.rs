//! Elements two by two: the clear space between them, their distances, what they share.

pub(crate) mod clearance;
pub(crate) mod distances;
pub(crate) mod overlaps;
pub(crate) mod pairs;
