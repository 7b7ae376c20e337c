//! USD as text: scenes out, with one instancer for all elements.
//!
//! Prototypes are meshes with their materials; places are lists of positions, orientations and scales. Orientations are half floats in
//! the format, so that they have three digits. Pictures of materials are left out: a text holds none.

mod names;
mod write;

pub use write::write_usda;
