//! What is asked of a run.

use arabesque_core::{Budget, Path};

use crate::constraints::mask::Mask;

/// Curves to lay a pattern along, and what to mind.
#[derive(Clone, Debug)]
pub struct RibbonRequest<const D: usize> {
    /// The curves, in user units, with the names that messages call them by.
    pub curves: Vec<(String, Path<D>)>,
    /// Where no ink may fall. Without effect in space.
    pub avoid: Option<Mask>,
    /// Position of the first piece of every curve: the pixel of the exemplar in which its top left corner lies; the row may lie above the
    /// picture.
    pub first: Option<(usize, i64)>,
    /// With several exemplars: the shares of the length, rising, at which the pattern passes into the next one. Empty: equal parts.
    pub changes: Vec<f64>,
    /// Seed of the random preference.
    pub seed: u64,
    /// What the run may use up.
    pub budget: Budget,
}

impl<const D: usize> RibbonRequest<D> {
    /// Lays the pattern along `curves` with everything else at its default.
    pub fn new(curves: Vec<(String, Path<D>)>) -> Self {
        Self { curves, avoid: None, first: None, changes: Vec::new(), seed: 0, budget: Budget::default() }
    }
}
