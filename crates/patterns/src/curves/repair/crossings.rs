//! Edges that cross, or leave a sample side by side, as those of the exemplar never do.
//!
//! Such edges come from neighbourhoods that were matched with parts of the exemplar a little out of step: each of them
//! is right for itself. Of two that cross, one goes; of two side by side, the longer one becomes a continuation of the
//! shorter one, which keeps the line it belongs to in one piece.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Vector};

use crate::{
    curves::votes::edge_votes::Votes,
    exemplar::graph::net::{MAX_EDGE, Net},
    output::state::State,
};

/// Two edges leave a sample side by side when they enclose less than this share of the sharpest angle of the exemplar.
const SIDE_BY_SIDE: f64 = 0.6;

/// No angle above this one is narrow, degrees.
const NARROW: f64 = 35.0;

/// Nanoseconds for two edges that are compared.
const PAIR: u64 = 12;

/// Most rounds in which edges are taken apart: each may leave another fault beside it.
const ROUNDS: usize = 8;

/// How the edges of a net lie to each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeRules {
    /// Cosine of the smallest angle that two edges of a sample enclose.
    max_cosine: f64,
    /// Whether edges never cross. In space they pass each other.
    is_planar: bool,
}

impl EdgeRules {
    /// Looks at the edges of a net.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn of<const D: usize>(net: &Net<D>, budget: &Budget) -> Result<Self> {
        let max_cosine = (SIDE_BY_SIDE * sharpest_angle(net, budget)?).cos();
        Ok(Self { max_cosine, is_planar: D == 2 && !has_crossings(net, budget)? })
    }

    /// Takes edges apart until they keep to the rules. Returns how many changed.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop; then some are apart.
    pub(crate) fn restore<const D: usize>(&self, state: &mut State<'_, D>, votes: &Votes) -> Result<usize> {
        let mut changed = 0;
        for _ in 0..ROUNDS {
            let now = self.uncross(state, votes)? + self.straighten(state)?;
            changed += now;
            if now == 0 {
                break;
            }
        }
        Ok(changed)
    }

    /// Whether an edge from `a` to `b` would keep to the rules.
    pub(crate) fn allow<const D: usize>(&self, state: &State<'_, D>, a: u32, b: u32) -> bool {
        let across = state.offset(a, b);
        let is_free = |s: u32, way: Vector<D>| {
            state.links_of(s).iter().all(|&o| state.offset(s, o).cosine(way) <= self.max_cosine)
        };
        is_free(a, across) && is_free(b, across * -1.0) && (!self.is_planar || !self.crosses_any(state, a, across, b))
    }

    /// Whether an edge crosses one that is there.
    fn crosses_any<const D: usize>(&self, state: &State<'_, D>, a: u32, across: Vector<D>, b: u32) -> bool {
        let Some(net) = &state.level.net else { return false };
        let middle = state.sample(a).position + across * 0.5;
        let reach = 0.5 * across.norm() + MAX_EDGE * net.spacing * state.extent.largest_spacing_scale;
        let mut found = false;
        state.within(middle, reach, |c, offset| {
            if found || c == a || c == b {
                return;
            }
            for &d in state.links_of(c).iter().filter(|&&d| d != a && d != b) {
                let way = state.offset(c, d);
                found |= cross(across, way, offset + way * 0.5);
            }
        });
        found
    }

    /// Of two edges that leave a sample side by side, the longer one starts where the shorter one ends.
    fn straighten<const D: usize>(&self, state: &mut State<'_, D>) -> Result<usize> {
        let budget = state.budget.stage("mending strokes");
        let mut meter = budget.meter();
        let mut changed = 0;
        for n in 0..state.living().len() {
            let s = state.living()[n];
            meter.spend(PAIR * (1 + state.degree(s) * state.degree(s)) as u64)?;
            while let Some((near, far)) = self.side_by_side(state, s) {
                meter.spend(PAIR * (state.degree(s) * state.degree(s)) as u64)?;
                state.unlink(s, far);
                if !state.are_linked(near, far) && state.share_style(near, far) {
                    state.link(near, far);
                }
                changed += 1;
            }
        }
        Ok(changed)
    }

    /// The ends of two edges of `s` side by side, the farther one of an edge that may change.
    fn side_by_side<const D: usize>(&self, state: &State<'_, D>, s: u32) -> Option<(u32, u32)> {
        let links = state.links_of(s);
        for (i, &a) in links.iter().enumerate() {
            for &b in &links[..i] {
                let (to_a, to_b) = (state.offset(s, a), state.offset(s, b));
                let (near, far) = if to_a.norm2() <= to_b.norm2() { (a, b) } else { (b, a) };
                let is_fixed = state.is_frozen_edge(s, far);
                if !is_fixed && to_a.cosine(to_b) > self.max_cosine {
                    return Some((near, far));
                }
            }
        }
        None
    }

    /// Of two edges that cross, the one goes that fewer neighbourhoods want.
    fn uncross<const D: usize>(&self, state: &mut State<'_, D>, votes: &Votes) -> Result<usize> {
        if !self.is_planar {
            return Ok(0);
        }
        let budget = state.budget.stage("mending strokes");
        budget.spend(4 * PAIR * state.living().len() as u64)?;
        let mut meter = budget.meter();
        let edges: Vec<(u32, u32)> = state
            .living()
            .iter()
            .flat_map(|&a| state.links_of(a).iter().map(move |&b| (a, b)))
            .filter(|(a, b)| a < b)
            .collect();
        let ways: Vec<_> = edges.iter().map(|&(a, b)| state.offset(a, b)).collect();
        let middle =
            |(&(a, _), way): (&(u32, u32), &Vector<D>)| state.domain().wrap(state.sample(a).position + *way * 0.5);
        let middles: Vec<_> = edges.iter().zip(&ways).map(middle).collect();
        let longest = ways.iter().map(|w| w.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let index = GridIndex::new(&middles, longest, state.domain());
        let mut gone = vec![false; edges.len()];
        for (i, &(a, b)) in edges.iter().enumerate() {
            let looked = index.within(middles[i], longest, |j, offset| {
                let (c, d) = edges[j];
                let apart = ![c, d].contains(&a) && ![c, d].contains(&b);
                if j > i && apart && !gone[i] && !gone[j] && cross(ways[i], ways[j], offset) {
                    gone[weaker(state, votes, &edges, [i, j])] = true;
                }
            });
            meter.spend(PAIR * looked)?;
        }
        let crossing = edges.into_iter().zip(gone).filter(|(_, gone)| *gone);
        Ok(crossing.map(|((a, b), _)| state.unlink(a, b)).count())
    }
}

/// The sharpest angle that two edges of a node enclose; what is not narrow counts as barely so.
fn sharpest_angle<const D: usize>(net: &Net<D>, budget: &Budget) -> Result<f64> {
    let mut meter = budget.meter();
    let mut sharpest = NARROW.to_radians() / SIDE_BY_SIDE;
    for node in &net.nodes {
        let ways: Vec<_> = node.arms.iter().map(|arm| net.nodes[arm.to].position - node.position).collect();
        for (i, a) in ways.iter().enumerate() {
            meter.spend(PAIR * i as u64)?;
            let angles = ways[..i].iter().map(|b| a.cosine(*b).acos());
            sharpest = angles.fold(sharpest, f64::min);
        }
    }
    Ok(sharpest)
}

/// Whether edges cross between their nodes, taken as straight.
fn has_crossings<const D: usize>(net: &Net<D>, budget: &Budget) -> Result<bool> {
    let mut meter = budget.meter();
    let place = |n: u32| net.nodes[n].position;
    let arms = net.nodes.iter().zip(0..).flat_map(|(node, n)| node.arms.iter().map(move |arm| (n, arm.to)));
    let edges: Vec<(u32, u32)> = arms.filter(|(a, b)| a < b).collect();
    let ways: Vec<_> = edges.iter().map(|&(a, b)| place(b) - place(a)).collect();
    let middles: Vec<_> = edges.iter().map(|&(a, b)| (place(a) + place(b)) * 0.5).collect();
    let longest = ways.iter().map(|w| w.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let index = GridIndex::new(&middles, longest, &Domain::Box(Bounds::around(middles.iter().copied())));
    let mut found = false;
    for (i, &(a, b)) in edges.iter().enumerate() {
        let looked = index.within(middles[i], longest, |j, offset| {
            let (c, d) = edges[j];
            found |= j > i && ![c, d].contains(&a) && ![c, d].contains(&b) && cross(ways[i], ways[j], offset);
        });
        meter.spend(PAIR * looked)?;
    }
    Ok(found)
}

/// The weaker of two edges: one that may change, then the less wanted, then the longer one.
fn weaker<const D: usize>(state: &State<'_, D>, votes: &Votes, edges: &[(u32, u32)], [i, j]: [usize; 2]) -> usize {
    let key = |k: usize| {
        let (a, b) = edges[k];
        let is_fixed = state.is_frozen_edge(a, b);
        let found = votes.candidates.binary_search_by_key(&(a, b), |c| c.ends);
        let wanted = found.map_or(0.0, |c| votes.candidates[c].confidence);
        (is_fixed, wanted, -state.offset(a, b).norm())
    };
    let (x, y) = (key(i), key(j));
    let order = x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)).then(x.2.total_cmp(&y.2));
    if order.is_le() { i } else { j }
}

/// Whether two edges in the plane cross; `between`: from the middle of the first one to that of the second one.
fn cross<const D: usize>(first: Vector<D>, second: Vector<D>, between: Vector<D>) -> bool {
    let side = |way: Vector<D>, p: Vector<D>| way[0] * p[1] - way[1] * p[0];
    let parts = |way: Vector<D>, p: Vector<D>, q: Vector<D>| side(way, p) * side(way, q) < 0.0;
    let (half, other) = (first * 0.5, second * 0.5);
    parts(first, between - other, between + other) && parts(second, half * -1.0 - between, half - between)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_cross_when_each_parts_the_other() {
        let (across, up) = (Vector::xy(2.0, 0.0), Vector::xy(0.0, 2.0));
        assert!(cross(across, up, Vector::xy(0.5, 0.5)));
        assert!(!cross(across, up, Vector::xy(1.5, 0.0)));
        assert!(!cross(across, up, Vector::xy(0.0, 1.5)));
        assert!(!cross(across, across, Vector::xy(0.0, 0.5)));
    }
}
