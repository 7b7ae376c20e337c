//! OBJ: networks of curves as polylines, in and out, and ribbons as textured strips.

mod lexer;
pub mod polylines;
pub mod strips;
pub mod triangles;
pub mod write;

pub use polylines::{Net, junctions, read_curves, read_lines};
pub use triangles::read_mesh;
pub use write::{Sheet, recipe_of, write_curves};
