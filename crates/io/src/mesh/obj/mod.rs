//! OBJ: networks of curves as polylines, in and out, and ribbons as textured strips.

pub mod polylines;
pub mod strips;

pub use polylines::{Net, Sheet, junctions, read_curves, read_lines, recipe_of, write_curves};
