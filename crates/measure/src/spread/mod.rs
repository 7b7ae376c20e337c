//! How ink and elements are spread over the page and along its border.

pub(crate) mod border;
pub(crate) mod density;
pub(crate) mod evenness;
pub(crate) mod raster;
