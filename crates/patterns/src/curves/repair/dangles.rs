//! Dangles ends: how long a stroke may hang free before the exemplar would not show it.

use arabesque_core::Vector;

use crate::{
    exemplar::graph::{
        net::{Net, Node},
        skeleton::Knot,
    },
    output::state::State,
};

/// How much longer than the longest of the exemplar a free stretch may be.
const SLACK: f64 = 1.3;

/// Samples that are followed at most.
const MAX_STEPS: usize = 1000;

/// Longest free stretches of the exemplar.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dangles {
    /// From a free end to a junction.
    hanging: f64,
    /// From a free end to a free end.
    single: f64,
    /// From any end to any end; infinite where strokes branch or close.
    whole: f64,
}

impl Dangles {
    /// Measures the free ends of a net.
    pub(crate) fn of<const D: usize>(net: &Net<D>) -> Self {
        let mut dangles = Self::default();
        let next = |from: u32, at: u32| {
            let arms = &net.nodes[at].arms;
            if arms.len() == 2 { arms.iter().map(|a| a.to).find(|to| *to != from) } else { None }
        };
        let place = |k: u32| net.nodes[k].position;
        let step = |a: u32, b: u32| (place(b) - place(a)).norm();
        let ends = (0..).zip(&net.nodes).filter(|(_, node)| node.arms.len() == 1);
        for (n, node) in ends {
            let (end, length) = follow([n, node.arms[0].to], &next, &step);
            dangles.whole = dangles.whole.max(length);
            match (node.knot, net.nodes[end].knot) {
                (Some(Knot::End), Some(Knot::End)) => dangles.single = dangles.single.max(length),
                (Some(Knot::End), other) if other != Some(Knot::Cut) => dangles.hanging = dangles.hanging.max(length),
                _ => {}
            }
        }
        if net.branches() || net.nodes.iter().any(|node| node.arms.len() > 2) || has_loop(net) {
            dangles.whole = f64::INFINITY;
        }
        dangles
    }

    /// Whether two free ends would make a stroke that is longer than the exemplar has any.
    pub(crate) fn forbid<const D: usize>(&self, state: &State<'_, D>, a: u32, b: u32) -> bool {
        let (ends, lengths): (Vec<u32>, Vec<f64>) = [a, b].iter().filter_map(|&s| run(state, s)).unzip();
        let is_free = |s: &u32| state.degree(*s) == 1 && state.domain().contains(state.sample(*s).position);
        let is_closing = ends.first() == Some(&b);
        ends.len() == 2
            && !is_closing
            && ends.iter().all(is_free)
            && lengths.iter().sum::<f64>() + state.reach(a, b) > SLACK * self.whole
    }

    /// Whether the exemplar has strokes with two free ends.
    pub(crate) fn has_single(&self) -> bool {
        self.single > 0.0
    }

    /// Whether the free end `s` hangs farther than the exemplar's do.
    pub(crate) fn is_too_long<const D: usize>(&self, state: &State<'_, D>, s: u32) -> bool {
        let Some((end, length)) = run(state, s) else { return false };
        let is_single = state.degree(end) == 1;
        // Where the other end lies beyond the border, how long it is there nobody sees.
        let position: Vector<D> = state.sample(end).position;
        if is_single && !state.domain().contains(position) {
            return length > SLACK * self.single.max(self.hanging);
        }
        length > SLACK * if is_single { self.single } else { self.hanging }
    }
}

/// The other end of the stroke that ends at `s`, and its length; `None` where no stroke ends.
fn run<const D: usize>(state: &State<'_, D>, s: u32) -> Option<(u32, f64)> {
    let &[first] = state.links_of(s) else { return None };
    let next = |from: u32, at: u32| {
        let links = state.links_of(at);
        if links.len() == 2 { links.iter().copied().find(|to| *to != from) } else { None }
    };
    Some(follow([s, first], &next, &|a, b| state.reach(a, b)))
}

/// Whether a stroke of a net without branches closes: it has as many edges as nodes, and every other has one less.
fn has_loop<const D: usize>(net: &Net<D>) -> bool {
    let is_open = |node: &&Node<D>| node.arms.len() < 2;
    let alone = net.nodes.iter().filter(|node| node.arms.is_empty()).count();
    let strokes = (net.nodes.iter().filter(is_open).count() - alone) / 2 + alone;
    let edges = net.nodes.iter().map(|node| node.arms.len()).sum::<usize>() / 2;
    edges + strokes > net.nodes.len()
}

/// The end of the path that begins with two neighbours, and its length.
fn follow(
    [mut from, mut at]: [u32; 2],
    next: &dyn Fn(u32, u32) -> Option<u32>,
    step: &dyn Fn(u32, u32) -> f64,
) -> (u32, f64) {
    let (start, mut length) = (from, step(from, at));
    for _ in 0..MAX_STEPS {
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
