//! What is known about the exemplar before any run: its elements, their samples at every level, and how curves are
//! sampled.
//!
//! Nothing here depends on a domain: it is worked out once and serves any number of runs.

pub(crate) mod checks;
pub(crate) mod closest;
pub(crate) mod differences;
pub(crate) mod features;
pub(crate) mod graph;
pub(crate) mod kinds;
pub(crate) mod level;
pub(crate) mod level_exemplar;
pub(crate) mod library;
pub(crate) mod places;
pub(crate) mod samples;
pub(crate) mod upright;
