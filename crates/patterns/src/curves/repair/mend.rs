//! Clean-up: ends that the exemplar would not show are joined to what they just miss, or trimmed.
//!
//! Edge assignment [Tu 2020 §4.3.4] decides edge by edge, so that a few strokes always stop short of their neighbours:
//! the dangling components that the paper names among its limits [Tu 2020 §5]. What an end should look like is measured
//! on the exemplar: [`Dangles`] says how long a stroke may hang free there, [`EdgeRules`] how its edges lie to each
//! other, and the votes how many edges each sample should have. The order matters:
//!
//! 1. crossings are undone and missing junctions put back, since both make ends that look false;
//! 2. false ends are joined to what is near, a few times over, for a joint makes other ends false or right;
//! 3. those that face each other across a wider gap are bridged, and strokes that go on beyond the border are taken
//!    over it;
//! 4. in nets, what still ends goes on to the nearest stroke ahead, as a T junction;
//! 5. what is left and only a single edge long is taken away.

use crate::{
    curves::{
        repair::{crossings::EdgeRules, dangles::Dangles},
        votes::edge_votes::Votes,
    },
    exemplar::graph::net::Net,
    output::state::State,
};

/// An end is out of place when this many edges are expected at it.
pub(crate) const EXPECTED: f64 = 1.5;

/// How far beyond the border of the domain a frozen stroke may end that goes on inside, in sampling distances.
const AT_BORDER: f64 = 0.3;

/// Rounds in which false ends are joined.
const ROUNDS: usize = 3;

/// What mending goes by.
pub(crate) struct Repair<'a, const D: usize> {
    pub(crate) net: &'a Net<D>,
    pub(crate) votes: &'a Votes,
    pub(crate) dangles: Dangles,
    pub(crate) rules: EdgeRules,
}

/// Joins and trims. Returns how many samples changed.
pub(crate) fn mend<const D: usize>(state: &mut State<'_, D>, votes: &Votes) -> usize {
    let level = state.level;
    let Some(net) = &level.net else { return 0 };
    let repair = Repair { net, votes, dangles: Dangles::of(net), rules: EdgeRules::of(net) };
    let mut changed = repair.rules.restore(state, votes) + repair.put_back_junctions(state);
    for _ in 0..ROUNDS {
        let joined = repair.join_near(state);
        changed += joined;
        if joined == 0 {
            break;
        }
    }
    changed += repair.bridge(state) + repair.reach_border(state);
    if net.branches() {
        changed += repair.extend(state);
    }
    changed += repair.rules.restore(state, votes);
    changed + repair.trim(state)
}

impl<const D: usize> Repair<'_, D> {
    /// Number of edges that a sample should have.
    pub(crate) fn expected(&self, state: &State<'_, D>, s: u32) -> f64 {
        // Of a frozen sample its own strokes tell more than its neighbours.
        let told = self.votes.degree(s).filter(|_| !state.is_frozen(s));
        told.unwrap_or_else(|| state.node(s).map_or(0.0, |e| self.net.degree(e) as f64))
    }

    /// Whether a stroke ends at `s` that should go on. Beyond the border of the domain anything may end.
    fn is_false_end(&self, state: &State<'_, D>, s: u32) -> bool {
        let p = state.sample(s).position;
        let room = if state.is_frozen(s) { -AT_BORDER * self.net.spacing } else { 0.0 };
        state.node(s).is_some()
            && state.degree(s) == 1
            && state.domain().signed_distance(p) > room
            && (self.expected(state, s) > EXPECTED || (!state.is_frozen(s) && self.dangles.is_too_long(state, s)))
    }

    /// The false ends of a state.
    pub(crate) fn false_ends(&self, state: &State<'_, D>) -> Vec<u32> {
        state.living().iter().copied().filter(|&s| self.is_false_end(state, s)).collect()
    }

    /// Takes away false ends that are a single edge long, and samples without any edge.
    fn trim(&self, state: &mut State<'_, D>) -> usize {
        let is_stub = |s: u32| {
            let ended = self.is_false_end(state, s);
            ended && state.links_of(s).first().is_some_and(|&o| state.degree(o) != 2)
        };
        let is_alone = |s: u32| state.node(s).is_some() && state.degree(s) == 0;
        let is_gone = |&s: &u32| !state.is_frozen(s) && (is_alone(s) || is_stub(s));
        let gone: Vec<u32> = state.living().iter().copied().filter(is_gone).collect();
        for &s in &gone {
            state.kill(s);
        }
        gone.len()
    }
}
