//! Things in space: curves and textured strips, as OBJ and GLB.

pub mod gltf;
pub mod obj;
pub mod strip;
