//! What several text formats share: path data, units, XML, and what messages show of a file.

pub mod path_data;
pub(crate) mod short;
pub mod unit;
pub(crate) mod xml;
