//! glTF and GLB: points, meshes and their instances in and out, and textured strips with their pictures out.

mod container;
mod placed;
mod read;
mod strips;
#[cfg(test)]
mod tests;
mod write;

pub use container::{as_text, is_glb, is_gltf, recipe_of};
pub use placed::{GlbElements, GltfElements};
pub use read::{read_scene, read_scene_beside};
pub use strips::write_glb;
pub use write::{GltfOptions, write_scene, write_scene_with};

pub use crate::mesh::scene::{Scene, SceneMesh, SceneNode};
