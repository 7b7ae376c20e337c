//! Pieces of ribbons and what they look like: pixels, straight-sided facets of pictures, and areas of drawings.

pub(crate) mod facets;
pub(crate) mod piece;
pub(crate) mod render;
pub(crate) mod rungs;
pub(crate) mod stitch;
pub(crate) mod vector;
