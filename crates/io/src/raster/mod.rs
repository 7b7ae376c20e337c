//! Pictures made of pixels: results drawn as PNG, exemplars, and pictures that stand for numbers.

pub mod field;
pub mod image;
pub mod mask;
pub mod png;
pub mod size;
