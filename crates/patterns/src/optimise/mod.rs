//! The steps of one iteration: search, then assign attributes, positions and existence [Ma 2011 §4.2; Tu 2020 §4.3].

pub(crate) mod assignment;
pub(crate) mod attributes;
pub(crate) mod between;
pub(crate) mod existence;
pub(crate) mod matching;
pub(crate) mod positions;
pub(crate) mod search;
pub(crate) mod targets;
