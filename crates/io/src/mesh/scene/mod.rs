//! Scenes: meshes in their places and how they look, whatever kind of file they come from or go to.
//!
//! A [`Scene`] holds every mesh once and a node for each place of it. What files say beyond that, it carries along for those who write
//! it again: materials, textures and pictures ([`Looks`]), the classes of elements ([`Scene::classes`]), the box of the pattern.

mod assembly;
mod classes;
mod congruent;
mod convention;
mod look;
mod model;
mod rotation;
mod split;
mod whole;

pub(super) use assembly::{Branch, Tree};
pub use classes::{Classes, stem};
pub use convention::{Convention, Up};
pub use look::{Alpha, Attributes, Looks, Material, Picture, Primitive, SLOTS, Sampler, Slot, Texture, TextureUse};
pub use model::{Scene, SceneMesh, SceneNode};
pub use rotation::{matrix_of, quaternion};
