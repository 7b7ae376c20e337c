//! Loose ends: how long a stroke may hang free before the exemplar would not show it.

use arabesque_core::Vector;

use super::{net::Net, skeleton::Knot};
use crate::state::State;

/// How much longer than the longest of the exemplar a free stretch may be.
const SLACK: f64 = 1.3;

/// Samples that are followed at most.
const FAR: usize = 1000;

/// Longest free stretches of the exemplar.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Loose {
    /// From a free end to a junction.
    hanging: f64,
    /// From a free end to a free end.
    single: f64,
}

impl Loose {
    /// Measures the free ends of a net.
    pub(crate) fn of<const D: usize>(net: &Net<D>) -> Self {
        let mut loose = Self::default();
        for (n, node) in net.nodes.iter().enumerate().filter(|(_, node)| node.knot == Some(Knot::End)) {
            let Some(first) = node.arms.first() else { continue };
            let next = |from: u32, at: u32| {
                let arms = &net.nodes[at as usize].arms;
                if arms.len() == 2 { arms.iter().map(|a| a.to).find(|to| *to != from) } else { None }
            };
            let place = |k: u32| net.nodes[k as usize].position;
            let (end, length) = follow((n as u32, first.to), &next, &|a, b| (place(b) - place(a)).norm());
            match net.nodes[end as usize].knot {
                Some(Knot::End) => loose.single = loose.single.max(length),
                Some(Knot::Cut) => {}
                _ => loose.hanging = loose.hanging.max(length),
            }
        }
        loose
    }

    /// Whether the exemplar has strokes with two free ends.
    pub(crate) fn has_single(&self) -> bool {
        self.single > 0.0
    }

    /// Whether the free end `s` hangs farther than the exemplar's do.
    pub(crate) fn is_too_long<const D: usize>(&self, state: &State<'_, D>, s: u32) -> bool {
        let Some(&first) = state.links[s as usize].first() else { return false };
        let next = |from: u32, at: u32| {
            let links = &state.links[at as usize];
            if links.len() == 2 { links.iter().copied().find(|to| *to != from) } else { None }
        };
        let (end, length) = follow((s, first), &next, &|a, b| state.reach(a, b));
        let is_single = state.links[end as usize].len() == 1;
        // Where the other end lies beyond the border, how long it is there nobody sees.
        let position: Vector<D> = state.samples[end as usize].position;
        if is_single && !state.domain().contains(position) {
            return length > SLACK * self.single.max(self.hanging);
        }
        length > SLACK * if is_single { self.single } else { self.hanging }
    }
}

/// The end of the path that begins with two neighbours, and its length.
fn follow(
    (mut from, mut at): (u32, u32),
    next: &dyn Fn(u32, u32) -> Option<u32>,
    step: &dyn Fn(u32, u32) -> f64,
) -> (u32, f64) {
    let (start, mut length) = (from, step(from, at));
    for _ in 0..FAR {
        match next(from, at).filter(|to| *to != start) {
            Some(to) => {
                length += step(at, to);
                (from, at) = (at, to);
            }
            None => break,
        }
    }
    (at, length)
}
