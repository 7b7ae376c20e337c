//! Ends and crossings that the exemplar would not show, joined or removed: beyond the paper.

pub(crate) mod crossings;
pub(crate) mod dangles;
pub(crate) mod joints;
pub(crate) mod mend;
pub(crate) mod missing;
