//! What a run is asked, and what it gives back.

use std::sync::Arc;

use arabesque_core::{Budget, EnergyPoint, PointSet, Similarity, StopReason, Warning};

use crate::territory::plan::Territory;

/// What to make from a prepared exemplar.
#[derive(Clone, Debug)]
pub struct StructureRequest<const D: usize> {
    /// Where, and how the pattern is turned and scaled there.
    pub territory: Arc<dyn Territory<D>>,
    /// Points that stay exactly as they are; the rest is fitted around them. Attributes that the exemplar lacks are not used.
    pub kept: PointSet<D>,
    /// Seed of all random choices.
    pub seed: u64,
    /// What the run may use up.
    pub budget: Budget,
}

impl<const D: usize> StructureRequest<D> {
    /// Fills `territory` with everything else at its default.
    pub fn new(territory: Arc<dyn Territory<D>>) -> Self {
        Self { territory, kept: PointSet::default(), seed: 0, budget: Budget::default() }
    }
}

/// A rigid element of the result.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedElement<const D: usize> {
    /// Its number in the exemplar.
    pub element: i32,
    /// From the exemplar to the result.
    pub pose: Similarity<D>,
    /// Its points: so many from this one on.
    pub points: std::ops::Range<usize>,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct StructureOutcome<const D: usize> {
    /// The points, the kept ones first, with the attributes that the exemplar has. Parts and elements have numbers of their own.
    pub points: PointSet<D>,
    /// For each point the point of the exemplar that it stands for; `None` for kept ones.
    pub sources: Vec<Option<usize>>,
    /// The rigid elements, by the number that their points have in the result.
    pub elements: Vec<PlacedElement<D>>,
    /// `T` after each step, per site.
    pub energy: Vec<EnergyPoint>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why the run ended.
    pub stopped: StopReason,
}
