//! What a run gives back.

use serde::Serialize;

use crate::{
    curve::Path,
    region::Outline,
    space::{Matrix, Similarity, Vector},
};

/// One element of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement<const D: usize> {
    /// Index into [`crate::Exemplar::elements`]: which exemplar element is drawn here.
    pub source: usize,
    /// From exemplar coordinates to output coordinates.
    pub transform: Similarity<D>,
    /// Bending of the element, when it was asked for: `control[i].0` in exemplar coordinates goes to `control[i].1` in
    /// output coordinates. Empty for a rigid element.
    pub control: Vec<(Vector<D>, Vector<D>)>,
    /// Index into [`crate::Request::frozen`] when this is an element that the user placed.
    pub frozen: Option<usize>,
}

/// One stroke of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn<const D: usize> {
    /// The line, in output coordinates. On a torus it may reach beyond the box: what lies there is drawn on the other side.
    pub path: Path<D>,
    /// Index into [`crate::Exemplar::curves`]: how the stroke is painted.
    pub source: usize,
    /// Factor by which its width differs from that of its source.
    pub scale: f64,
    /// Index into [`crate::Request::frozen_curves`] when this is a stroke that the user drew.
    pub frozen: Option<usize>,
}

/// One filled area of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct Covered<const D: usize> {
    /// What is filled, in output coordinates, by the even-odd rule. On a torus all that is seen in the box, and a little
    /// around it, so that boxes side by side overlap.
    pub outline: Outline<D>,
    /// Index into [`crate::Exemplar::areas`]: how the area is painted.
    pub source: usize,
    /// From the exemplar to the output: what is applied first, and the shift after it. A paint that is not the same
    /// everywhere goes with it.
    pub paint: (Matrix<D>, Vector<D>),
}

/// A placement as it is drawn: itself, or a copy of it that is seen across an edge of a torus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instance<const D: usize> {
    /// Index into [`Outcome::placements`].
    pub placement: usize,
    /// How many periods of the torus it is moved along each coordinate.
    pub around: [i32; D],
}

/// Mean energy after one step, for the trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyPoint {
    /// Level, 0 = coarsest.
    pub level: usize,
    /// Iteration within the level.
    pub iteration: usize,
    /// Mean neighbourhood energy, in squared mean spacings.
    pub energy: f64,
    /// Number of elements.
    pub elements: usize,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// All planned iterations were done, or nothing changed any more.
    Finished,
    /// Whoever watched the run, or holds its budget, asked to stop.
    Stopped,
    /// A limit was reached; a warning says which one.
    Limit,
}

/// Trouble that does not prevent a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// What was noticed.
    pub message: String,
    /// What to do about it.
    pub advice: String,
}

impl Warning {
    /// A warning from its two parts.
    pub fn new(message: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { message: message.into(), advice: advice.into() }
    }
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Outcome<const D: usize> {
    /// The output elements, frozen ones included, from bottom to top. On a torus each element appears once.
    pub placements: Vec<Placement<D>>,
    /// Elements and their copies on a torus from bottom to top, where those of one element do not follow one another:
    /// rows over rows close up around the seam when a row that is cut by it lies below what is beside it at one edge and
    /// above at the other. Empty where the copies of each element may be drawn with it.
    pub sequence: Vec<Instance<D>>,
    /// The output strokes, frozen ones included.
    pub curves: Vec<Drawn<D>>,
    /// The output areas.
    pub areas: Vec<Covered<D>>,
    /// Mean energy after each iteration.
    pub energy: Vec<EnergyPoint>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why the run ended.
    pub stopped: StopReason,
}
