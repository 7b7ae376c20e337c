//! The dynamic programme: row by row along a curve, and around it where it is closed.

pub(crate) mod reuse;
pub(crate) mod row;
pub(crate) mod solve;
