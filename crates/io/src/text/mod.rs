//! What several text formats share: path data, and which known word was meant.

pub mod path_data;
pub mod unit;
pub(crate) mod xml;
