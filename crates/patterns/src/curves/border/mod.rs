//! What strokes do at the border of the domain: they are cut there, or turn.

pub(crate) mod fit;
pub(crate) mod hem;
pub(crate) mod trim;
pub(crate) mod turn;
