//! Things in space: curves, points, meshes, scenes and textured strips, in and out.

mod colour;
pub mod gltf;
pub mod obj;
pub mod ply;
pub mod scene;
pub mod stl;
pub mod strip;
pub mod usd;
