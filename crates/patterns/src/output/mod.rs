//! The output while it is made: where items lie, what they were copied from, and what their samples were matched with.

pub(crate) mod canvas;
pub(crate) mod draft;
pub(crate) mod state;
