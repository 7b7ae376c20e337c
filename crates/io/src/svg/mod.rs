//! SVG: exemplars, jobs and results.

mod drawing;
mod options;
mod read;
mod write;
mod write_background;
mod write_cut;
mod write_flat;
mod write_pieces;
mod write_survey;

pub use drawing::{Drawing, Fragment, Job, Page, Placed, Unit};
pub use options::{Method, ReadOptions};
pub use read::{read_exemplar, read_flow, read_placed, read_shape};
pub use write::{Bend, NAMESPACE, Sheet, Style, Written, recipe_of, write_svg};
pub use write_survey::write_survey;
