//! Position assignment: where the matched neighbourhoods say that samples should be [Ma 2011 eqs 3, 4; Tu 2020 eqs 14,
//! 15].

use arabesque_core::{NormalEquations, Numbered, Prediction, Pull, Result, Vector};
use rayon::prelude::*;

use crate::{exemplar::level::fall_off, output::state::State};

/// Share of a sample's predictions' weight with which it is held where it is: predictions fix relative positions only.
const PIN: f64 = 0.05;

/// Weight of the pull back into the domain, relative to the predictions of a sample.
const DOMAIN: f64 = 1.0;

/// How strongly a poor match is discounted.
const DISCOUNT: f64 = 8.0;

/// Nanoseconds for a prediction until the equations are set up, and for the pull of a sample.
const PRICE: (u64, u64) = (30, 100);

/// Solves for all living samples and returns new positions for every sample; the dead keep theirs.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn assign<const D: usize>(state: &State<'_, D>) -> Result<Numbered<Vector<D>>> {
    let budget = state.budget.stage("placing elements");
    let mut slot_of = Numbered::filled(None, state.samples().len());
    for (slot, &s) in state.living().iter().enumerate() {
        slot_of[s] = Some(slot as u32);
    }
    let predictions = predictions(state, &slot_of);
    let count: usize = predictions.iter().map(Vec::len).sum();
    budget.spend(PRICE.0 * count as u64 + PRICE.1 * state.living().len() as u64)?;
    let pull = |slot: usize, weight: f64| pull(state, state.living()[slot], weight);
    let fixed = state.living().iter().map(|&s| state.is_frozen(s)).collect();
    let moves = NormalEquations::of_groups(&predictions, pull, fixed).solve(1e-3, 200, &budget)?;
    let mut position: Numbered<_> = state.samples().iter().map(|s| s.position).collect();
    for (&s, &step) in state.living().iter().zip(&moves) {
        position[s] += step;
    }
    Ok(position)
}

/// Predictions of each living sample, as differences from the present offsets, since the unknowns are displacements.
fn predictions<const D: usize>(state: &State<'_, D>, slot_of: &Numbered<Option<u32>>) -> Vec<Vec<Prediction<D>>> {
    state.living().par_iter().map(|&s| predictions_of(state, slot_of, s)).collect()
}

/// What the match of sample `s` says about its neighbours.
fn predictions_of<const D: usize>(state: &State<'_, D>, slot_of: &Numbered<Option<u32>>, s: u32) -> Vec<Prediction<D>> {
    let sample = state.sample(s);
    let Some(matched) = &sample.matched else { return Vec::new() };
    let frame = state.request.fields.frame(sample.position);
    let trust = 1.0 / (1.0 + DISCOUNT * matched.energy());
    let origin = state.level.position[matched.input];
    let Some(from) = slot_of[s] else { return Vec::new() };
    let one = |&(o, i): &(u32, u32)| {
        let offset = state.level.position[i] - origin;
        let present = state.domain().offset(sample.position, state.sample(o).position);
        Some(Prediction {
            from,
            to: slot_of[o]?,
            offset: frame.to_output(offset) - present,
            // Rounded as in the search, so that both weigh alike.
            weight: trust * f64::from(fall_off(offset, state.level.radius) as f32),
        })
    };
    matched.pairs.iter().filter_map(one).collect()
}

/// The pin of a sample and, outside the domain, the pull back.
fn pull<const D: usize>(state: &State<'_, D>, s: u32, weight: f64) -> Pull<D> {
    let pin = PIN * weight + 1e-6;
    let position = state.sample(s).position;
    let item = &state.item_of(s).item;
    let back = state.extent.way_back(item.source, position);
    if back == Vector::ZERO {
        return Pull { target: Vector::ZERO, weight: pin };
    }
    let domain = DOMAIN * weight + 1e-6;
    Pull { target: back * (domain / (pin + domain)), weight: pin + domain }
}
