//! Things in space: curves, points, meshes and textured strips, in and out.

pub mod gltf;
pub mod obj;
pub mod ply;
pub mod stl;
pub mod strip;
