//! Where the points are before they are optimised [Roveri 2015 fig. 4].

pub(crate) mod cells;
pub(crate) mod gaps;
pub(crate) mod grow;
pub(crate) mod noise;
pub(crate) mod patches;
pub(crate) mod shake;
