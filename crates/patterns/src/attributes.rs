//! Attribute assignment: which exemplar element is drawn, by selection and never by blending [Ma 2011 eq. 5].

use crate::state::State;

/// A source is only exchanged for one that suits the votes better by this factor: variation that fits stays.
const RELUCTANCE: f32 = 0.7;

/// Gives every living item the source with the smallest sum of attribute distances to all votes. Returns how many changed.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>) -> usize {
    let votes = votes(state);
    let mut changes = Vec::new();
    for (i, votes) in votes.iter().enumerate() {
        let live = &state.items[i];
        if !live.alive || live.item.frozen.is_some() || votes.is_empty() {
            continue;
        }
        let spread = |source: u32| -> f32 {
            let feature = &state.library.feature[source as usize];
            votes.iter().map(|&v| feature.distance2(&state.library.feature[v as usize])).sum()
        };
        let present = spread(live.item.source);
        let best = votes.iter().filter(|&&v| state.library.copyable[v as usize]).map(|&v| (spread(v), v));
        if let Some((cost, source)) = best.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            && cost < RELUCTANCE * present
        {
            changes.push((i as u32, source));
        }
    }
    changes.iter().for_each(|&(i, source)| state.set_source(i, source));
    changes.len()
}

/// For every item, the exemplar elements that its samples were matched with.
fn votes<const D: usize>(state: &State<'_, D>) -> Vec<Vec<u32>> {
    let mut votes = vec![Vec::new(); state.items.len()];
    for &s in &state.living {
        let Some(matched) = &state.samples[s as usize].matched else { continue };
        votes[state.samples[s as usize].item as usize].push(state.level.element[matched.input as usize]);
        for &(o, i) in &matched.pairs {
            votes[state.samples[o as usize].item as usize].push(state.level.element[i as usize]);
        }
    }
    votes
}
