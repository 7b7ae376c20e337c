//! The file of which a part was refilled, with the new in it.

pub(crate) mod between;
