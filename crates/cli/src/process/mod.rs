//! The program among other programs: its memory, the signals it gets, what is behind its standard output.

pub(crate) mod closed;
pub(crate) mod memory;
pub(crate) mod sentinel;
mod signals;
pub(crate) mod standard;
