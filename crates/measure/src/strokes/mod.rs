//! Strokes: the graph that they make, and what is told of it.

mod figures;
mod graph;

pub(crate) use figures::{Strokes, strokes};
pub(crate) use graph::{Graph, Node};
