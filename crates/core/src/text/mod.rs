//! Values as text.

mod number;

pub(crate) use number::abridged;
pub use number::{Decimals, rounded};
