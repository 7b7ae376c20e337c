//! Edge assignment: which samples are joined [Tu 2020 §4.3.4, eqs 17 to 22].

use arabesque_core::{GridIndex, Vector};

use rayon::prelude::*;

use super::{
    net::Net,
    votes::{self, Votes},
};
use crate::state::State;

/// No edge is longer than this many sampling distances.
pub(crate) const LONGEST: f64 = 2.2;

/// Two samples are joined when each lies this near to where the exemplar has the other, in sampling distances.
const NEAR: f64 = 0.7;

/// Joins samples as the matched neighbourhoods vote. Returns the votes and how many samples changed their edges.
pub(crate) fn assign<const D: usize>(state: &mut State<'_, D>) -> (Votes, usize) {
    let level = state.level;
    let Some(net) = &level.net else {
        return (Votes { candidates: Vec::new(), degree: Vec::new() }, 0);
    };
    let votes = votes::collect(state, net);
    let mut links = frozen_links(state);
    let order = falling(&votes);
    for c in order {
        let candidate = &votes.candidates[c];
        let (a, b) = candidate.ends;
        if links[a as usize].contains(&b) || (state.is_frozen(a) && state.is_frozen(b)) {
            continue;
        }
        let gain =
            gain(candidate.confidence, [a, b].map(|s| links[s as usize].len() as f64 - votes.degree[s as usize]));
        if gain < 0.0 {
            links[a as usize].push(b);
            links[b as usize].push(a);
        }
    }
    let mut changed = 0;
    for (s, mut new) in links.into_iter().enumerate() {
        new.sort_unstable();
        if new != state.links[s] {
            changed += 1;
            state.samples[s].dirty = true;
            state.links[s] = new;
        }
    }
    (votes, changed)
}

/// Candidates by falling confidence.
fn falling(votes: &Votes) -> Vec<usize> {
    let mut order: Vec<usize> = (0..votes.candidates.len()).collect();
    let key = |c: usize| &votes.candidates[c];
    order.sort_by(|&a, &b| key(b).confidence.total_cmp(&key(a).confidence).then(key(a).ends.cmp(&key(b).ends)));
    order
}

/// Change of the objective when an edge is switched on: its confidence, and at both ends the degree as it is less the degree expected
/// [Tu 2020 eq. 22].
fn gain(confidence: f64, surplus: [f64; 2]) -> f64 {
    let degree: f64 = surplus.iter().map(|s| if s.is_finite() { 2.0 * s + 1.0 } else { 0.0 }).sum();
    1.0 - 2.0 * confidence + degree
}

/// The edges of frozen samples among themselves, which never change.
fn frozen_links<const D: usize>(state: &State<'_, D>) -> Vec<Vec<u32>> {
    let both = |s: usize, o: u32| state.is_frozen(s as u32) && state.is_frozen(o);
    state.links.iter().enumerate().map(|(s, l)| l.iter().copied().filter(|&o| both(s, o)).collect()).collect()
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

/// Joins samples as their sources in the exemplar are: wherever one misses an edge and another one lies where that edge should end, and misses
/// one as well.
pub(crate) fn link_sources<const D: usize>(state: &mut State<'_, D>) {
    let Some(net) = &state.level.net else { return };
    let open: Vec<OpenArm<D>> = state.living.par_iter().flat_map_iter(|&s| open_arms(state, net, s)).collect();
    let places: Vec<_> = open.iter().map(|arm| state.domain().wrap(arm.place)).collect();
    let unit = net.spacing * state.extent.largest_spacing_scale;
    let index = GridIndex::new(&places, unit, state.domain());
    let mut wishes: Vec<(f64, usize, usize)> = Vec::new();
    for (i, arm) in open.iter().enumerate() {
        let p = state.samples[arm.sample as usize].position;
        let near = NEAR * net.spacing * state.request.fields.frame(p).spacing_scale;
        // The other arm wants to end here, and this one there.
        index.within(p, near, |j, offset| {
            let other = &open[j];
            let back = state.domain().offset(state.samples[other.sample as usize].position, arm.place).norm();
            if other.sample != arm.sample && back <= near && state.share_style(other.sample, arm.sample) {
                wishes.push((back + offset.norm(), i.min(j), i.max(j)));
            }
        });
    }
    wishes.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut used = vec![false; open.len()];
    for (_, i, j) in wishes {
        let (a, b) = (open[i].sample, open[j].sample);
        let is_fixed = state.is_frozen(a) && state.is_frozen(b);
        if used[i] || used[j] || is_fixed || state.links[a as usize].contains(&b) {
            continue;
        }
        (used[i], used[j]) = (true, true);
        state.links[a as usize].push(b);
        state.links[b as usize].push(a);
    }
}

/// The edges that the source of `s` has, but for those that `s` has too.
pub(crate) fn open_arms<const D: usize>(state: &State<'_, D>, net: &Net<D>, s: u32) -> Vec<OpenArm<D>> {
    let Some(number) = state.node(s) else { return Vec::new() };
    let position = state.samples[s as usize].position;
    let frame = state.request.fields.frame(position);
    let node = &net.nodes[number as usize];
    let inner = node.arms.iter().map(|arm| (net.nodes[arm.to as usize].position - node.position, arm.to));
    let cut = node.beyond.iter().map(|t| (*t * net.spacing, number));
    let mut arms: Vec<(Vector<D>, u32)> = inner.chain(cut).map(|(v, to)| (frame.to_output(v), to)).collect();
    for &o in &state.links[s as usize] {
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
    use super::*;

    /// The greedy choice on small cases against all choices.
    #[test]
    fn switching_on_follows_the_objective() {
        let objective = |on: &[bool; 3], confidence: &[f64; 3], expected: &[f64; 3]| {
            let ends = [(0, 1), (1, 2), (0, 2)];
            let mut degree = [0.0; 3];
            let mut sum = 0.0;
            for k in 0..3 {
                let x = f64::from(u8::from(on[k]));
                sum += (x - confidence[k]).powi(2);
                degree[ends[k].0] += x;
                degree[ends[k].1] += x;
            }
            sum + degree.iter().zip(expected).map(|(d, e)| (d - e) * (d - e)).sum::<f64>()
        };
        let (confidence, expected) = ([0.9, 0.8, 0.2], [1.0, 2.0, 1.0]);
        let before = objective(&[true, false, false], &confidence, &expected);
        let after = objective(&[true, true, false], &confidence, &expected);
        let told = gain(confidence[1], [1.0 - expected[1], 0.0 - expected[2]]);
        assert!((after - before - told).abs() < 1e-12 && told < 0.0);
        assert!(gain(confidence[2], [0.0, 0.0]) > 0.0);
    }
}
