//! How a running method talks to whoever started it: progress, previews, and whether to go on.

use std::ops::ControlFlow;

use crate::run::{Drawn, Patch, Placement};

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Level of the hierarchy, 0 = coarsest.
    pub level: usize,
    /// Number of levels.
    pub levels: usize,
    /// Finished iterations of this level.
    pub iteration: usize,
    /// Iterations planned for this level.
    pub iterations: usize,
    /// Share of the whole run that is done, in [0, 1].
    pub fraction: f64,
    /// Mean neighbourhood energy of the present state, in squared mean spacings; `None` before the first search of a level.
    pub energy: Option<f64>,
    /// Number of elements in the present state.
    pub elements: usize,
}

/// The present state of a run, as it would be drawn.
#[derive(Clone, Debug)]
pub struct Preview<const D: usize> {
    /// Elements.
    pub placements: Vec<Placement<D>>,
    /// Strokes.
    pub curves: Vec<Drawn<D>>,
    /// Pieces of pictures.
    pub patches: Vec<Patch<D>>,
}

impl<const D: usize> Default for Preview<D> {
    fn default() -> Self {
        Self { placements: Vec::new(), curves: Vec::new(), patches: Vec::new() }
    }
}

/// Receives progress and decides whether the run goes on.
pub trait Observer<const D: usize> {
    /// Called after each step. `preview` builds the present state; building it costs time, so call it only to show it.
    /// [`ControlFlow::Break`] ends the run early, with the best so far as its outcome.
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> Preview<D>) -> ControlFlow<()>;
}

/// An observer that watches nothing and never stops the run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl<const D: usize> Observer<D> for Unobserved {
    fn step(&mut self, _: &Progress, _: &dyn Fn() -> Preview<D>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
