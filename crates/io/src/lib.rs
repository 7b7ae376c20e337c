//! Files to core types and back: SVG, PNG, PLY, OBJ, STL, GLB, CSV, JSON; and pictures of points and meshes.
//!
//! A folder for each kind of format. Everything read is held to [`arabesque_core::Limits`]; everything written is the
//! same bytes for the same result. Only [`mod@file`] touches the file system: the others turn bytes into values and
//! values into bytes.

pub mod file;
pub mod geometry;
pub mod json;
pub mod mesh;
pub mod placed;
pub mod raster;
pub mod render;
pub mod svg;
pub mod table;
pub mod text;
