//! Results as files of placed elements, which can be read back and changed in a few places.
//!
//! What is common to all formats stands here; each format has its own file beside its reader and writer.

pub(crate) mod digits;
pub(crate) mod ids;
pub(crate) mod layout;
pub(crate) mod splice;

pub use layout::{Changes, Item, Layout, Paint, PlacedFile, Replaced};
