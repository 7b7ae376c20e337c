//! The curves of the exemplar as lines with knots, and as a sample graph [Tu 2020 §4.1].

pub(crate) mod contact;
pub(crate) mod crowding;
pub(crate) mod line;
pub(crate) mod net;
pub(crate) mod pseudo;
pub(crate) mod skeleton;
