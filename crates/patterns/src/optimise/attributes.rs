//! Attribute assignment: which exemplar element is drawn, by selection and never by blending [Ma 2011 eq. 5].

use arabesque_core::{Meter, Numbered, Result};

use rayon::prelude::*;

use crate::output::state::State;

/// A source is only exchanged for one that suits the votes better by this factor: variation that fits stays.
const RELUCTANCE: f32 = 0.7;

/// Nanoseconds to compare the attributes of two elements, and to count a vote.
const PRICE: (u64, u64) = (6, 3);

/// Gives every living item the source with the smallest sum of attribute distances to all votes. Returns how many
/// changed.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the state stays as it is.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>) -> Result<usize> {
    let budget = state.budget.stage("choosing elements");
    let votes = votes(state, &mut budget.meter())?;
    let better = |(i, votes): (usize, &Vec<u32>)| {
        let source = better_source(state, i, votes, &mut budget.meter())?;
        Ok(source.map(|source| (i as u32, source)))
    };
    let changes: Vec<Option<(u32, u32)>> = votes.par_iter().enumerate().map(better).collect::<Result<_>>()?;
    budget.spend(0)?;
    let changes: Vec<_> = changes.into_iter().flatten().collect();
    changes.iter().for_each(|&(i, source)| state.set_source(i, source));
    Ok(changes.len())
}

/// The source that suits the votes for item `i` clearly better than its present one.
fn better_source<const D: usize>(
    state: &State<'_, D>,
    i: usize,
    votes: &[u32],
    meter: &mut Meter<'_>,
) -> Result<Option<u32>> {
    let (live, library) = (&state.items()[i], state.library);
    if !live.alive || live.item.frozen.is_some() {
        return Ok(None);
    }
    let spread = |source: u32| -> f32 { votes.iter().map(|&v| library.differences.of(source, v)).sum() };
    let present = spread(live.item.source);
    if present <= 0.0 {
        return Ok(None);
    }
    // Many vote for the same few.
    let mut asked: Vec<u32> = votes.iter().copied().filter(|&v| library.copyable[v]).collect();
    asked.sort_unstable();
    asked.dedup();
    let mut best: Option<(f32, u32)> = None;
    for v in asked {
        meter.spend(PRICE.0 * votes.len() as u64)?;
        let cost = spread(v);
        if best.is_none_or(|(least, _)| cost.total_cmp(&least).is_lt()) {
            best = Some((cost, v));
        }
    }
    Ok(best.filter(|(cost, _)| *cost < RELUCTANCE * present).map(|b| b.1))
}

/// For every item, the exemplar elements that its samples were matched with.
fn votes<const D: usize>(state: &State<'_, D>, meter: &mut Meter<'_>) -> Result<Numbered<Vec<u32>>> {
    let mut votes = Numbered::filled(Vec::new(), state.items().len());
    for &s in state.living() {
        let Some(matched) = &state.sample(s).matched else { continue };
        meter.spend(PRICE.1 * (1 + matched.pairs.len() as u64))?;
        votes[state.sample(s).item].push(state.level.element[matched.input]);
        for &(o, i) in &matched.pairs {
            votes[state.sample(o).item].push(state.level.element[i]);
        }
    }
    Ok(votes)
}
