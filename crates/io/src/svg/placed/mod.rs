//! A result in SVG whose elements can be changed where they stand: everything else keeps its bytes.
//!
//! `open` finds the elements that [`crate::svg::write_svg`] placed: a `<use>` of a definition, or a group that is drawn in place.
//! `shapes` measures the definitions, `rewrite` puts changes into the text, `paint` paints markup in another way,
//! and `marks` shows what changes.

mod line;
mod marks;
mod open;
mod paint;
mod rewrite;
mod shapes;
#[cfg(test)]
mod tests;

pub use marks::{Mark, with_marks};
pub use open::SvgElements;
pub use paint::check_paint;
