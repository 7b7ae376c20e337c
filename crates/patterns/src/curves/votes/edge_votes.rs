//! What the matched neighbourhoods say about edges.

use arabesque_core::{Budget, Numbered, Result};

use rayon::prelude::*;

use crate::{
    exemplar::graph::net::{MAX_EDGE, Net, Piece},
    output::state::State,
};

/// How strongly a poor match is discounted.
const DISCOUNT: f64 = 8.0;

/// Nanoseconds for a pair of a neighbourhood that is looked at, and for a vote.
const PRICE: (u64, u64) = (1, 150);

/// Pairs of samples, or samples, whose votes one thread sorts and counts by itself.
const ALONE: usize = 64;

/// A pair of output samples that some neighbourhood wants joined.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// The samples, the smaller number first.
    pub(crate) ends: (u32, u32),
    /// Share of the neighbourhoods with both ends that want them joined.
    pub(crate) confidence: f64,
    /// The stretches of exemplar line that were voted for, with their weights.
    pub(crate) pieces: Vec<(Piece, f64)>,
}

/// All votes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Votes {
    /// By ends.
    pub(crate) candidates: Vec<Candidate>,
    /// Expected number of edges of each sample [Tu 2020 eq. 18]; `None` for those nobody voted on.
    pub(crate) degree: Numbered<Option<f64>>,
}

impl Votes {
    /// Expected number of edges of a sample; `None` for those nobody voted on, and for those that are younger than the
    /// votes.
    pub(crate) fn degree(&self, s: u32) -> Option<f64> {
        self.degree.get(s as usize).copied().flatten()
    }
}

/// A wish to join two samples by a stretch of exemplar line, and how much it counts.
type Vote = ((u32, u32), Piece, f64);

/// One neighbourhood's opinion.
struct Opinion {
    /// (output sample, exemplar node), curve samples only.
    pairs: Vec<(u32, u32)>,
    weight: f64,
}

/// The votes on the present state; none where it has no curves.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn collect_votes<const D: usize>(state: &State<'_, D>) -> Result<Votes> {
    match &state.level.net {
        Some(net) => collect(state, net),
        None => Ok(Votes::default()),
    }
}

/// Collects the votes of all matched neighbourhoods.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn collect<const D: usize>(state: &State<'_, D>, net: &Net<D>) -> Result<Votes> {
    let budget = state.budget.stage("joining samples");
    budget.check()?;
    let opinions: Vec<Opinion> = state.living().par_iter().filter_map(|&s| opinion(state, s)).collect();
    let found: Vec<Vec<Vote>> =
        opinions.par_iter().map(|o| joined_pairs(state, net, o, &budget)).collect::<Result<_>>()?;
    budget.spend(0)?;
    let joined = sorted(&found, state.samples().len(), &budget)?;
    let of_pairs: Vec<&[Vote]> = joined.chunk_by(|a, b| a.0 == b.0).collect();
    let mut candidates: Vec<Candidate> = of_pairs.into_par_iter().with_min_len(ALONE).map(candidate).collect();
    let (weighed, degree) =
        rayon::join(|| weigh(state, &opinions, &mut candidates, &budget), || degrees(state, net, &opinions));
    weighed?;
    Ok(Votes { candidates, degree })
}

/// All votes by their ends and then by their pieces, those alike in the order in which they came: first put with those of the same
/// first end, which are few.
fn sorted(found: &[Vec<Vote>], samples: usize, budget: &Budget) -> Result<Vec<Vote>> {
    let mut starts = vec![0_u32; samples + 1];
    found.iter().flatten().for_each(|vote| starts[vote.0.0 as usize + 1] += 1);
    for s in 1..starts.len() {
        starts[s] += starts[s - 1];
    }
    let count = starts[samples] as usize;
    budget.spend(PRICE.1 * count as u64)?;
    let Some(any) = found.iter().flatten().next() else { return Ok(Vec::new()) };
    let mut votes = vec![*any; count];
    let mut next = starts.clone();
    for vote in found.iter().flatten() {
        let slot = &mut next[vote.0.0 as usize];
        votes[*slot as usize] = *vote;
        *slot += 1;
    }
    let mut of_ends: Vec<&mut [Vote]> = votes.chunk_by_mut(|a, b| a.0.0 == b.0.0).collect();
    of_ends.par_iter_mut().with_min_len(ALONE).for_each(|votes| {
        votes.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.line.cmp(&b.1.line)).then(a.1.from.total_cmp(&b.1.from)));
    });
    Ok(votes)
}

fn candidate(votes: &[Vote]) -> Candidate {
    let same = |a: &Piece, b: &Piece| a == b;
    let pieces = votes.chunk_by(|a, b| same(&a.1, &b.1)).map(|g| (g[0].1, g.iter().map(|v| v.2).sum()));
    Candidate { ends: votes[0].0, confidence: votes.iter().map(|v| v.2).sum(), pieces: pieces.collect() }
}

fn opinion<const D: usize>(state: &State<'_, D>, s: u32) -> Option<Opinion> {
    let matched = state.sample(s).matched.as_ref()?;
    let all = std::iter::once((s, matched.input)).chain(matched.pairs.iter().copied());
    let node = |(o, i): (u32, u32)| Some((o, state.level.node_of(i)?)).filter(|_| state.is_alive(o));
    let pairs: Vec<_> = all.filter_map(node).collect();
    (pairs.len() > 1).then(|| Opinion { pairs, weight: 1.0 / (1.0 + DISCOUNT * matched.energy()) })
}

/// Output pairs whose exemplar nodes are joined.
fn joined_pairs<const D: usize>(
    state: &State<'_, D>,
    net: &Net<D>,
    opinion: &Opinion,
    budget: &Budget,
) -> Result<Vec<Vote>> {
    let mut meter = budget.meter();
    let mut found = Vec::new();
    for &(o, e) in &opinion.pairs {
        meter.spend(PRICE.0 * (net.nodes[e].arms.len() * opinion.pairs.len()) as u64)?;
        for arm in &net.nodes[e].arms {
            let Some(&(p, _)) = opinion.pairs.iter().find(|(p, i)| *i == arm.to && *p > o) else { continue };
            if state.reach(o, p) <= MAX_EDGE * net.spacing {
                found.push(((o, p), arm.piece, opinion.weight));
            }
        }
    }
    Ok(found)
}

/// Divides the weight of each candidate by that of all neighbourhoods that hold both its ends.
fn weigh<const D: usize>(
    state: &State<'_, D>,
    opinions: &[Opinion],
    candidates: &mut [Candidate],
    budget: &Budget,
) -> Result<()> {
    let mut meter = budget.meter();
    // Candidates are sorted by their first end: where those of each sample begin.
    let mut starts = vec![0_u32; state.samples().len() + 1];
    candidates.iter().for_each(|candidate| starts[candidate.ends.0 as usize + 1] += 1);
    for s in 1..starts.len() {
        starts[s] += starts[s - 1];
    }
    let of_sample = |s: u32| starts[s as usize]..starts[s as usize + 1];
    let second_end = |c: u32| candidates[c as usize].ends.1;
    let mut all = Numbered::filled(0.0, candidates.len());
    // The last neighbourhood that holds each sample.
    let mut stamp = Numbered::filled(None, state.samples().len());
    for (n, opinion) in opinions.iter().enumerate() {
        opinion.pairs.iter().for_each(|(o, _)| stamp[*o] = Some(n));
        for (o, _) in &opinion.pairs {
            meter.spend(PRICE.0 * (4 + of_sample(*o).len()) as u64)?;
            for c in of_sample(*o) {
                if stamp[second_end(c)] == Some(n) {
                    all[c] += opinion.weight;
                }
            }
        }
    }
    for (candidate, all) in candidates.iter_mut().zip(all) {
        candidate.confidence /= f64::max(all, f64::MIN_POSITIVE);
    }
    Ok(())
}

fn degrees<const D: usize>(state: &State<'_, D>, net: &Net<D>, opinions: &[Opinion]) -> Numbered<Option<f64>> {
    let mut sum = Numbered::filled((0.0, 0.0), state.samples().len());
    for opinion in opinions {
        for &(o, e) in &opinion.pairs {
            let entry = &mut sum[o];
            *entry = (entry.0 + opinion.weight * net.degree(e) as f64, entry.1 + opinion.weight);
        }
    }
    sum.into_iter().map(|(total, weight)| (weight > 0.0).then_some(total / weight)).collect()
}
