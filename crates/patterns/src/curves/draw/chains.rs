//! Which edges make one stroke [Tu 2020 §4.4.2, fig. 11].

use std::collections::BTreeMap;

use arabesque_core::{
    Numbered, Result, Vector,
    pairing::{self, Wish},
};

use crate::{
    curves::votes::edge_votes::Votes,
    exemplar::graph::{
        net::{Net, Piece},
        skeleton::Knot,
    },
    output::state::State,
};

/// Two directions are opposite when the cosine of their angle is below this: 143 degrees.
const OPPOSITE: f64 = -0.8;

/// Two ends that meet make one stroke when the cosine of their angle is below this: 120 degrees.
const BENT: f64 = -0.5;

/// How much a well supported piece is preferred to a better fitting one, as a share of the squared length of the edge.
const SUPPORT: f64 = 0.1;

/// Nanoseconds for a sample of a stroke, and for two of its edges that are compared.
const PRICE: (u64, u64) = (300, 80);

/// A run of samples along one stroke.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub(crate) samples: Vec<u32>,
    /// The exemplar line of each edge, from the sample of the same number to the next; `None` where nobody voted.
    pub(crate) pieces: Vec<Option<Piece>>,
    /// Whether the last sample is joined to the first; there are as many pieces as samples then, else one less.
    pub(crate) is_closed: bool,
}

/// Chains all edges but those among frozen samples.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn chains<const D: usize>(state: &State<'_, D>, votes: &Votes, by_tangents: bool) -> Result<Vec<Chain>> {
    let Some(net) = &state.level.net else { return Ok(Vec::new()) };
    let budget = state.budget.stage("drawing strokes");
    let mut meter = budget.meter();
    for s in state.samples().numbers() {
        // Crowded samples are compared edge by edge.
        meter.spend(PRICE.0 + PRICE.1 * (state.degree(s) * state.degree(s)) as u64)?;
    }
    let next = (0..state.samples().len() as u32).map(|s| continuations(state, s, by_tangents)).collect::<Numbered<_>>();
    let onwards = |from: u32, at: u32| next[at].get(&from).copied().filter(|&to| !is_fixed(state, at, to));
    let mut seen: BTreeMap<(u32, u32), ()> = BTreeMap::new();
    let mut chains = Vec::new();
    for s in 0..state.samples().len() as u32 {
        for &o in state.links_of(s).iter().filter(|&&o| o > s) {
            if is_fixed(state, s, o) || seen.contains_key(&(s, o)) {
                continue;
            }
            let (samples, is_closed) = walk(s, o, &onwards);
            meter.spend(PRICE.0 * samples.len() as u64)?;
            let around = if is_closed { samples.first().copied() } else { None };
            let ends: Vec<u32> = samples.iter().copied().chain(around).collect();
            ends.windows(2).for_each(|w| {
                seen.insert((w[0].min(w[1]), w[0].max(w[1])), ());
            });
            let pieces = ends.windows(2).map(|w| piece(state, net, votes, [w[0], w[1]])).collect();
            chains.push(Chain { samples, pieces, is_closed });
        }
    }
    Ok(chains)
}

fn is_fixed<const D: usize>(state: &State<'_, D>, a: u32, b: u32) -> bool {
    state.is_frozen_edge(a, b)
}

/// The stroke through the edge from `a` to `b`, as far as it goes both ways, and whether it closes.
fn walk(a: u32, b: u32, onwards: &dyn Fn(u32, u32) -> Option<u32>) -> (Vec<u32>, bool) {
    let mut samples = vec![a, b];
    let (mut from, mut at) = (a, b);
    while let Some(to) = onwards(from, at) {
        if (at, to) == (a, b) {
            samples.pop();
            return (samples, true);
        }
        samples.push(to);
        (from, at) = (at, to);
    }
    let mut before = Vec::new();
    (from, at) = (b, a);
    while let Some(to) = onwards(from, at) {
        before.push(to);
        (from, at) = (at, to);
    }
    before.reverse();
    before.extend(samples);
    (before, false)
}

/// Through sample `s`: coming from one neighbour, which one is next.
fn continuations<const D: usize>(state: &State<'_, D>, s: u32, by_tangents: bool) -> BTreeMap<u32, u32> {
    let links = state.links_of(s);
    let mut next = BTreeMap::new();
    let mut through = |a: u32, b: u32| {
        next.insert(a, b);
        next.insert(b, a);
    };
    let ways: Vec<Vector<D>> = links.iter().map(|&o| state.offset(s, o).unit_or_zero()).collect();
    if let [a, b] = links[..] {
        if ways[0].dot(ways[1]) < BENT || !is_meeting(state, s) {
            through(a, b);
        }
        return next;
    }
    let mut free = vec![true; links.len()];
    if by_tangents {
        for (i, j) in as_in_exemplar(state, s, &ways) {
            through(links[i], links[j]);
            (free[i], free[j]) = (false, false);
        }
    }
    let tangents = state.tangents_of(s);
    let directions = if by_tangents && tangents.len() >= ways.len() { matched(&ways, tangents) } else { ways };
    for (i, j) in opposite(&directions).into_iter().filter(|&(i, j)| free[i] && free[j]) {
        through(links[i], links[j]);
    }
    next
}

/// Pairs of edges that are one stroke at the source of a sample, where it has as many arms.
fn as_in_exemplar<const D: usize>(state: &State<'_, D>, s: u32, ways: &[Vector<D>]) -> Vec<(usize, usize)> {
    let node = state.node(s).zip(state.level.net.as_ref()).map(|(e, net)| &net.nodes[e]);
    let Some(node) = node.filter(|node| node.arms.len() == ways.len()) else { return Vec::new() };
    let frame = state.request.fields.frame(state.sample(s).position);
    let arms: Vec<Vector<D>> = node.arms.iter().map(|arm| frame.rotation.apply(arm.tangent)).collect();
    let arm_of = assigned(ways, &arms);
    let way_of = |arm: usize| arm_of.iter().position(|a| *a == Some(arm));
    let pairs = (0..arms.len()).filter_map(|k| node.onwards(k).filter(|&j| j > k).map(|j| (way_of(k), way_of(j))));
    pairs.filter_map(|(i, j)| Some((i?, j?))).collect()
}

/// Whether the source of a sample is a place where two strokes end.
fn is_meeting<const D: usize>(state: &State<'_, D>, s: u32) -> bool {
    let node = state.node(s).zip(state.level.net.as_ref()).map(|(e, net)| &net.nodes[e]);
    node.is_some_and(|node| node.knot == Some(Knot::Junction) && node.arms.len() == 2)
}

/// Pairs of opposite directions, the most opposite first.
fn opposite<const D: usize>(directions: &[Vector<D>]) -> Vec<(usize, usize)> {
    let n = directions.len();
    let all = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    let wishes = all.map(|(a, b)| Wish { cost: directions[a].dot(directions[b]), a, b }).filter(|w| w.cost < OPPOSITE);
    let mut found = Vec::new();
    pairing::pair_up(wishes.collect(), n, |i, j| {
        found.push((i, j));
        true
    });
    found
}

/// For every edge direction the tangent that is matched with it; itself where none is left.
fn matched<const D: usize>(ways: &[Vector<D>], tangents: &[Vector<D>]) -> Vec<Vector<D>> {
    assigned(ways, tangents).into_iter().zip(ways).map(|(t, way)| t.map_or(*way, |t| tangents[t])).collect()
}

/// For every edge direction the number of the tangent that is matched with it, the best pairs first.
fn assigned<const D: usize>(ways: &[Vector<D>], tangents: &[Vector<D>]) -> Vec<Option<usize>> {
    pairing::pair_sides(ways.len(), tangents.len(), |w, t| ways[w].dot(tangents[t]))
}

/// The exemplar line for an edge: of those voted for, the one whose ends lie best; else the one between the sources of
/// its ends.
fn piece<const D: usize>(state: &State<'_, D>, net: &Net<D>, votes: &Votes, [a, b]: [u32; 2]) -> Option<Piece> {
    let key = (a.min(b), a.max(b));
    let directed = |p: Piece| if a < b { p } else { p.reversed() };
    let offset = state.offset(key.0, key.1);
    let frame = state.request.fields.frame(state.sample(key.0).position);
    let misfit = |p: &Piece| (frame.to_output(net.span(*p)) - offset).norm2() / offset.norm2().max(f64::MIN_POSITIVE);
    if let Ok(c) = votes.candidates.binary_search_by_key(&key, |c| c.ends) {
        let candidate = &votes.candidates[c];
        let all: f64 = candidate.pieces.iter().map(|p| p.1).sum();
        let cost = |(p, weight): &(Piece, f64)| misfit(p) - SUPPORT * weight / all;
        let best = candidate.pieces.iter().min_by(|x, y| cost(x).total_cmp(&cost(y)));
        return best.map(|(p, _)| directed(*p));
    }
    let node = |s: u32| state.level.node_of(state.level.first[state.source(s)]);
    let (from, to) = (node(key.0)?, node(key.1)?);
    let arm = net.nodes[from].arms.iter().find(|arm| arm.to == to)?;
    Some(directed(arm.piece))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_is_two_strokes() {
        let d = [(1.0, 0.0), (0.1, 0.99), (-1.0, 0.05), (0.0, -1.0)].map(|(x, y)| Vector::xy(x, y).unit_or_zero());
        assert_eq!(opposite(&d), vec![(0, 2), (1, 3)]);
    }

    #[test]
    fn a_star_of_three_is_three_ends() {
        let d = [0.0_f64, 2.1, 4.2].map(|a| Vector::xy(a.cos(), a.sin()));
        assert!(opposite(&d).is_empty());
    }

    #[test]
    fn a_ring_closes_and_a_path_does_not() {
        let ring = |from: u32, at: u32| if (at + 1) % 4 == from { Some((at + 3) % 4) } else { Some((at + 1) % 4) };
        assert_eq!(walk(0, 1, &ring), (vec![0, 1, 2, 3], true));
        let path = |from: u32, at: u32| if at > from { (at < 3).then_some(at + 1) } else { at.checked_sub(1) };
        assert_eq!(walk(1, 2, &path), (vec![0, 1, 2, 3], false));
    }
}
