//! SVG: exemplars, jobs and results.

mod drawing;
mod options;
mod read;

pub use drawing::{Drawing, Fragment, Job, Page, Placed, Unit};
pub use options::{Method, ReadOptions};
pub use read::{read_exemplar, read_flow, read_placed, read_shape};
