//! Edge assignment: which samples are joined [Tu 2020 §4.3.4, eqs 17 to 22].

use arabesque_core::{
    GridIndex, Numbered, Result, Vector,
    pairing::{Wish, pair_up},
};

use rayon::prelude::*;

use crate::{
    curves::votes::edge_votes::{self, Votes},
    exemplar::graph::net::Net,
    output::state::State,
};

/// Two samples are joined when each lies this near to where the exemplar has the other, in sampling distances.
const NEAR: f64 = 0.7;

/// Nanoseconds for a sample, and for two missing edges that are compared.
const PRICE: (u64, u64) = (200, 10);

/// Joins samples as the matched neighbourhoods vote. Returns the votes and how many samples changed their edges.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the edges stay as they are.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>) -> Result<(Votes, usize)> {
    let level = state.level;
    let Some(net) = &level.net else {
        return Ok((Votes::default(), 0));
    };
    let mut votes = edge_votes::collect(state, net)?;
    count_frozen(state, net, &mut votes);
    let mut links = frozen_links(state);
    switch_on(&votes, &mut links, &|a, b| state.is_frozen_edge(a, b));
    let mut changed = 0;
    for (s, mut new) in (0..).zip(links) {
        new.sort_unstable();
        changed += usize::from(state.replace_links(s, new));
    }
    Ok((votes, changed))
}

/// Of a frozen sample its own strokes tell how many edges it has, more than its neighbours.
fn count_frozen<const D: usize>(state: &State<'_, D>, net: &Net<D>, votes: &mut Votes) {
    for s in votes.degree.numbers().filter(|&s| state.is_frozen(s)) {
        if let Some(node) = state.node(s) {
            votes.degree[s] = Some(net.degree(node) as f64);
        }
    }
}

/// Switches candidates on, in falling confidence, wherever that lowers the objective; those that are fixed stay as they
/// are.
fn switch_on(votes: &Votes, links: &mut Numbered<Vec<u32>>, is_fixed: &dyn Fn(u32, u32) -> bool) {
    for c in falling(votes) {
        let candidate = &votes.candidates[c];
        let (a, b) = candidate.ends;
        if links[a].contains(&b) || is_fixed(a, b) {
            continue;
        }
        let surplus = [a, b].map(|s| votes.degree[s].map(|expected| links[s].len() as f64 - expected));
        if gain(candidate.confidence, surplus) < 0.0 {
            links[a].push(b);
            links[b].push(a);
        }
    }
}

/// Candidates by falling confidence.
fn falling(votes: &Votes) -> Vec<usize> {
    let mut order: Vec<usize> = (0..votes.candidates.len()).collect();
    let key = |c: usize| &votes.candidates[c];
    order.sort_by(|&a, &b| key(b).confidence.total_cmp(&key(a).confidence).then(key(a).ends.cmp(&key(b).ends)));
    order
}

/// Change of the objective when an edge is switched on: its confidence, and at both ends the degree as it is less the
/// degree expected [Tu 2020 eq. 22].
fn gain(confidence: f64, surplus: [Option<f64>; 2]) -> f64 {
    let degree: f64 = surplus.iter().map(|s| s.map_or(0.0, |s| 2.0 * s + 1.0)).sum();
    1.0 - 2.0 * confidence + degree
}

/// The edges of frozen samples among themselves, which never change.
fn frozen_links<const D: usize>(state: &State<'_, D>) -> Numbered<Vec<u32>> {
    let frozen = |s: u32| state.links_of(s).iter().copied().filter(move |&o| state.is_frozen_edge(s, o)).collect();
    state.samples().numbers().map(frozen).collect()
}

/// An edge that the source of a sample has and the sample has not.
#[derive(Clone, Debug)]
pub(crate) struct OpenArm<const D: usize> {
    pub(crate) sample: u32,
    /// Where the other end should be.
    pub(crate) place: Vector<D>,
    /// The node at the other end; the node itself where the window of the exemplar cuts the edge off.
    pub(crate) node: u32,
}

/// Joins samples as their sources in the exemplar are: wherever one misses an edge and another one lies where that edge
/// should end, and misses one as well.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the edges stay as they are.
pub(crate) fn link_sources<const D: usize>(state: &mut State<'_, D>) -> Result<()> {
    let Some(net) = &state.level.net else { return Ok(()) };
    let budget = state.budget.stage("joining samples");
    budget.spend(PRICE.0 * state.living().len() as u64)?;
    let mut meter = budget.meter();
    let open: Vec<OpenArm<D>> = state.living().par_iter().flat_map_iter(|&s| open_arms(state, net, s)).collect();
    let places: Vec<_> = open.iter().map(|arm| state.domain().wrap(arm.place)).collect();
    let unit = net.spacing * state.extent.largest_spacing_scale;
    let index = GridIndex::new(&places, unit, state.domain());
    let mut wishes = Vec::new();
    for (i, arm) in open.iter().enumerate() {
        let p = state.sample(arm.sample).position;
        let near = NEAR * net.spacing * state.request.fields.frame(p).spacing_scale;
        // The other arm wants to end here, and this one there.
        let looked = index.within(p, near, |j, offset| {
            let other = &open[j];
            let back = state.domain().offset(state.sample(other.sample).position, arm.place).norm();
            if other.sample != arm.sample && back <= near && state.share_style(other.sample, arm.sample) {
                wishes.push(Wish { cost: back + offset.norm(), a: i.min(j), b: i.max(j) });
            }
        });
        meter.spend(PRICE.1 * looked)?;
    }
    pair_up(wishes, open.len(), |i, j| {
        let (a, b) = (open[i].sample, open[j].sample);
        let may = !state.is_frozen_edge(a, b) && !state.are_linked(a, b);
        if may {
            state.link(a, b);
        }
        may
    });
    Ok(())
}

/// The edges that the source of `s` has, except those that `s` has too.
pub(crate) fn open_arms<const D: usize>(state: &State<'_, D>, net: &Net<D>, s: u32) -> Vec<OpenArm<D>> {
    let Some(number) = state.node(s) else { return Vec::new() };
    let position = state.sample(s).position;
    let frame = state.request.fields.frame(position);
    let node = &net.nodes[number];
    let inner = node.arms.iter().map(|arm| (net.nodes[arm.to].position - node.position, arm.to));
    let cut = node.beyond.iter().map(|t| (*t * net.spacing, number));
    let mut arms: Vec<(Vector<D>, u32)> = inner.chain(cut).map(|(v, to)| (frame.to_output(v), to)).collect();
    for &o in state.links_of(s) {
        let way = state.offset(s, o);
        let best = (0..arms.len()).min_by(|&a, &b| (arms[a].0 - way).norm2().total_cmp(&(arms[b].0 - way).norm2()));
        best.into_iter().for_each(|k| {
            arms.swap_remove(k);
        });
    }
    arms.into_iter().map(|(way, node)| OpenArm { sample: s, place: position + way, node }).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::curves::votes::edge_votes::Candidate;

    const SAMPLES: u32 = 5;

    /// All pairs of samples.
    fn pairs() -> Vec<(u32, u32)> {
        (0..SAMPLES).flat_map(|a| (a + 1..SAMPLES).map(move |b| (a, b))).collect()
    }

    fn votes(confidence: &[f64], degree: &[f64]) -> Votes {
        let candidate = |(&confidence, ends)| Candidate { ends, confidence, pieces: Vec::new() };
        let candidates = confidence.iter().zip(pairs()).map(candidate).collect();
        Votes { candidates, degree: degree.iter().copied().map(Some).collect() }
    }

    /// The objective for a choice of edges, one bit each [Tu 2020 eq. 22].
    fn objective(votes: &Votes, on: u32) -> f64 {
        let mut degree = Numbered::filled(0.0, SAMPLES as usize);
        let mut sum = 0.0;
        for (k, candidate) in votes.candidates.iter().enumerate() {
            let x = f64::from(on >> k & 1);
            sum += (x - candidate.confidence).powi(2);
            degree[candidate.ends.0] += x;
            degree[candidate.ends.1] += x;
        }
        sum + degree.iter().zip(&votes.degree).map(|(d, e)| (d - e.unwrap()) * (d - e.unwrap())).sum::<f64>()
    }

    fn greedy(votes: &Votes) -> u32 {
        let mut links = Numbered::filled(Vec::new(), SAMPLES as usize);
        switch_on(votes, &mut links, &|_, _| false);
        let is_on = |c: &Candidate| links[c.ends.0].contains(&c.ends.1);
        votes.candidates.iter().enumerate().map(|(k, c)| u32::from(is_on(c)) << k).sum()
    }

    fn best(votes: &Votes) -> f64 {
        (0..1 << votes.candidates.len()).map(|on| objective(votes, on)).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        /// Where the degrees are those of the edges that most want, all choices of edges have none better than the
        /// greedy one.
        #[test]
        fn without_conflict_the_choice_is_the_best_of_all(
            wanted in prop::collection::vec((any::<bool>(), 0.0..0.45_f64), 10),
        ) {
            let confidence: Vec<f64> = wanted.iter().map(|&(on, d)| if on { 1.0 - d } else { d }).collect();
            let mut degree = Numbered::filled(0.0, SAMPLES as usize);
            for (&(on, _), (a, b)) in wanted.iter().zip(pairs()) {
                degree[a] += f64::from(u8::from(on));
                degree[b] += f64::from(u8::from(on));
            }
            let votes = votes(&confidence, &degree);
            prop_assert!((objective(&votes, greedy(&votes)) - best(&votes)).abs() < 1e-9);
        }

        /// Where votes and degrees conflict, the greedy choice may miss the best of all. It lies between that and no
        /// edge at all, and no single further edge would lower it.
        #[test]
        fn with_conflicts_no_further_edge_would_help(
            confidence in prop::collection::vec(0.0..1.0_f64, 10),
            degree in prop::collection::vec(0.0..4.0_f64, 5),
        ) {
            let votes = votes(&confidence, &degree);
            let on = greedy(&votes);
            let reached = objective(&votes, on);
            prop_assert!(best(&votes) <= reached + 1e-9 && reached <= objective(&votes, 0) + 1e-9);
            for k in (0..10).filter(|k| on >> k & 1 == 0) {
                prop_assert!(objective(&votes, on | 1 << k) >= reached - 1e-9);
            }
        }
    }
}
