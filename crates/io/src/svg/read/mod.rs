//! What is read of a file, one reader for each use: exemplar, domain, flow, guides, painted areas, what is placed
//! already, and the file that a result is written into.

pub(crate) mod crop;
pub(crate) mod document;
pub(crate) mod domain;
pub(crate) mod exemplar;
pub(crate) mod flow;
pub(crate) mod guides;
pub(crate) mod host_document;
pub(crate) mod host_text;
pub(crate) mod layers;
pub(crate) mod matcher;
pub(crate) mod missing_paints;
pub(crate) mod painted_areas;
pub(crate) mod placed;
pub(crate) mod sorter;
