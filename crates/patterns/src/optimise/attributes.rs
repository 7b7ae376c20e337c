//! Attribute assignment: which exemplar element is drawn, by selection and never by blending [Ma 2011 eq. 5].

use arabesque_core::{Meter, Result};

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
    let better = |i: u32| {
        let source = better_source(state, i, votes.of(i), &mut budget.meter())?;
        Ok(source.map(|source| (i, source)))
    };
    let items = state.items().numbers().into_par_iter();
    let changes: Vec<Option<(u32, u32)>> = items.map(better).collect::<Result<_>>()?;
    budget.spend(0)?;
    let changes: Vec<_> = changes.into_iter().flatten().collect();
    changes.iter().for_each(|&(i, source)| state.set_source(i, source));
    Ok(changes.len())
}

/// The source that suits the votes for item `i` clearly better than its present one.
fn better_source<const D: usize>(
    state: &State<'_, D>,
    i: u32,
    votes: &[u32],
    meter: &mut Meter<'_>,
) -> Result<Option<u32>> {
    let (live, library) = (state.item(i), state.library);
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
struct ElementVotes {
    /// Those of item `i`: `elements[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl ElementVotes {
    fn of(&self, i: u32) -> &[u32] {
        &self.elements[self.starts[i as usize] as usize..self.starts[i as usize + 1] as usize]
    }
}

fn votes<const D: usize>(state: &State<'_, D>, meter: &mut Meter<'_>) -> Result<ElementVotes> {
    let matched = || state.living().iter().filter_map(|&s| Some((s, state.sample(s).matched.as_ref()?)));
    let mut starts = vec![0_u32; state.items().len() + 1];
    for (s, m) in matched() {
        meter.spend(PRICE.1 * (1 + m.pairs.len() as u64))?;
        starts[state.sample(s).item as usize + 1] += 1;
        m.pairs.iter().for_each(|&(o, _)| starts[state.sample(o).item as usize + 1] += 1);
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut elements = vec![0; starts.last().map_or(0, |&n| n as usize)];
    let mut vote = |s: u32, i: u32| {
        let slot = &mut next[state.sample(s).item as usize];
        elements[*slot as usize] = state.level.element[i];
        *slot += 1;
    };
    for (s, m) in matched() {
        vote(s, m.input);
        m.pairs.iter().for_each(|&(o, i)| vote(o, i));
    }
    Ok(ElementVotes { starts, elements })
}
