//! Elements, and what is around them.

use std::sync::Arc;

use arabesque_core::{Similarity, Vector};

use crate::{params::PhysicsParams, shape::Shape, surroundings::Surroundings};

/// One element.
#[derive(Clone, Debug)]
pub struct Body {
    /// What it looks like.
    pub shape: Arc<Shape>,
    /// From coordinates of its mesh to the scene.
    pub pose: Similarity<3>,
    /// It stays where it is to the last bit.
    pub frozen: bool,
    /// Where it falls to, where that is not the same everywhere: as [`crate::World::new`] has it.
    pub gravity: Option<Vector<3>>,
}

/// All that a run begins from.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    pub(crate) bodies: Vec<Body>,
    pub(crate) surroundings: Surroundings,
    pub(crate) gravity: Vector<3>,
    pub(crate) params: PhysicsParams,
}
