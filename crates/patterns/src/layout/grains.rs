//! Regrowth: an output in disorder keeps its largest coherent region, a grain as in a crystal, and everything else is
//! laid out anew around it.
//!
//! Search and assignment only look as far as a neighbourhood. From a start in disorder, many parts of the pattern come
//! into order at the same time, each a grain out of step with the next, and no local step undoes the borders between
//! them: the limit that [Ma 2011 §6] and [Tu 2020 §6] both name. What undoes them in a crystal is growth from one
//! nucleus. So where a level ends in small grains, the best of them stays and the layout grows on from it. Frozen
//! samples are such a nucleus already; then no grain is kept.

use arabesque_core::Numbered;

use crate::output::{
    draft::{Draft, Items},
    state::State,
};

/// Samples above this energy belong to no grain.
const IN_ORDER: f64 = 0.5;

/// A grain that holds fewer than this share of the samples of a mean neighbourhood is not larger than chance makes it.
const LARGE: f64 = 0.7;

/// The output is in disorder when less than this share of its samples is in large grains.
const ORDERED: f64 = 0.5;

/// What an output in disorder keeps, `None` for one in order.
pub(crate) fn nucleus<const D: usize>(state: &State<'_, D>) -> Option<Draft<D>> {
    let matched = state.living().iter().filter_map(|&s| state.sample(s).matched.as_ref());
    let members: usize = matched.map(|m| m.members.len() + 1).sum();
    let large = LARGE * members as f64 / state.living().len().max(1) as f64;
    let grains = grains(state);
    let ordered: usize = grains.iter().map(Vec::len).filter(|&n| n as f64 >= large).sum();
    if ordered as f64 >= ORDERED * state.living().len() as f64 {
        return None;
    }
    let is_drawn = state.items().iter().any(|live| live.item.frozen.is_some());
    let largest = grains.iter().filter(|_| !is_drawn).max_by_key(|grain| (grain.len(), std::cmp::Reverse(grain[0])));
    Some(Draft { items: largest.map_or_else(Vec::new, |grain| whole_items(state, grain)), links: Vec::new() })
}

/// Samples in groups that are each one coherent copy of the exemplar: neighbours whose matches correspond to one
/// another.
fn grains<const D: usize>(state: &State<'_, D>) -> Vec<Vec<u32>> {
    let in_order = |s: u32| state.sample(s).matched.as_ref().filter(|m| m.energy() < IN_ORDER);
    let mut seen = Numbered::filled(false, state.samples().len());
    let mut grains = Vec::new();
    for &start in state.living() {
        if seen[start] || in_order(start).is_none() {
            continue;
        }
        seen[start] = true;
        let mut grain = vec![start];
        let mut next = 0;
        while let Some(&s) = grain.get(next) {
            next += 1;
            for &(o, i) in in_order(s).map_or(&[][..], |m| &m.pairs) {
                if !seen[o] && in_order(o).is_some_and(|m| m.input == i) {
                    seen[o] = true;
                    grain.push(o);
                }
            }
        }
        grains.push(grain);
    }
    grains
}

/// The items all of whose samples are in a grain.
fn whole_items<const D: usize>(state: &State<'_, D>, grain: &[u32]) -> Items<D> {
    let mut held = Numbered::filled(0, state.items().len());
    grain.iter().for_each(|&s| held[state.sample(s).item] += 1);
    let whole = state.items().iter().zip(held).filter(|(live, held)| live.alive && live.count == *held);
    whole.map(|(live, _)| (live.item, live.turn)).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Budget, Domain, Exemplar, Matrix, Request, Stage, Stream, Vector};

    use super::*;
    use crate::{
        border::Extent,
        exemplar::level_exemplar::level_exemplars,
        optimise::{
            matching::Prices,
            search::{SearchParams, search},
        },
        output::draft::Item,
        params::{Deform, Matching, Params, Search},
    };

    /// Side of the exemplar, a net of 12 by 12 dots that are each a little off.
    const SIDE: f64 = 120.0;

    fn exemplar() -> Exemplar<2> {
        let mut random = Stream::new(5, Stage::TEST, 0);
        let mut off = || random.range(3.0, 7.0);
        let dots = (0..144).map(|k| Vector::xy(f64::from(k % 12) * 10.0 + off(), f64::from(k / 12) * 10.0 + off()));
        Exemplar::from_points("t", &dots.collect::<Vec<_>>(), &[0; 144], &["dot".into()]).unwrap()
    }

    /// The nucleus of the exemplar's dots with those beyond `x` moved to random places.
    fn nucleus_with_disorder_beyond(x: f64) -> Option<Vec<Item<2>>> {
        let exemplar = exemplar();
        let params = Params { levels: 1, ..Params::default() };
        let sampled = level_exemplars(&std::sync::Arc::new(exemplar.clone()), None, &params, &Budget::default());
        let sampled = sampled.unwrap().remove(0);
        let request = Request::new(Domain::Box(exemplar.window));
        let extent = Extent::new(&request, &sampled.exemplar, &sampled.library, sampled.level.base).unwrap();
        let mut random = Stream::new(6, Stage::TEST, 0);
        let items = exemplar.elements.iter().zip(0..).map(|(element, source)| {
            let place = Vector::xy(random.range(x, SIDE), random.range(0.0, SIDE));
            let position = if element.centre[0] < x { element.centre } else { place };
            (Item { source, position, frozen: None }, Matrix::identity())
        });
        let draft = Draft { items: items.collect(), links: Vec::new() };
        let mut state = State::new(&sampled, &request, &extent, Deform::Rigid, &draft);
        let exhaustive = SearchParams {
            search: Search::Exhaustive,
            matching: Matching::Robust,
            prices: Prices { missing: 0.35, outside: 0.35 },
            coherence: 0,
            random: 0,
            thorough: true,
            rounds: 1,
            step: 0,
        };
        search(&mut state, &exhaustive).unwrap();
        nucleus(&state).map(|draft| draft.items.into_iter().map(|(item, _)| item).collect())
    }

    #[test]
    fn what_is_in_order_needs_no_nucleus() {
        assert!(nucleus_with_disorder_beyond(SIDE).is_none());
    }

    #[test]
    fn a_border_of_disorder_is_left_to_the_iterations() {
        assert!(nucleus_with_disorder_beyond(0.75 * SIDE).is_none());
    }

    #[test]
    fn the_part_in_order_is_the_nucleus() {
        let kept = nucleus_with_disorder_beyond(0.4 * SIDE).unwrap();
        assert!(kept.len() >= 30, "{}", kept.len());
        let exemplar = exemplar();
        let stayed = kept.iter().filter(|i| i.position == exemplar.elements[i.source as usize].centre).count();
        assert!(stayed >= kept.len() - 2, "{stayed} of {}", kept.len());
    }

    #[test]
    fn disorder_everywhere_leaves_a_small_nucleus() {
        let kept = nucleus_with_disorder_beyond(0.0).unwrap();
        assert!(kept.len() < 20, "{}", kept.len());
    }
}
