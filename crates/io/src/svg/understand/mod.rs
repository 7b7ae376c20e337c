//! What a drawing means: which parts are elements, curves and background, and which elements are of one class.

pub(crate) mod abutting;
pub(crate) mod classes;
pub(crate) mod compound;
pub(crate) mod curves;
pub(crate) mod dashes;
pub(crate) mod fragment;
pub(crate) mod frame;
pub(crate) mod item;
pub(crate) mod join;
pub(crate) mod outlined_lines;
pub(crate) mod parts;
pub(crate) mod pieces;
pub(crate) mod ruled;
pub(crate) mod select;
pub(crate) mod surroundings;
