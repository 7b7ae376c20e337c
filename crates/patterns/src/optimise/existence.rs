//! Existence assignment: which elements should be there [Tu 2020 §4.3.4, appendix A].
//!
//! Search and the other assignments move what is there; only votes on existence repair that there is too much or too
//! little. An element that most overlapping neighbourhoods left without a partner is removed. Where most neighbourhoods
//! miss an exemplar element, it is added. The samples of an element come and go together; frozen elements stay.

use arabesque_core::{Buckets, Budget, Domain, Matrix, Meter, Numbered, Result, Vector};
use rayon::prelude::*;

use crate::output::{
    draft::Item,
    state::{LiveItem, State},
};

/// Confidence from which an element exists.
const HALF: f64 = 0.5;

/// Two elements crowd each other when they are closer than this share of the closest distance of their classes.
const CROWDED: f64 = 0.4;

/// Share of the closest distance of their classes that a new element keeps.
const ROOM: f64 = 0.6;

/// Share of its source's distance to its nearest neighbour that a new curve sample keeps.
const OWN_ROOM: f64 = 0.6;

/// Adding stops at this multiple of the target number of a class.
const MAX_SURPLUS: f64 = 1.03;

/// Most pieces in which votes are counted, and fewest samples of one: their number must not depend on that of the threads.
const PIECES: usize = 8;
const ALONE: usize = 512;

/// Nanoseconds for a sample, element or vote that is looked at.
const LOOK: u64 = 5;

/// How many elements were added and removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Changes {
    pub(crate) added: usize,
    pub(crate) removed: usize,
}

/// Adds and removes elements by the votes of the last search. `targets[c]` is the number of elements of class `c` that
/// the output should have: votes alone drift, since a poor neighbourhood loses elements before it can gain any. Removal
/// stops at the share `floor` of the target.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then nothing is added, and either all or nothing removed.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>, targets: &Numbered<f64>, floor: f64) -> Result<Changes> {
    let budget = state.budget.stage("adding and removing elements");
    let removed = remove(state, targets, floor, &budget)?;
    let new = wanted(state, targets, &budget)?;
    new.iter().for_each(|&item| _ = state.push(item, Matrix::identity()));
    if removed + new.len() > 0 {
        state.reindex();
    }
    Ok(Changes { added: new.len(), removed })
}

/// Living items of each class. What the user drew beyond the border is not part of what should be there.
fn class_counts<const D: usize>(state: &State<'_, D>) -> Numbered<f64> {
    let mut counts = Numbered::filled(0.0, state.library.classes());
    let counts_in = |i: &&LiveItem<D>| i.item.frozen.is_none() || state.domain().contains(i.item.position);
    for live in state.items().iter().filter(|i| i.alive).filter(counts_in) {
        counts[state.library.class[live.item.source]] += 1.0;
    }
    counts
}

fn remove<const D: usize>(
    state: &mut State<'_, D>,
    targets: &Numbered<f64>,
    floor: f64,
    budget: &Budget,
) -> Result<usize> {
    let confidence = confidences(state, budget)?;
    let mut counts = class_counts(state);
    let mut doubted: Vec<u32> = (0..state.items().len() as u32)
        .filter(|&i| {
            let live = state.item(i);
            live.alive && live.item.frozen.is_none() && confidence[i] < HALF
        })
        .collect();
    doubted.sort_by(|&a, &b| confidence[a].total_cmp(&confidence[b]).then(a.cmp(&b)));
    let mut removed = 0;
    for i in doubted {
        let class = state.library.class[state.item(i).item.source];
        if counts[class] <= floor * targets[class] {
            continue;
        }
        counts[class] -= 1.0;
        removed += 1;
        state.remove_item(i);
    }
    if removed > 0 {
        announce_removed(state);
    }
    Ok(removed)
}

/// Share of the overlapping neighbourhoods in which each item had a partner; 1 where none overlaps [Tu 2020 eq. 16].
fn confidences<const D: usize>(state: &State<'_, D>, budget: &Budget) -> Result<Numbered<f64>> {
    let count = |living: &[u32]| -> Result<Numbered<(u32, u32)>> {
        let mut meter = budget.meter();
        let mut votes = Numbered::filled((0_u32, 0_u32), state.items().len());
        for &s in living {
            let Some(matched) = &state.sample(s).matched else { continue };
            meter.spend(LOOK * matched.members.len() as u64)?;
            matched.members.iter().for_each(|&o| votes[state.sample(o).item].0 += 1);
            matched.pairs.iter().for_each(|&(o, _)| votes[state.sample(o).item].1 += 1);
        }
        Ok(votes)
    };
    // Each piece counts for all items: whole numbers can be added up in any order.
    let piece = state.living().len().div_ceil(PIECES).max(ALONE);
    let counted: Vec<_> = state.living().par_chunks(piece).map(count).collect::<Result<_>>()?;
    budget.spend(0)?;
    let share = |(all, kept)| if all > 0 { f64::from(kept) / f64::from(all) } else { 1.0 };
    let sum = |i: u32| counted.iter().fold((0, 0), |sum, votes| (sum.0 + votes[i].0, sum.1 + votes[i].1));
    let mut confidence: Numbered<f64> = state.items().numbers().map(|i| share(sum(i))).collect();
    for i in crowded(state, &confidence, budget)? {
        confidence[i] *= HALF;
    }
    Ok(confidence)
}

/// Of each pair of elements that are closer than any such pair of the exemplar, the one with the smaller confidence.
fn crowded<const D: usize>(state: &State<'_, D>, confidence: &Numbered<f64>, budget: &Budget) -> Result<Vec<u32>> {
    let firsts = state.living().par_iter().filter(|&&s| state.sample(s).part == 0);
    let losing: Vec<_> = firsts.map(|&s| loses(state, confidence, s, &mut budget.meter())).collect::<Result<_>>()?;
    budget.spend(0)?;
    Ok(losing.into_iter().flatten().collect())
}

/// The item of sample `s`, if it crowds one of larger confidence.
fn loses<const D: usize>(
    state: &State<'_, D>,
    confidence: &Numbered<f64>,
    s: u32,
    meter: &mut Meter<'_>,
) -> Result<Option<u32>> {
    let i = state.sample(s).item;
    let live = state.item(i);
    let class = state.library.class[live.item.source];
    let scale = CROWDED * state.request.fields.frame(live.item.position).spacing_scale;
    let mut crowded = false;
    let looked = state.within(state.sample(s).position, scale * state.library.widest(class), |o, _| {
        let j = state.sample(o).item;
        let other = state.item(j);
        let least = scale * state.library.closest(class, state.library.class[other.item.source]);
        let close = state.domain().offset(live.item.position, other.item.position).norm() < least;
        crowded |= j != i && close && (confidence[i], i) < (confidence[j], j);
    });
    meter.spend(LOOK * looked)?;
    Ok(crowded.then_some(i))
}

/// Makes the neighbours of the dead search again.
fn announce_removed<const D: usize>(state: &mut State<'_, D>) {
    let misses = |s: &u32| {
        let matched = state.sample(*s).matched.as_ref();
        matched.is_some_and(|m| m.members.iter().any(|&o| !state.is_alive(o)))
    };
    let samples = state.samples().numbers().into_par_iter().with_min_len(ALONE);
    let missing: Vec<u32> = samples.filter(misses).collect();
    missing.into_iter().for_each(|s| state.mark_dirty(s));
}

/// An element that a neighbourhood misses.
struct MissedElement<const D: usize> {
    element: u32,
    class: u32,
    place: Vector<D>,
    /// How near another neighbourhood must miss one of its class to mean the same.
    near: f64,
}

/// A place where elements are missed.
struct Cluster<const D: usize> {
    class: u32,
    centre: Vector<D>,
    /// Sum of offsets from `centre` of the candidates.
    shift: Vector<D>,
    votes: Vec<u32>,
}

/// Places where elements are missed, quick to look up.
struct Clusters<'a, const D: usize> {
    domain: &'a Domain<D>,
    all: Numbered<Cluster<D>>,
    buckets: Buckets<D>,
}

impl<const D: usize> Clusters<'_, D> {
    /// Counts a vote for the nearest cluster of its class, or for a new one.
    fn vote(&mut self, missed: &MissedElement<D>, meter: &mut Meter<'_>) -> Result<()> {
        let MissedElement { element, class, place, near } = *missed;
        let mut best = (near, None);
        let looked = self.buckets.near(place, near, |c| {
            let cluster = &self.all[c];
            let distance = self.domain.offset(cluster.centre, place).norm();
            if cluster.class == class && distance < best.0 {
                best = (distance, Some(c));
            }
        });
        if let Some(c) = best.1 {
            let cluster = &mut self.all[c];
            cluster.shift += self.domain.offset(cluster.centre, place);
            cluster.votes.push(element);
        } else {
            let number = self.all.push(Cluster { class, centre: place, shift: Vector::ZERO, votes: vec![element] });
            self.buckets.insert(number, place);
        }
        meter.spend(LOOK * looked)
    }
}

/// What was placed just now, quick to look up.
struct JustPlaced<'a, const D: usize> {
    domain: &'a Domain<D>,
    all: Vec<(Vector<D>, u32)>,
    buckets: Buckets<D>,
}

impl<const D: usize> JustPlaced<'_, D> {
    fn push(&mut self, place: Vector<D>, class: u32) {
        self.buckets.insert(self.all.len() as u32, self.domain.wrap(place));
        self.all.push((place, class));
    }

    /// Whether `keeps(class, offset)` holds for everything within `radius`.
    fn all_keep(
        &self,
        p: Vector<D>,
        radius: f64,
        meter: &mut Meter<'_>,
        keeps: impl Fn(u32, Vector<D>) -> bool,
    ) -> Result<bool> {
        let mut clear = true;
        let looked = self.buckets.near(self.domain.wrap(p), radius, |n| {
            let (q, class) = self.all[n as usize];
            clear &= keeps(class, self.domain.offset(p, q));
        });
        meter.spend(LOOK * looked)?;
        Ok(clear)
    }
}

/// The elements to add.
fn wanted<const D: usize>(state: &State<'_, D>, targets: &Numbered<f64>, budget: &Budget) -> Result<Vec<Item<D>>> {
    let mut meter = budget.meter();
    let clusters = clusters(state, &mut meter)?;
    let mut counts = class_counts(state);
    let accept = |cluster: &Cluster<D>| {
        let mut meter = budget.meter();
        let n = cluster.votes.len() as f64;
        let position = cluster.centre + cluster.shift * (1.0 / n);
        let class = cluster.class;
        // Fewer than there should be: half the votes will do when a fifth is wanting.
        let share = ((counts[class] / targets[class].max(1.0) - 0.8) * 2.5 + 0.5).clamp(0.5, 1.0);
        if n < HALF * share * covering(state, position, &mut meter)? {
            return Ok(None);
        }
        Ok(Some((n, position, source(state, &cluster.votes, &mut meter)?)))
    };
    let accepted: Vec<Option<_>> = clusters.par_iter().with_min_len(8).map(accept).collect::<Result<_>>()?;
    budget.spend(0)?;
    let mut accepted: Vec<_> = accepted.into_iter().flatten().collect();
    // The surest first, so that of two that collide the better one stays.
    accepted.sort_by(|a, b| b.0.total_cmp(&a.0));
    let reach = state.library.spacing * state.extent.largest_spacing_scale;
    let buckets = Buckets::new(state.domain(), state.extent.margin, reach);
    let mut placed = JustPlaced { domain: state.domain(), all: Vec::new(), buckets };
    let mut new = Vec::new();
    for (_, position, source) in accepted {
        let Some(source) = source else { continue };
        let class = state.library.class[source];
        if counts[class] >= MAX_SURPLUS * targets[class] {
            continue;
        }
        if state.extent.admits(source, position)
            && is_clear(state, class, position, &placed, &mut meter)?
            && has_own_room(state, source, position, &placed, &mut meter)?
        {
            new.push(Item { source, position, frozen: None });
            placed.push(position, class);
            counts[class] += 1.0;
        }
    }
    Ok(new)
}

/// Whether a new curve sample at `p` would keep the distance that its source keeps to whatever is nearest; elements
/// have their classes for that.
fn has_own_room<const D: usize>(
    state: &State<'_, D>,
    source: u32,
    p: Vector<D>,
    placed: &JustPlaced<'_, D>,
    meter: &mut Meter<'_>,
) -> Result<bool> {
    if source < state.level.base {
        return Ok(true);
    }
    let scale = state.request.fields.frame(p).spacing_scale;
    let room = OWN_ROOM * state.library.nearest[source] * scale;
    let mut clear = placed.all_keep(p, room, meter, |_, offset| offset.norm() >= room)?;
    meter.spend(LOOK * state.within(p, room, |_, _| clear = false))?;
    Ok(clear)
}

/// Whether a new element of `class` at `p` would keep its distance from the living and from those just `placed`.
fn is_clear<const D: usize>(
    state: &State<'_, D>,
    class: u32,
    p: Vector<D>,
    placed: &JustPlaced<'_, D>,
    meter: &mut Meter<'_>,
) -> Result<bool> {
    let scale = ROOM * state.request.fields.frame(p).spacing_scale;
    let keeps = |other: u32, offset: Vector<D>| offset.norm() >= scale * state.library.closest(class, other);
    let reach = scale * state.library.widest(class);
    let mut clear = placed.all_keep(p, reach, meter, keeps)?;
    // Samples stand for their elements here: the centres of long elements lie between them.
    let looked = state.within(p, reach, |s, offset| {
        let live = state.item_of(s);
        let offset = if live.count == 1 { offset } else { state.domain().offset(p, live.item.position) };
        clear &= keeps(state.library.class[live.item.source], offset);
    });
    meter.spend(LOOK * looked)?;
    Ok(clear)
}

/// Elements that are missed, grouped by class and place [Tu 2020 appendix A]: each joins the nearest group, or begins
/// one. How many of the neighbourhoods around a group want an element there is its confidence.
fn clusters<const D: usize>(state: &State<'_, D>, meter: &mut Meter<'_>) -> Result<Numbered<Cluster<D>>> {
    let reach = state.library.spacing * state.extent.largest_spacing_scale;
    let buckets = Buckets::new(state.domain(), state.extent.margin, reach);
    let mut clusters = Clusters { domain: state.domain(), all: Numbered::new(), buckets };
    for &s in state.living() {
        missed_by(state, s).try_for_each(|missed| clusters.vote(&missed, meter))?;
    }
    Ok(clusters.all)
}

/// The elements that the neighbourhood of a sample misses, where they should be by its match.
fn missed_by<'a, const D: usize>(
    state: &'a State<'_, D>,
    s: u32,
) -> impl Iterator<Item = MissedElement<D>> + use<'a, D> {
    let sample = state.sample(s);
    let (level, library) = (state.level, state.library);
    let frame = state.request.fields.frame(sample.position);
    sample.matched.iter().flat_map(move |matched| {
        let origin = level.position[matched.input];
        // The samples of an element come together: the first speaks for all.
        let firsts = matched.missing.iter().filter(|&&i| level.part[i] == 0);
        firsts.map(move |&i| {
            let element = level.element[i];
            let place = sample.position + frame.to_output(library.centre[element] - origin);
            let class = library.class[element];
            let near = 0.5 * library.outlier[class] * frame.spacing_scale;
            MissedElement { element, class, place: state.domain().wrap(place), near }
        })
    })
}

/// Number of neighbourhoods that reach `p`, their rim not counted in full: a sample misses what is near more surely
/// than what is far.
fn covering<const D: usize>(state: &State<'_, D>, p: Vector<D>, meter: &mut Meter<'_>) -> Result<f64> {
    let radius = state.level.radius * state.request.fields.frame(p).spacing_scale;
    let mut n = 0.0;
    let looked = state.within(p, radius, |s, _| {
        n += f64::from(u8::from(state.sample(s).matched.is_some()));
    });
    meter.spend(LOOK * looked)?;
    Ok(n)
}

/// The copyable element with the smallest sum of attribute distances to the votes.
fn source<const D: usize>(state: &State<'_, D>, votes: &[u32], meter: &mut Meter<'_>) -> Result<Option<u32>> {
    let spread = |e: u32| -> f32 { votes.iter().map(|&v| state.library.differences.of(e, v)).sum() };
    let mut asked: Vec<u32> = votes.iter().copied().filter(|&e| state.library.copyable[e]).collect();
    asked.sort_unstable();
    asked.dedup();
    meter.spend(LOOK * (asked.len() * votes.len()) as u64)?;
    Ok(asked.into_iter().map(|e| (spread(e), e)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|b| b.1))
}
