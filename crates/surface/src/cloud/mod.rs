//! Points as a surface is made of them: their neighbours, their spacing, and their normals.

mod buried;
mod eigen;
mod neighbours;
mod normals;
mod sheets;

pub(crate) use buried::buried;
pub(crate) use eigen::eigen;
pub(crate) use neighbours::Neighbours;
pub(crate) use normals::{contradictions, estimated, mended, turned};
pub(crate) use sheets::sheets;
