//! Values as text.

mod number;

pub use number::{Decimals, rounded};
