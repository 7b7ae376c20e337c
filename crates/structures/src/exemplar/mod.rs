//! The exemplar: what it is made of, how densely its points lie, along which directions it repeats, and how far.

pub(crate) mod bodies;
pub(crate) mod channels;
pub(crate) mod field;
pub(crate) mod known;
pub(crate) mod pattern;
pub(crate) mod repetition;
pub(crate) mod spacing;
