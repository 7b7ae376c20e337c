//! Points and meshes in space, for every method that takes or makes some: read from files of any format, and written.

pub(crate) mod read;
pub(crate) mod scene;
pub(crate) mod write;
