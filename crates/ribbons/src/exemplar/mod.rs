//! Exemplars as the search sees them: pixels, columns of pixels, and boxes of similar columns.

pub(crate) mod bits;
pub(crate) mod cluster;
pub(crate) mod columns;
pub(crate) mod strip;
