//! Against visible repetition: a penalty on showing a part again soon, and a random preference that differs from piece to piece.
//!
//! The paper names repetition as its limit [Zhou 2013 §4]. Every path remembers the columns that it showed within the window; a
//! position that shows one of them again costs more. The preference is a random cost for each piece and part of the exemplar, so that the
//! pattern does not run through the exemplar from left to right again and again.

use std::sync::Arc;

use arabesque_core::{Budget, Held, Result, Stage, Stream};

use crate::{constraints::valid::Position, exemplar::strip::Strip, geometry::cage::Form, params::RibbonParams};

/// What the random preference is drawn for.
const PREFERENCE: Stage = Stage::new(1);

/// Most pieces that a path remembers.
const MEMORY: usize = 64;

/// Work of one random cost.
const DRAWN: u64 = 10;

/// Cost of one row of pixels that is shown again at full strength, in 8-bit colour steps.
const REPEATED: f64 = 24.0;
/// Largest random cost of one row of pixels, in 8-bit colour steps.
const PREFERRED: f64 = 24.0;

/// Cost of one row of pixels for a piece that lies a whole height of the exemplar off the middle, in 8-bit colour steps.
const OFF_CENTRE: f64 = 640.0;

/// Left edges of the last pieces, latest first; `u16::MAX` before the first piece.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Trail([u16; MEMORY]);

impl Default for Trail {
    fn default() -> Self {
        Self([u16::MAX; MEMORY])
    }
}

impl Trail {
    /// The trail with one piece more.
    pub(crate) fn followed_by(&self, x: u16) -> Self {
        let mut columns = self.0;
        columns.copy_within(..MEMORY - 1, 1);
        columns[0] = x;
        Self(columns)
    }
}

/// The costs that do not come from pixels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reuse {
    /// Length of a piece, in pixels.
    step: f64,
    /// Pieces in the window.
    window: usize,
    /// Cost of a piece that is shown again.
    repeated: f64,
    /// Random costs: for each piece, one for each part of the strip.
    preference: Arc<Vec<f32>>,
    /// Their memory.
    _held: Option<Arc<Held>>,
    parts: usize,
    part: f64,
    /// Cost of a pixel off the middle, and the middle of the strip.
    drift: f64,
    middle: f64,
}

impl Reuse {
    /// For a curve of `pieces` pieces like `form`.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`].
    pub(crate) fn new(
        params: &RibbonParams,
        seed: u64,
        (pieces, form): (usize, &Form),
        strip: &Strip,
        budget: &Budget,
    ) -> Result<Self> {
        let length = strip.longest();
        let step = (form.exit() - form.foot * 0.5).norm().max(1.0);
        let rows = form.rows() as f64;
        let window = ((params.window * length as f64 / step).ceil() as usize).min(MEMORY);
        // Parts as long as four pieces: a preference for one is felt until the next is due.
        let part = 4.0 * step;
        let parts = (strip.width as f64 / part).ceil() as usize + 1;
        let most = (params.variety * PREFERRED * rows) as f32;
        let (mut preference, mut held) = (Vec::new(), None);
        if most > 0.0 {
            let groups = pieces.div_ceil(4) + 1;
            let (list, memory) = budget.list("preferences of pieces", groups * parts)?;
            (preference, held) = (list, Some(Arc::new(memory)));
            for piece in 0..groups {
                budget.spend(DRAWN * parts as u64)?;
                let mut stream = Stream::new(seed, PREFERENCE, piece as u64);
                preference.extend((0..parts).map(|_| most * stream.unit() as f32));
            }
        }
        let drift = params.centring * OFF_CENTRE * rows / strip.height as f64;
        let middle = 0.5 * strip.height as f64;
        let (repeated, preference) = (params.repetition * REPEATED * rows, Arc::new(preference));
        Ok(Self { step, window, repeated, preference, _held: held, parts, part, drift, middle })
    }

    /// What column `x` costs after `trail`.
    pub(crate) fn repetition(&self, trail: &Trail, x: u16) -> f64 {
        if self.repeated == 0.0 {
            return 0.0;
        }
        let shown = trail.0[..self.window].iter().take_while(|&&c| c != u16::MAX);
        let overlap = |&c: &u16| (1.0 - f64::from(c.abs_diff(x)) / self.step).max(0.0);
        self.repeated * shown.map(overlap).sum::<f64>()
    }

    /// What position `p` costs a piece whose left edge reaches down `depth` pixels.
    pub(crate) fn preference(&self, piece: usize, p: Position, depth: f64) -> f64 {
        let drift = self.drift * (f64::from(p.y) + 0.5 * depth - self.middle).abs();
        if self.preference.is_empty() {
            return drift;
        }
        let part = (f64::from(p.x) / self.part) as usize;
        drift + self.preference.get(piece / 4 * self.parts + part).map_or(0.0, |&cost| f64::from(cost))
    }

    /// The same without the penalty on re-use.
    pub(crate) fn without_repetition(&self) -> Self {
        Self { repeated: 0.0, ..self.clone() }
    }
}
