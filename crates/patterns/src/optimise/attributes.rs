//! Attribute assignment: which exemplar element is drawn, by selection and never by blending [Ma 2011 eq. 5].

use arabesque_core::Numbered;

use rayon::prelude::*;

use crate::output::state::State;

/// A source is only exchanged for one that suits the votes better by this factor: variation that fits stays.
const RELUCTANCE: f32 = 0.7;

/// Gives every living item the source with the smallest sum of attribute distances to all votes. Returns how many
/// changed.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>) -> usize {
    let votes = votes(state);
    let better = |(i, votes): (usize, &Vec<u32>)| better_source(state, i, votes).map(|source| (i as u32, source));
    let changes: Vec<_> = votes.par_iter().enumerate().filter_map(better).collect();
    changes.iter().for_each(|&(i, source)| state.set_source(i, source));
    changes.len()
}

/// The source that suits the votes for item `i` clearly better than its present one.
fn better_source<const D: usize>(state: &State<'_, D>, i: usize, votes: &[u32]) -> Option<u32> {
    let (live, library) = (&state.items()[i], state.library);
    if !live.alive || live.item.frozen.is_some() {
        return None;
    }
    let spread = |source: u32| -> f32 {
        let feature = &library.feature[source];
        votes.iter().map(|&v| feature.distance2(&library.feature[v])).sum()
    };
    let present = spread(live.item.source);
    let best = votes.iter().filter(|&&v| library.copyable[v]).map(|&v| (spread(v), v));
    let (cost, source) = best.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
    (cost < RELUCTANCE * present).then_some(source)
}

/// For every item, the exemplar elements that its samples were matched with.
fn votes<const D: usize>(state: &State<'_, D>) -> Numbered<Vec<u32>> {
    let mut votes = Numbered::filled(Vec::new(), state.items().len());
    for &s in state.living() {
        let Some(matched) = &state.sample(s).matched else { continue };
        votes[state.sample(s).item].push(state.level.element[matched.input]);
        for &(o, i) in &matched.pairs {
            votes[state.sample(o).item].push(state.level.element[i]);
        }
    }
    votes
}
