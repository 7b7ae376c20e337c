//! Edge assignment: which samples are joined [Tu 2020 §4.3.4, eqs 17 to 22].

use arabesque_core::{GridIndex, Vector};

use super::votes::{self, Votes};
use crate::state::State;

/// No edge is longer than this many sampling distances.
pub(crate) const LONGEST: f64 = 2.2;

/// Two items copied from neighbouring nodes are joined when they lie this near to where the exemplar has them, in sampling distances.
const NEAR: f64 = 0.45;

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

/// Joins samples without edges to those that were copied from the neighbours of their source in the exemplar.
pub(crate) fn link_sources<const D: usize>(state: &mut State<'_, D>) {
    let level = state.level;
    let Some(net) = &level.net else { return };
    let fresh: Vec<u32> =
        state.living.iter().copied().filter(|&s| state.links[s as usize].is_empty() && !state.is_frozen(s)).collect();
    let mut found: Vec<(u32, u32)> = Vec::new();
    for &s in &fresh {
        let sample = &state.samples[s as usize];
        let Some(node) = level.node_of(level.first[state.source(s) as usize]) else { continue };
        let frame = state.request.fields.frame(sample.position);
        for arm in &net.nodes[node as usize].arms {
            let offset = net.nodes[arm.to as usize].position - net.nodes[node as usize].position;
            let place = sample.position + frame.to_output(offset);
            if let Some(o) = copied_from(state, arm.to, place, (NEAR * net.spacing * frame.spacing_scale, &state.index))
            {
                found.push((s.min(o), s.max(o)));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    for (a, b) in found {
        state.links[a as usize].push(b);
        state.links[b as usize].push(a);
    }
}

/// The sample nearest to `place` whose source is `node`.
fn copied_from<const D: usize>(
    state: &State<'_, D>,
    node: u32,
    place: Vector<D>,
    (near, index): (f64, &GridIndex<D>),
) -> Option<u32> {
    let mut best = (near, None);
    index.within(state.domain().wrap(place), near, |slot, offset| {
        let o = state.living[slot];
        let is_copy = state.level.node_of(state.level.first[state.source(o) as usize]) == Some(node);
        if is_copy && offset.norm() < best.0 {
            best = (offset.norm(), Some(o));
        }
    });
    best.1
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
