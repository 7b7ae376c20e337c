//! SVG: exemplars, jobs and results.
//!
//! Reading goes from the raw text (`guard`: size, depth, entities) over the parsed file (`source`, `css`, `style`) to a tree of what is
//! drawn (`scene`), whose ink (`ink`) tells elements from curves and background (`select`, `pieces`, `join`) and sorts the elements into
//! classes (`signature`, `classes`). What is kept of an element is markup of its own (`markup`, `definitions`).

mod area;
mod areas;
mod classes;
mod colour;
mod compound;
mod context;
mod css;
mod curves;
mod cut_path;
mod definitions;
mod drawing;
mod extent;
mod flatten;
mod frame;
mod geometry;
mod guard;
mod ink;
mod item;
mod join;
mod length;
mod lines;
mod markup;
mod meta;
mod notes;
mod options;
mod paint;
mod pieces;
mod placed;
mod read;
mod rest;
mod scene;
mod seam;
mod select;
mod signature;
mod simplify;
mod source;
mod stroke;
mod style;
mod touch;
mod traced;
mod twice;
mod within;
mod write;
mod write_areas;
mod write_background;
mod write_curves;
mod write_cut;
mod write_flat;
mod write_kept;
mod write_pieces;
mod write_ribbon;
mod write_survey;
mod write_text;

pub use area::{read_flow, read_shape};
pub use areas::{Area, Areas, read_areas};
pub use cut_path::{Side, cut};
pub use drawing::{Drawing, Fragment, Job, Page, Placed, Stacking, Stroke, Unit};
pub use lines::{Lines, read_lines};
pub use options::{Method, ReadOptions};
pub use placed::read_placed;
pub use read::read_exemplar;
pub use rest::{Rest, read_rest};
pub use simplify::simplified;
pub use write::{Bend, NAMESPACE, Sheet, Style, Written, recipe_of, write_svg};
pub use write_areas::{Filled, areas_markup};
pub use write_ribbon::{Cell, Embedded, Look, RibbonSheet, write_ribbons};
pub use write_survey::write_survey;
