//! The ways to read an SVG file: as exemplar, as shape, as flow strokes, as elements already placed.

use arabesque_core::{Error, FlowStroke, Result, Shape};

use super::{Drawing, Page, Placed, ReadOptions};

/// Reads an exemplar, and the rest of the job where the file holds one.
///
/// # Errors
/// [`arabesque_core::Error::Input`] when the text is no usable SVG or holds no element, [`arabesque_core::Error::Limit`] when it is too large,
/// [`arabesque_core::Error::Unsupported`] when it holds curves and the method is [`super::Method::Auto`].
pub fn read_exemplar(_text: &str, options: &ReadOptions) -> Result<Drawing> {
    Err(not_yet(options))
}

/// Reads the area enclosed by all shapes of the file, or by the one with the given id.
///
/// # Errors
/// As [`read_exemplar`]; also when nothing closed is found, or nothing has that id.
pub fn read_shape(_text: &str, _id: Option<&str>, options: &ReadOptions) -> Result<(Shape, Page)> {
    Err(not_yet(options))
}

/// Reads every path of the file, or of its layer "Flow" where it has one, as a directed stroke in the file's user coordinates.
///
/// # Errors
/// As [`read_exemplar`]; also when no path is found.
pub fn read_flow(_text: &str, options: &ReadOptions) -> Result<Vec<FlowStroke>> {
    Err(not_yet(options))
}

/// Reads elements that stay where they are, and matches them to the elements of `drawing`.
///
/// # Errors
/// As [`read_exemplar`].
pub fn read_placed(_text: &str, _drawing: &Drawing, options: &ReadOptions) -> Result<Placed> {
    Err(not_yet(options))
}

fn not_yet(options: &ReadOptions) -> Error {
    Error::Unsupported { what: format!("{}: reading SVG", options.name), advice: "use a point file".into() }
}
