//! What strokes do at the border of the domain: they are cut there, or turn.

pub(crate) mod border_turn;
pub(crate) mod fit;
pub(crate) mod join;
pub(crate) mod rings;
pub(crate) mod trim;
