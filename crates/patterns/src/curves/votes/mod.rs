//! What the matches say about strokes: which samples an edge joins, and in which directions strokes leave them
//! [Tu 2020 §4.3.4].

pub(crate) mod edge_votes;
pub(crate) mod edges;
pub(crate) mod tangents;
