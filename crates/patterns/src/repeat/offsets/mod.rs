//! Repeats by what is recognised again: offsets of marks of one kind are votes for a translation.

pub(crate) mod fit;
pub(crate) mod search;
