//! Tables: points with classes or with attributes.

pub mod centres;
pub mod csv;
pub mod placed;
pub mod points;
pub(crate) mod records;
pub mod values;
pub mod xyz;
