//! OBJ: networks of curves as polylines, points and meshes, in and out, and ribbons as textured strips out.

mod lexer;
mod mtl;
pub mod polylines;
mod scene_in;
mod scene_out;
pub mod solid;
pub mod strips;
pub mod triangles;
pub mod write;

pub use mtl::MATERIALS_TITLE;
pub use polylines::{Net, junctions, read_curves, read_lines};
pub use scene_in::read_scene;
pub use scene_out::{ObjScene, SCENE_TITLE, write_scene};
pub use solid::{write_cloud, write_mesh};
pub use triangles::read_mesh;
pub use write::{Sheet, recipe_of, write_curves};
