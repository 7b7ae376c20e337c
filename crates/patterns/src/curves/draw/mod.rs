//! From edges to strokes [Tu 2020 §4.4.2], and from strokes to the samples of the next level [Tu 2020 §4.3.5].

pub(crate) mod chains;
pub(crate) mod resample;
pub(crate) mod shape;
