//! Where the output may lie, and how the pattern is turned and scaled there [Roveri 2015 §6.2].

pub(crate) mod flat;
pub(crate) mod plan;
pub(crate) mod shell;
pub(crate) mod site;
pub(crate) mod solid;
pub(crate) mod tube;
