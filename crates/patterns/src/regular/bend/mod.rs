//! Patterns that repeat, bent by fields that vary.
//!
//! Turn and scale at every place say how a map from the page to the exemplar should change there. It is found by least
//! squares on a raster; where it follows the fields closely enough, the drawing is continued in the exemplar's own
//! coordinates, as on a flat page, and carried back. No such map follows a field that turns or grows without end: then
//! the page is divided into charts, each with a map of its own, which lie so that the lattices of neighbours meet as
//! well as they can. Where they do not, the lattice breaks.

pub(crate) mod areas;
pub(crate) mod chart;
pub(crate) mod charts;
pub(crate) mod elements;
pub(crate) mod fill;
pub(crate) mod raster;
pub(crate) mod seams;
pub(crate) mod strokes;
