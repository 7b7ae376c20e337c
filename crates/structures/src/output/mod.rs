//! The output while it is made, and what comes of it.

pub(crate) mod finish;
pub(crate) mod parts;
pub(crate) mod state;
