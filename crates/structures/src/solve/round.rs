//! One round: match, move, turn attributes, add and remove.

use arabesque_core::{Budget, Result, Vector};

use super::{
    attributes::attributes,
    matching::{Round, matching},
    merging::merge,
    sampling::control,
};
use crate::{
    energy::{
        level::{Level, Matches},
        links::Lists,
    },
    output::state::Output,
};

/// Points that move less than this in the mean, in spacings, have settled.
const SETTLED: f64 = 1e-3;
/// A point that moved farther than this in a round, in spacings, stirs the sites around it.
const STIRS: f64 = 0.02;

/// A round that lowers `T` by less than this share of what the exemplar weighs with itself, and changes the number of points by less than this
/// share of them, is the last one.
const GAIN: f64 = 2e-3;

/// What a round came to.
pub(crate) struct Turn<const D: usize> {
    /// `T` before, and after the points have moved.
    pub(crate) energy: (f64, f64),
    /// Where points have come, gone or moved noticeably.
    pub(crate) stirred: Vec<Vector<D>>,
    /// Whether another one would change little.
    pub(crate) settled: bool,
    /// Sites whose matches changed noticeably.
    pub(crate) rematched: Vec<usize>,
}

/// Takes one round with at most so many steps of moving. Sites know of those `around` them.
pub(crate) fn round<const D: usize>(
    level: &Level<'_, D>,
    around: &Lists,
    (output, matches): (&mut Output<D>, &mut Matches<D>),
    (draw, steps): (Round, usize),
    budget: &Budget,
) -> Result<Turn<D>> {
    let stirs = STIRS * level.pattern.spacing;
    let near = level.near(output, budget)?;
    let matched = matching(level, output, &near, matches, around, (draw, budget))?;
    debug_assert!(matched.energy.1 <= matched.energy.0 + 1e-9 * matched.energy.0.abs());
    let far = |q: &usize| (matched.matches.places[*q] - matches.places[*q]).norm() > stirs;
    let rematched = (0..level.open).filter(far).collect();
    *matches = matched.matches;
    let mut pulls = level.pulls(output, &near, matches, budget)?;
    let before = level.energy(output, &near, &pulls, matches, budget)?;
    let start = output.places.clone();
    let mut energy = before;
    for _ in 0..steps {
        let moved = merge(level, output, &near, matches, (&mut pulls, energy), budget)?;
        energy = moved.energy;
        if moved.distance < SETTLED * level.pattern.spacing {
            break;
        }
    }
    attributes(level, output, &near, matches, (&mut pulls, budget))?;
    let moved = start.iter().zip(&output.places).zip(&pulls).filter(|((a, b), p)| (**a - **b).norm() > stirs * p.scale);
    let mut stirred: Vec<_> = moved.map(|((_, b), _)| *b).collect();
    let near = level.near(output, budget)?;
    let pulls = level.pulls(output, &near, matches, budget)?;
    let changed = control(level, output, &near, matches, &pulls, budget)?;
    let altered = (changed.added.len() + changed.removed.len()) as f64 > GAIN * output.places.len() as f64;
    stirred.extend(changed.added);
    stirred.extend(changed.removed);
    let energy = (before + matched.energy.0 - matched.energy.1, energy);
    let settled = energy.0 - energy.1 < GAIN * matches.back && !altered;
    Ok(Turn { energy, stirred, settled, rematched })
}
