//! SVG: exemplars, jobs and results.
//!
//! Reading goes from the raw text over the parsed file to a tree of what is drawn (`parse`), whose painted area
//! (`shape`) tells elements from curves and background and sorts the elements into classes (`understand`). A drawing of
//! one period is laid out as several before (`swatch`). What lies on what makes strokes with several paints and the
//! layers of the result (`layers`). `read` holds what callers ask for, `write` the way back to text; both speak of a
//! [`Drawing`].

mod cell;
mod centreline;
mod copies;
mod drawing;
mod layers;
mod namespace;
mod options;
mod palette;
mod parse;
mod placed;
mod read;
mod reason;
mod shape;
mod swatch;
mod understand;
mod write;

pub use crate::text::unit::Unit;
pub use cell::{RepeatCell, with_cell};
pub use drawing::{Drawing, Fragment, HostDocument, Job, KeptStrokes, Layer, Page, Placed, Stroke};
pub use namespace::NAMESPACE;
pub use options::{Dashes, LargeFills, Method, Parts, ReadOptions, Tiling};
pub use palette::PALETTE;
pub use placed::{Mark, SvgElements, check_paint, with_marks};
pub use read::{
    document::Document,
    domain::read_shape,
    exemplar::{read_exemplar, shows_period},
    flow::read_flow,
    guides::{Lines, read_lines},
    host_document::read_host_document,
    painted_areas::{Area, Areas, read_areas},
    placed::read_placed,
};
pub use reason::{Reason, Understood};
pub use shape::{
    cut_path::{Side, cut},
    simplify::simplified,
};
pub use write::{
    document::recipe_of,
    report::{
        marked::{MarkedPlace, MarkedSheet, PanelLine, write_marked},
        survey::write_survey,
    },
    result::write_svg,
    ribbon::{
        Cell, Embedded, Look, RibbonSheet,
        areas::{Filled, areas_markup},
        write_ribbons,
    },
    sheet::{Bend, Sheet, Style, Written},
};
