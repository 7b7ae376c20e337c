//! The similarity error [Roveri 2015 §4] and its slopes.

pub(crate) mod back;
pub(crate) mod kernel;
pub(crate) mod level;
pub(crate) mod links;
