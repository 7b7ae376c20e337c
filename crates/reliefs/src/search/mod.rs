//! Distance fields, and where they fit best.

pub(crate) mod best;
pub(crate) mod fft;
pub(crate) mod field;
