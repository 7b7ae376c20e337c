//! From the text of a file to a tree of what is drawn: styles computed, `<use>` resolved, structure kept.
//!
//! `guard` checks the raw text, `source` holds the parsed file, `sheet`, `css` and `style` compute properties, `scene` builds
//! the tree. `markup` and `definitions` turn a part of the tree back into markup that stands by itself.

pub(crate) mod colour;
pub(crate) mod css;
pub(crate) mod definitions;
pub(crate) mod geometry;
pub(crate) mod guard;
pub(crate) mod length;
pub(crate) mod marker;
pub(crate) mod markup;
pub(crate) mod meta;
pub(crate) mod notes;
pub(crate) mod paint;
pub(crate) mod scene;
pub(crate) mod sheet;
pub(crate) mod source;
pub(crate) mod style;
