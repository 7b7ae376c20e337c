//! How a running method talks to whoever started it: progress, previews, and whether to go on.

use std::{borrow::Cow, fmt, ops::ControlFlow};

use crate::run::{Covered, Drawn, Patch, Placement};

/// Where a run stands, whatever the method and the dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is being done, in words: `laying out`, `level 2 of 3`.
    pub stage: Cow<'static, str>,
    /// Finished steps of this stage.
    pub done: usize,
    /// Steps that the stage will take; a stage may end earlier.
    pub total: usize,
    /// Share of the whole run that is done, in [0, 1].
    pub fraction: f64,
    /// How far the present state is from what is looked for, in the method's own measure; `None` before it was measured first.
    pub energy: Option<f64>,
    /// How many elements, samples of strokes or pieces there are so far.
    pub count: usize,
}

impl fmt::Display for Progress {
    /// Stage, step, and what is there, for a line of status.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, step {} of {}", self.stage, self.done, self.total)?;
        if self.count != self.done {
            write!(f, ", {} placed", self.count)?;
        }
        self.energy.map_or(Ok(()), |energy| write!(f, ", energy {energy:.4}"))
    }
}

/// What a run will take, as far as it can be told before or soon after it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Elements and samples of strokes, or pieces, that there will be.
    pub count: f64,
    /// Work, in units of about a nanosecond; see [`crate::Budget`].
    pub work: f64,
    /// Work that the limits allow, in the same units.
    pub allowed: f64,
}

/// The geometry of a run at one moment, as it would be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<const D: usize> {
    /// Elements.
    pub placements: Vec<Placement<D>>,
    /// Strokes.
    pub curves: Vec<Drawn<D>>,
    /// Filled areas.
    pub areas: Vec<Covered<D>>,
    /// Pieces of pictures.
    pub patches: Vec<Patch<D>>,
}

impl<const D: usize> Default for Snapshot<D> {
    fn default() -> Self {
        Self { placements: Vec::new(), curves: Vec::new(), areas: Vec::new(), patches: Vec::new() }
    }
}

/// Receives progress and decides whether the run goes on.
///
/// `P` is what a preview is to the caller: an engine offers its [`Snapshot`]; who stands above it may offer more. An observer that
/// looks at no previews implements `Watch<P>` for every `P` and serves all methods in all dimensions.
pub trait Watch<P> {
    /// Called once, before the work or soon after it begins.
    fn foreseen(&mut self, _: &Forecast) {}

    /// Called after each step. `preview` builds the present state; building it costs time, so call it only to show it.
    /// [`ControlFlow::Break`] ends the run early, with the best so far as its outcome.
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> P) -> ControlFlow<()>;
}

/// Watches nothing and never stops the run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl<P> Watch<P> for Unobserved {
    fn step(&mut self, _: &Progress, _: &dyn Fn() -> P) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_reads_as_a_line_of_status() {
        let progress = Progress {
            stage: "level 2 of 3".into(),
            done: 4,
            total: 7,
            fraction: 0.5,
            energy: Some(0.125),
            count: 300,
        };
        assert_eq!(progress.to_string(), "level 2 of 3, step 4 of 7, 300 placed, energy 0.1250");
        let pieces = Progress { stage: "laying pieces".into(), energy: None, count: 4, ..progress };
        assert_eq!(pieces.to_string(), "laying pieces, step 4 of 7");
    }
}
