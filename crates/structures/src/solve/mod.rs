//! The local-global solver [Roveri 2015 §5.1, algorithm 1].

pub(crate) mod apart;
pub(crate) mod attributes;
pub(crate) mod matching;
pub(crate) mod merging;
pub(crate) mod newton;
pub(crate) mod part;
pub(crate) mod round;
pub(crate) mod sampling;
#[cfg(test)]
mod tests;
