//! What a run is asked, and what it gives back.

use std::sync::Arc;

use arabesque_core::{Budget, PointSet, StopReason, Warning};
use arabesque_surface::{DirectionField, MeshIndex};

/// Where a relief goes.
#[derive(Clone, Debug)]
pub enum Ground {
    /// A part of the plane, so wide and so deep, from the origin on.
    Plane([f64; 2]),
    /// A tile of the plane that repeats without a seam.
    Tile([f64; 2]),
    /// The shell of a mesh: the plane of the texture lies on it, runs along the directions, and is so many times as large.
    Mesh(Arc<MeshIndex>, Arc<DirectionField>, f64),
    /// The gap in the texture itself.
    Hole,
}

/// What to make of a prepared texture.
#[derive(Clone, Debug)]
pub struct ReliefRequest {
    /// Where.
    pub ground: Ground,
    /// Seed of all random choices.
    pub seed: u64,
    /// What the run may use up.
    pub budget: Budget,
}

impl ReliefRequest {
    /// A request with seed 0.
    pub fn new(ground: Ground) -> Self {
        Self { ground, seed: 0, budget: Budget::default() }
    }
}

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Patches that were laid.
    pub patches: usize,
    /// Times that a patch would have folded and was bent again with fewer pairs.
    pub folds: usize,
    /// Patches that did not fit well and were passed over for the next best.
    pub passed: usize,
    /// Patches that were laid without being bent, because no pairs could be made.
    pub unbent: usize,
    /// Points in overlaps.
    pub overlapped: usize,
    /// Points that were blended along their normals.
    pub by_ray: usize,
    /// Points that were blended by projection, because no ray met the surface.
    pub by_projection: usize,
    /// Points beside what is there already that nothing leads to.
    pub seams: usize,
    /// Points that were there already from which nothing goes on.
    pub cracks: usize,
    /// Points along seams that lay too close to another and were left out.
    pub merged: usize,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct ReliefOutcome {
    /// The points, with normals, and with the colours, radii and groups that the texture has.
    pub points: PointSet<3>,
    /// For each point the one of the texture that it stands for.
    pub sources: Vec<usize>,
    /// What was counted.
    pub statistics: Statistics,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why the run ended.
    pub stopped: StopReason,
}
