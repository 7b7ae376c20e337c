//! SVG: exemplars, jobs and results.

mod drawing;

pub use drawing::{Drawing, Fragment, Job, Page, Unit};
