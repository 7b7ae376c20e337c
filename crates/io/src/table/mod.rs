//! Tables of points with classes, as CSV.

pub mod csv;
