//! Geometry of what is drawn: the area that is painted, its extent, what touches what, and lines cut or simplified.

pub(crate) mod adjacency;
pub(crate) mod cut_path;
pub(crate) mod duplicates;
pub(crate) mod extent;
pub(crate) mod flatten;
pub(crate) mod idle;
pub(crate) mod painted_area;
pub(crate) mod simplify;
pub(crate) mod stroke;
pub(crate) mod subpath;
