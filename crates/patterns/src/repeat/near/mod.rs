//! Repeats of which everything is only about in place: rows by hand.
//!
//! A person who draws rows keeps to them all over the page, however far each thing lies off. So the places are asked as a
//! whole: where a lattice has one place in a cell, waves of which the crests run along its rows add up over all places, and
//! nothing else does ([Bragg 1913]). What then lies at the nodes is one of a few kinds, by a lattice of its own in the nodes, or
//! not.

pub(crate) mod kinds;
pub(crate) mod nodes;
pub(crate) mod places;
pub(crate) mod rows;
pub(crate) mod spectrum;
