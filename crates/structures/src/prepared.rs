//! An exemplar that is understood once and continued as often as wanted.

use std::sync::Arc;

use arabesque_core::{Budget, Error, PointSet, Result, Warning};

use crate::{
    energy::{kernel::Kernel, level::Fields},
    exemplar::{
        pattern::Pattern,
        repetition::{Repetition, repetition},
    },
    params::StructureParams,
    territory::plan::SitePlan,
};

/// Share of what repeats that the window is by itself.
const WINDOW: f64 = 0.7;
/// Window for what does not repeat, in spacings.
const IRREGULAR: f64 = 4.5;
/// Distances that vary less than by the first count as even, more than by the second as random.
const EVEN: (f64, f64) = (0.0, 0.07);
/// Width of the Gaussians for even points, in spacings.
const NARROW: f64 = 0.35;
/// Gaussians are narrower than that where normals beside one another face other ways, down to the last of these shares: those of the two sides of
/// what is thin would cancel out.
const THINNER: [f64; 6] = [1.0, 0.85, 0.72, 0.6, 0.52, 0.45];
/// How alike normals under one Gaussian are at least, in the mean.
const ALIKE: f64 = 0.8;
/// From this strength on an exemplar repeats regularly.
const REGULAR: f64 = 0.5;
/// Smallest window, in spacings.
const SMALLEST: f64 = 3.0;
/// Largest share of the exemplar's length that the window is by itself.
const LARGEST: f64 = 0.22;
/// Largest share that it may be.
const MOST: f64 = 0.5;
/// Windows at most from one site to the next, when they are smallest.
const STEP: f64 = 1.0;

/// Windows that sites lie beyond the border.
const MARGIN: f64 = 0.6;

/// Width of the Gaussians, in spacings, for points whose distances vary by this share of themselves. Gaussians as wide as the spacing do not
/// tell where each point of a lattice is.
fn width(variation: f64) -> f64 {
    let uneven = ((variation - EVEN.0) / (EVEN.1 - EVEN.0)).clamp(0.0, 1.0);
    NARROW + (1.0 - NARROW) * uneven
}

/// The widest Gaussians up to `width`, in spacings, under which normals are alike.
fn thinned<const D: usize>(pattern: &Pattern<D>, width: f64, budget: &Budget) -> Result<f64> {
    let mut meter = budget.meter();
    for share in THINNER {
        let sigma = width * share;
        if sigma <= THINNER[THINNER.len() - 1] {
            break;
        }
        if pattern.alike(sigma * pattern.spacing, &mut meter)? >= ALIKE {
            return Ok(sigma);
        }
    }
    Ok(width.min(THINNER[THINNER.len() - 1]))
}

/// A prepared exemplar.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    pub(crate) pattern: Arc<Pattern<D>>,
    pub(crate) params: StructureParams,
    /// The window at first, in the units of the exemplar.
    pub(crate) window: f64,
    /// Width of the Gaussians at first, in the units of the exemplar.
    pub(crate) sigma: f64,
    pub(crate) repetition: Repetition<D>,
    pub(crate) fields: Arc<Fields<D>>,
    pub(crate) warnings: Vec<Warning>,
}

impl<const D: usize> Prepared<D> {
    /// Understands an exemplar: how densely its points lie, along which directions it repeats and how far.
    ///
    /// # Errors
    /// When there are too few points or some are no numbers, when a parameter is out of range, or when the budget is used up.
    pub fn new(points: Arc<PointSet<D>>, params: &StructureParams, budget: &Budget) -> Result<Self> {
        params.check()?;
        let budget = budget.stage("preparing the exemplar");
        let mut warnings = Vec::new();
        let pattern = Pattern::new(points, params, &budget, &mut warnings)?;
        let sigma = match params.sigma {
            Some(sigma) => sigma,
            // In a volume pieces of the exemplar hardly fit each other, and Gaussians must reach from what ends here to what goes on beside it.
            None if pattern.repeats() > 2 => width(pattern.variation),
            None => thinned(&pattern, width(pattern.variation), &budget)?,
        } * pattern.spacing;
        let shortest = pattern.sides().fold(f64::INFINITY, f64::min);
        let kernel = Kernel::new(sigma, 1e3 * shortest.max(sigma), pattern.base, params.shape);
        let fields = Arc::new(Fields::default());
        let field = fields.of(&pattern, &kernel, &budget)?;
        let step = if pattern.repeats() > 2 { sigma } else { 0.6 * sigma };
        let repetition = repetition(&pattern, &field, step.max(shortest / 150.0), &budget)?;
        // What hardly repeats has neighbours alone to go by.
        let regular = ((repetition.strength - 0.1) / 0.4).clamp(0.0, 1.0);
        let repeats = WINDOW * repetition.length.unwrap_or(2.0 * LARGEST * shortest);
        let found = regular * repeats + (1.0 - regular) * IRREGULAR * pattern.spacing;
        let window = params.window.map_or_else(
            || found.min(LARGEST * shortest).max(SMALLEST * pattern.spacing),
            |window| window * pattern.spacing,
        );
        if window > MOST * shortest && params.window.is_none() {
            let long = shortest / pattern.spacing;
            let least = SMALLEST / MOST;
            return Err(Error::input(
                "the exemplar",
                format!(
                    "it is {long:.1} spacings of its points long where it is shortest, and a structure shows from {least} on"
                ),
                format!("give more of the structure, or set a window of at most {:.1} spacings", MOST * long),
            ));
        }
        if window > MOST * shortest {
            let least = shortest * MOST / pattern.spacing;
            return Err(Error::parameter(
                "window",
                format!("{:.1}", window / pattern.spacing),
                format!(
                    "at most {least:.1} spacings, half the length of the exemplar, or an exemplar that shows more of the structure"
                ),
            ));
        }
        Ok(Self { pattern: Arc::new(pattern), params: params.clone(), window, sigma, repetition, fields, warnings })
    }

    /// Mean distance of a point of the exemplar from the nearest.
    pub fn spacing(&self) -> f64 {
        self.pattern.spacing
    }

    /// Size of the window at first, in the units of the exemplar.
    pub fn window(&self) -> f64 {
        self.window
    }

    /// How far the exemplar is from where it looks like itself again, where that was looked for and found.
    pub fn repetition(&self) -> Option<f64> {
        self.repetition.length
    }

    /// How well the exemplar looks like itself again there: 0 to 1.
    pub fn regularity(&self) -> f64 {
        self.repetition.strength
    }

    /// Along how many directions the exemplar repeats: 1 for ropes, 2 for surfaces, 3 for volumes.
    pub fn repeats(&self) -> usize {
        self.pattern.repeats()
    }

    /// What territories are asked for, for windows of this size.
    pub(crate) fn plan_for(&self, window: f64) -> SitePlan<D> {
        SitePlan {
            step: STEP * 0.5 * window,
            margin: MARGIN * window,
            base: self.pattern.base,
            axis: self.pattern.axis,
            thickness: self.pattern.thickness,
            repetition: self.repetition.length.filter(|_| self.repetition.strength > REGULAR),
        }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream, Vector};

    use super::*;

    /// Three thin walls above each other, of points that lie unevenly on both sides and face outwards.
    fn walls() -> PointSet<3> {
        let mut stream = Stream::new(1, Stage::TEST, 0);
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for n in 0..3 * 2 * 100 {
            let (wall, side, x, y) = (n / 200, n / 100 % 2, n / 10 % 10, n % 10);
            let mut at = |k: usize| k as f64 + stream.range(-0.3, 0.3);
            positions.push(Vector([at(x), at(y), 4.0 * wall as f64 + 0.4 * side as f64]));
            normals.push(Vector([0.0, 0.0, if side == 0 { -1.0 } else { 1.0 }]));
        }
        PointSet { normals: Some(normals), ..PointSet::at(positions) }
    }

    #[test]
    fn gaussians_are_narrow_on_thin_sheets_and_wide_in_volumes() {
        let sigma = |repeats: usize| {
            let params = StructureParams { repeats: Some(repeats), window: Some(4.0), ..StructureParams::default() };
            let prepared = Prepared::new(Arc::new(walls()), &params, &Budget::default()).unwrap();
            prepared.sigma / prepared.spacing()
        };
        assert!(sigma(2) < 0.65, "{}", sigma(2));
        assert!(sigma(3) > 0.95, "{}", sigma(3));
    }
}
