//! Pictures that tell of a drawing: what was understood of it, and what is wrong with it.

pub(crate) mod marked;
pub(crate) mod survey;
