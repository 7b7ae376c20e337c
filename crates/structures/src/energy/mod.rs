//! The similarity error [Roveri 2015 §4] and its slopes.

pub(crate) mod back;
#[cfg(test)]
pub(crate) mod exact;
pub(crate) mod exp;
pub(crate) mod kernel;
pub(crate) mod level;
pub(crate) mod links;
