//! The nearest known name to a mistyped one, by its older path.

pub use arabesque_core::suggest::nearest;
