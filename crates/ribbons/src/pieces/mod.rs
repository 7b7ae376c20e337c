//! What pieces look like: straight-sided facets of pictures, and areas of drawings.

pub(crate) mod facets;
pub(crate) mod rungs;
pub(crate) mod vector;
