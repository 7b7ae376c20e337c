//! Exemplars of separate objects: whole objects one after the other along a curve, with the gaps of the exemplar between them.

pub(crate) mod choice;
pub(crate) mod find;
pub(crate) mod lay;
pub(crate) mod place;
pub(crate) mod run;
pub(crate) mod way;
