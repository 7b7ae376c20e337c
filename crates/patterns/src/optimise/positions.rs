//! Position assignment: where the matched neighbourhoods say that samples should be [Ma 2011 eqs 3, 4; Tu 2020 eqs 14, 15].

use arabesque_core::{NormalEquations, Prediction, Pull, Vector};
use rayon::prelude::*;

use crate::{exemplar::level::fall_off, output::state::State};

/// Share of a sample's predictions' weight with which it is held where it is: predictions fix relative positions only.
const PIN: f64 = 0.05;

/// Weight of the pull back into the domain, relative to the predictions of a sample.
const DOMAIN: f64 = 1.0;

/// How strongly a poor match is discounted.
const DISCOUNT: f64 = 8.0;

/// Solves for all living samples and returns new positions for every sample; the dead keep theirs.
pub(crate) fn assign<const D: usize>(state: &State<'_, D>) -> Vec<Vector<D>> {
    let mut slot_of = vec![u32::MAX; state.samples.len()];
    for (slot, &s) in state.living.iter().enumerate() {
        slot_of[s as usize] = slot as u32;
    }
    let predictions = predictions(state, &slot_of);
    let mut weight = vec![0.0; state.living.len()];
    for p in &predictions {
        weight[p.from as usize] += p.weight;
        weight[p.to as usize] += p.weight;
    }
    let pulls: Vec<_> = state.living.iter().zip(&weight).map(|(&s, &w)| pull(state, s, w)).collect();
    let fixed = state.living.iter().map(|&s| is_frozen(state, s)).collect();
    let moves = NormalEquations::new(&predictions, &pulls, fixed).solve(1e-3, 200);
    let mut position: Vec<_> = state.samples.iter().map(|s| s.position).collect();
    for (&s, &step) in state.living.iter().zip(&moves) {
        position[s as usize] += step;
    }
    position
}

fn is_frozen<const D: usize>(state: &State<'_, D>, s: u32) -> bool {
    state.items[state.samples[s as usize].item as usize].item.frozen.is_some()
}

/// Predictions as differences from the present offsets, since the unknowns are displacements.
fn predictions<const D: usize>(state: &State<'_, D>, slot_of: &[u32]) -> Vec<Prediction<D>> {
    state.living.par_iter().flat_map_iter(|&s| predictions_of(state, slot_of, s)).collect()
}

/// What the match of sample `s` says about its neighbours.
fn predictions_of<const D: usize>(state: &State<'_, D>, slot_of: &[u32], s: u32) -> Vec<Prediction<D>> {
    let sample = &state.samples[s as usize];
    let Some(matched) = &sample.matched else { return Vec::new() };
    let frame = state.request.fields.frame(sample.position);
    let trust = 1.0 / (1.0 + DISCOUNT * matched.energy());
    let origin = state.level.position[matched.input as usize];
    let living = matched.pairs.iter().filter(|(o, _)| slot_of[*o as usize] != u32::MAX);
    let one = |&(o, i): &(u32, u32)| {
        let offset = state.level.position[i as usize] - origin;
        let present = state.domain().offset(sample.position, state.samples[o as usize].position);
        Prediction {
            from: slot_of[s as usize],
            to: slot_of[o as usize],
            offset: frame.to_output(offset) - present,
            weight: trust * f64::from(fall_off(offset, state.level.radius) as f32),
        }
    };
    living.map(one).collect()
}

/// The pin of a sample and, outside the domain, the pull back.
fn pull<const D: usize>(state: &State<'_, D>, s: u32, weight: f64) -> Pull<D> {
    let pin = PIN * weight + 1e-6;
    let position = state.samples[s as usize].position;
    let item = &state.items[state.samples[s as usize].item as usize].item;
    let back = state.extent.way_back(item.source, position);
    if back == Vector::ZERO {
        return Pull { target: Vector::ZERO, weight: pin };
    }
    let domain = DOMAIN * weight + 1e-6;
    Pull { target: back * (domain / (pin + domain)), weight: pin + domain }
}
