//! SVG: exemplars, jobs and results.
//!
//! Reading goes from the raw text over the parsed file to a tree of what is drawn (`parse`), whose painted area (`shape`) tells elements
//! from curves and background and sorts the elements into classes (`understand`). `read` holds what callers ask for, `write` the way
//! back to text; both speak of a [`Drawing`].

mod centreline;
mod drawing;
mod options;
mod parse;
mod read;
mod shape;
mod understand;
mod write;

pub use drawing::{Drawing, Fragment, Job, Page, Placed, Stacking, Stroke, Unit};
pub use options::{Method, ReadOptions};
pub use read::{
    domain::{read_flow, read_shape},
    exemplar::read_exemplar,
    guides::{Lines, read_lines},
    host_document::{Rest, read_rest},
    painted_areas::{Area, Areas, read_areas},
    placed::read_placed,
};
pub use shape::{
    cut_path::{Side, cut},
    simplify::simplified,
};
pub use write::{
    areas::{Filled, areas_markup},
    result::{Bend, NAMESPACE, Sheet, Style, Written, recipe_of, write_svg},
    ribbon::{Cell, Embedded, Look, RibbonSheet, write_ribbons},
    survey::write_survey,
};
