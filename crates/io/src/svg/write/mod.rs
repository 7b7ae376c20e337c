//! Results as SVG text: a file of placed elements and strokes, a file of ribbons, and pictures that tell of a drawing.

pub(crate) mod areas;
pub(crate) mod background;
pub(crate) mod curves;
pub(crate) mod cut;
pub(crate) mod document;
pub(crate) mod elements;
pub(crate) mod flat;
pub(crate) mod hosted;
pub(crate) mod kept;
pub(crate) mod pieces;
pub(crate) mod report;
pub(crate) mod result;
pub(crate) mod ribbon;
pub(crate) mod sheet;
pub(crate) mod text;
pub(crate) mod writer;
