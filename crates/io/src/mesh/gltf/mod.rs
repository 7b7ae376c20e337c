//! GLB: points, meshes and their instances in and out, and textured strips with their pictures out.

mod accessor;
mod buffer;
mod colour;
mod container;
mod document;
mod nodes;
mod points;
mod primitives;
mod read;
mod scene;
mod strips;
#[cfg(test)]
mod tests;
mod write;

pub use container::{is_glb, recipe_of};
pub use read::read_scene;
pub use scene::{Scene, SceneMesh, SceneNode};
pub use strips::write_glb;
pub use write::write_scene;
