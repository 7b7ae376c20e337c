//! Tables of points.

pub mod csv;
