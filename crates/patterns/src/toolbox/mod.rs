//! Tools that know nothing of patterns.

pub(crate) mod buckets;
pub(crate) mod numbered;
pub(crate) mod solver;
pub(crate) mod spans;
