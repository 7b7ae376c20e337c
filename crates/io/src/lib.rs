//! Files to core types and back: SVG, PNG, CSV, OBJ, GLB, JSON.
//!
//! One module a format. Everything read is held to [`arabesque_core::Limits`]; everything written is the same bytes for the same result.
//! Only [`mod@file`] touches the file system: the others turn bytes into values and values into bytes.

pub mod centreline;
pub mod csv;
pub mod file;
pub mod gltf;
pub mod image;
pub mod json;
pub mod mask;
pub mod nearest;
pub mod number;
pub mod obj;
pub mod obj_strip;
pub mod path_data;
pub mod picture;
pub mod png;
pub mod ribbon_json;
pub mod strip;
pub mod svg;
