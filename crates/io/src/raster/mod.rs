//! Pictures made of pixels: results drawn as PNG, exemplars, and pictures that stand for numbers.

mod demand;
mod drawn;
mod expansion;
pub mod field;
mod filtered;
pub mod heights;
pub mod image;
pub mod mask;
mod palette;
pub mod png;
pub mod rows;
pub mod size;
