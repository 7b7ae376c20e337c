//! Search: the exemplar neighbourhood most like that of each output sample.
//!
//! Candidates come from the matches of the neighbours: where neighbour `o` was matched, the exemplar sample that then
//! corresponded to this sample is a candidate, and so are the ones most similar to it (k-coherence [Ma 2011 §4.2]) or
//! random ones around it (PatchMatch [Tu 2020 §4.3.3], all samples in step rather than in scanline order, so that the
//! result does not depend on the number of threads). Samples around which nothing changed keep their match.

use arabesque_core::{Budget, Numbered, Result, Stream, Vector};
use rayon::prelude::*;

use crate::{
    exemplar::{
        graph::net::Star,
        level::{Level, fall_off},
        library::Library,
    },
    optimise::matching::{Matcher, Prices, Row, Surroundings},
    output::state::{Match, State},
    params::{Matching, Search},
    streams,
};

/// A neighbourhood with less than this energy is as good as a copy: no better one is looked for.
const COPY: f32 = 1e-3;

/// Where not every sample looks beyond what its neighbours tell, one in so many does: late in a level that finds a better match for one in
/// two hundred, and takes two thirds of the time.
const TURNS: u64 = 4;

/// Nanoseconds to find a neighbour, and to look one up in a match.
const PRICE: (u64, u64) = (20, 1);

/// How the search is done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchParams {
    pub(crate) search: Search,
    pub(crate) matching: Matching,
    pub(crate) prices: Prices,
    /// Members of a similarity set.
    pub(crate) coherence: usize,
    /// Random candidates per sample.
    pub(crate) random: usize,
    /// Rounds of propagation.
    pub(crate) rounds: usize,
    /// Whether every sample looks beyond what its neighbours tell.
    pub(crate) thorough: bool,
    /// Distinguishes the random draws of this step from those of other steps.
    pub(crate) step: u64,
}

/// Finds a match for every living sample. Returns how many samples were searched anew.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the matches are those of the last round that was finished.
pub(crate) fn search<const D: usize>(state: &mut State<'_, D>, params: &SearchParams) -> Result<usize> {
    let budget = state.budget.stage("searching");
    state.hold_neighbourhoods()?;
    let stars = stars(state);
    let mut searched = 0;
    for round in 0..params.rounds as u64 {
        let params = SearchParams { step: params.step + (round << 40), ..*params };
        let found: Vec<Option<Match>> = state
            .living()
            .par_iter()
            .map_init(
                || {
                    let matcher = Matcher::new(state.level, state.library, &stars, params.matching, params.prices);
                    (matcher, Bench::default())
                },
                |(matcher, bench), &s| search_one(state, s, &params, (matcher, bench), &budget),
            )
            .collect::<Result<_>>()?;
        budget.spend(0)?;
        searched += found.iter().flatten().count();
        let searched_now: Vec<_> = state.living().iter().copied().zip(found).collect();
        for (s, found) in searched_now {
            found.into_iter().for_each(|found| state.set_match(s, found));
        }
    }
    state.clear_dirty();
    Ok(searched)
}

/// The edges of each living sample; none at all where there are no curves.
fn stars<const D: usize>(state: &State<'_, D>) -> Numbered<Star<D>> {
    if state.level.net.is_none() {
        return Numbered::new();
    }
    let star = |s: u32| if state.is_alive(s) { state.star(s) } else { Star::EMPTY };
    (0..state.samples().len() as u32).into_par_iter().map(star).collect::<Vec<_>>().into()
}

/// What a search works with, kept from one to the next.
#[derive(Default)]
struct Bench<const D: usize> {
    around: Surroundings<D>,
    candidates: Vec<u32>,
}

/// The exemplar samples with the neighbourhoods most similar to that of `i`, best first [Ma 2011 §4.2].
///
/// Keys with very many samples are compared with an even selection of them: the sets need good members, not the best.
fn most_similar<const D: usize>(
    level: &Level<D>,
    library: &Library<D>,
    matching: Matching,
    number: usize,
    i: u32,
    budget: &Budget,
) -> Result<Vec<u32>> {
    const MAX_COMPARED: usize = 128;
    // Of more than that many, the fewer the more there are: what all of them cost stays in proportion to their number.
    const LEAST_COMPARED: usize = 64;
    let mut matcher = Matcher::new(level, library, &level.stars, matching, Prices { missing: 0.0, outside: 0.0 });
    let others = &level.of_key[level.key[i]];
    let around = exemplar_surroundings(level, i);
    let mut best: Vec<(f32, u32)> = Vec::with_capacity(number + 1);
    let mut meter = budget.meter();
    let compared = (MAX_COMPARED * MAX_COMPARED / others.len().max(MAX_COMPARED)).max(LEAST_COMPARED);
    for &j in others.iter().step_by(others.len().div_ceil(compared)).filter(|&&j| j != i) {
        let full = best.len() == number;
        let limit = if full { best.last().map_or(0.0, |b| b.0) } else { f32::INFINITY };
        let cost = matcher.cost(&around, j, limit, &|_| true, &mut meter)?;
        if cost < limit {
            let at = best.partition_point(|b| b.0 <= cost);
            best.insert(at, (cost, j));
            best.truncate(number);
        }
    }
    Ok(best.into_iter().map(|(_, j)| j).collect())
}

/// How far the exemplar is from repeating itself: the mean energy of the best match of a neighbourhood among those that
/// do not overlap it much. 0 for a perfect lattice, about 1 and more where nothing is like anything else; `None` where
/// too little of it is seen to tell.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn dissimilarity<const D: usize>(
    level: &Level<D>,
    library: &Library<D>,
    matching: Matching,
    budget: &Budget,
) -> Result<Option<f64>> {
    const ASKED: usize = 96;
    let inner: Vec<u32> = (0..level.position.len() as u32)
        .filter(|&i| library.view.signed_distance(level.position[i]) > 0.7 * level.radius)
        .collect();
    let asked: Vec<u32> = inner.iter().copied().step_by(inner.len().div_ceil(ASKED).max(1)).collect();
    let energies: Vec<Option<f64>> = asked
        .par_iter()
        .map(|&i| {
            let mut meter = budget.meter();
            let mut matcher =
                Matcher::new(level, library, &level.stars, matching, Prices { missing: 1.0, outside: 0.0 });
            let around = exemplar_surroundings(level, i);
            let scale: f32 = around.rows.iter().map(|r| r.weight * level.outlier2[r.key]).sum();
            let others = &level.of_key[level.key[i]];
            let apart = |j: &&u32| (level.position[**j] - level.position[i]).norm() > level.radius;
            let mut best = f32::INFINITY;
            for &j in others.iter().filter(apart) {
                best = best.min(matcher.cost(&around, j, best, &|_| true, &mut meter)?);
            }
            Ok((scale > 0.0).then(|| f64::from((best / scale).min(2.0))))
        })
        .collect::<Result<_>>()?;
    budget.spend(0)?;
    let energies: Vec<f64> = energies.into_iter().flatten().collect();
    Ok((energies.len() >= 8).then(|| energies.iter().sum::<f64>() / energies.len() as f64))
}

/// The neighbourhood of an exemplar sample, as if it were an output sample.
fn exemplar_surroundings<const D: usize>(level: &Level<D>, i: u32) -> Surroundings<D> {
    let near = level.neighbours(i).iter().filter(|n| n.weight > 0.0);
    let mut rows: Vec<_> = near
        .map(|n| Row {
            sample: n.sample,
            key: level.key[n.sample],
            source: level.element[n.sample],
            offset: Vector(n.offset.map(f64::from)),
            weight: n.weight,
            frozen: false,
        })
        .collect();
    rows.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.sample.cmp(&b.sample)));
    Surroundings { sample: i, source: level.element[i], rows }
}

fn search_one<const D: usize>(
    state: &State<'_, D>,
    s: u32,
    params: &SearchParams,
    (matcher, bench): (&mut Matcher<'_, D>, &mut Bench<D>),
    budget: &Budget,
) -> Result<Option<Match>> {
    let mut meter = budget.meter();
    let Bench { around, candidates } = bench;
    let (dirty, looked) = surround(state, s, around);
    meter.spend(PRICE.1 * looked + PRICE.0 * around.rows.len() as u64)?;
    let old = state.sample(s).matched.as_ref();
    if !dirty && old.is_some_and(|m| m.members.len() == around.rows.len()) {
        return Ok(None);
    }
    let position = state.sample(s).position;
    let frame = state.request.fields.frame(position);
    let reach = (state.level.radius) * frame.spacing_scale;
    let deep = state.domain().signed_distance(position) > reach;
    let wanted = |offset: Vector<D>| deep || state.extent.may_hold(position + frame.to_output(offset));
    let scale: f32 = around.rows.iter().map(|r| r.weight * state.level.outlier2[r.key]).sum();
    let mut best = (f32::INFINITY, u32::MAX);
    likely(state, s, around, params, candidates);
    meter.spend(PRICE.1 * (around.rows.len() * around.rows.len()) as u64)?;
    let seeds = candidates.len();
    let mut next = 0;
    while next < candidates.len() && best.0 > COPY * scale {
        let i = candidates[next];
        let cost = matcher.cost(around, i, best.0, &wanted, &mut meter)?;
        if cost < best.0 || (cost == best.0 && i < best.1) {
            best = (cost, i);
            matcher.keep();
        }
        next += 1;
        if next == seeds && best.0 > COPY * scale && is_curious(s, old, params) {
            add_unlikely(candidates, state, s, params, budget)?;
        }
    }
    let input = best.1;
    let found = matcher.correspondence(input, &wanted);
    let own = state.level.outlier2[state.sample(s).key];
    Ok(Some(Match {
        input,
        cost: best.0,
        scale: scale + own,
        pairs: found.pairs.iter().map(|&(row, i)| (around.rows[row as usize].sample, i)).collect(),
        members: around.rows.iter().map(|r| r.sample).collect(),
        missing: found.missing,
        is_new: old.is_none_or(|m| m.input != input),
    }))
}

/// Makes `around` the neighbourhood of sample `s`. Returns whether anything in it changed, and how many samples were looked at.
fn surround<const D: usize>(state: &State<'_, D>, s: u32, around: &mut Surroundings<D>) -> (bool, u64) {
    let sample = state.sample(s);
    let frame = state.request.fields.frame(sample.position);
    let radius = state.level.radius;
    let mut dirty = sample.dirty;
    let rows = &mut around.rows;
    rows.clear();
    let looked = state.within(sample.position, radius * frame.spacing_scale, |other, offset| {
        if other == s {
            return;
        }
        let neighbour = state.sample(other);
        let item = &state.item(neighbour.item).item;
        let offset = frame.to_exemplar(offset);
        dirty |= neighbour.dirty;
        rows.push(Row {
            sample: other,
            key: neighbour.key,
            source: item.source,
            offset,
            weight: fall_off(offset, radius) as f32,
            frozen: item.frozen.is_some() && item.source < state.level.base,
        });
    });
    // Nearest first: the bound of the matcher then grows fastest.
    rows.sort_unstable_by(|a, b| b.weight.total_cmp(&a.weight).then(a.sample.cmp(&b.sample)));
    (around.sample, around.source) = (s, state.item(sample.item).item.source);
    (dirty, looked)
}

/// Makes `list` the exemplar samples to try first for sample `s`, the likeliest first.
fn likely<const D: usize>(
    state: &State<'_, D>,
    s: u32,
    around: &Surroundings<D>,
    params: &SearchParams,
    list: &mut Vec<u32>,
) {
    let sample = state.sample(s);
    let all = &state.level.of_key[sample.key];
    list.clear();
    if is_exhaustive(all, params) {
        list.extend_from_slice(all);
        return;
    }
    if let Some(m) = &sample.matched {
        push(list, m.input);
    }
    push(list, state.level.first[around.source] + sample.part);
    // PatchMatch asks the eight nearest neighbours [Tu 2020 §4.3.3], k-coherence all of them.
    let asked = if params.search == Search::PatchMatch { 8 } else { around.rows.len() };
    let from_neighbours = around.rows.iter().take(asked).filter_map(|row| implied(state, row.sample, s));
    from_neighbours.for_each(|i| push(list, i));
}

/// Exemplar samples to try when none of the likely ones in `list` is a copy: what is similar to these, and random ones.
fn add_unlikely<const D: usize>(
    list: &mut Vec<u32>,
    state: &State<'_, D>,
    s: u32,
    params: &SearchParams,
    budget: &Budget,
) -> Result<()> {
    let level = state.level;
    let all = &level.of_key[state.sample(s).key];
    if is_exhaustive(all, params) {
        return Ok(());
    }
    let seeds = list.len();
    if params.search == Search::KCoherence {
        for k in 0..seeds.min(6) {
            let i = list[k];
            let find = || most_similar(level, state.library, params.matching, params.coherence, i, budget);
            level.alike(i, find)?.iter().for_each(|&j| push(list, j));
        }
    }
    let mut random = Stream::new(state.request.seed ^ (params.step << 20), streams::SEARCH, u64::from(s));
    for n in 0..params.random {
        let seed = list[n % seeds];
        push(list, random_near(state, seed, all, n, &mut random));
    }
    Ok(())
}

/// Whether sample `s` looks beyond what its neighbours tell: those that were just matched anew, and the others in turns.
fn is_curious(s: u32, old: Option<&Match>, params: &SearchParams) -> bool {
    params.thorough || old.is_none_or(|m| m.is_new) || (u64::from(s) + params.step).is_multiple_of(TURNS)
}

fn is_exhaustive(all: &[u32], params: &SearchParams) -> bool {
    params.search == Search::Exhaustive || all.len() <= 8
}

fn push(list: &mut Vec<u32>, i: u32) {
    if !list.contains(&i) {
        list.push(i);
    }
}

/// The exemplar sample that `s` corresponds to when neighbour `o` lies where it was matched.
fn implied<const D: usize>(state: &State<'_, D>, o: u32, s: u32) -> Option<u32> {
    let matched = state.sample(o).matched.as_ref()?;
    matched.pairs.iter().find(|(sample, _)| *sample == s).map(|&(_, i)| i)
}

/// A random sample of the same key, in a window around `seed` that halves with each draw.
fn random_near<const D: usize>(state: &State<'_, D>, seed: u32, all: &[u32], n: usize, random: &mut Stream) -> u32 {
    let size = state.library.view.window.size().0.into_iter().fold(0.0, f64::max);
    let window = size * 0.5_f64.powi((n % 4) as i32);
    let centre = state.level.position[seed];
    let mut pick = all[random.below(all.len())];
    // A few draws suffice: an empty window falls back to anywhere.
    for _ in 0..4 {
        if (state.level.position[pick] - centre).norm() <= window {
            break;
        }
        pick = all[random.below(all.len())];
    }
    pick
}
