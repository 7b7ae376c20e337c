//! The texture: what it is, how far it repeats, what is loose in it, where it has a gap.

pub(crate) mod axes;
pub(crate) mod gap;
mod likeness;
pub(crate) mod pieces;
pub(crate) mod reading;
pub(crate) mod repeat;
pub(crate) mod repetition;
pub(crate) mod understand;
