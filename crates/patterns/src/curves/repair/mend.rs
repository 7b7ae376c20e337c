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

use arabesque_core::{Budget, Result};

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

/// Nanoseconds for a sample that is looked at for each round.
pub(crate) const SAMPLE: u64 = 100;

/// The same for a sample, edge or end that is compared with another one.
pub(crate) const PAIR: u64 = 12;

/// What mending goes by.
pub(crate) struct Repair<'a, const D: usize> {
    pub(crate) budget: Budget,
    pub(crate) net: &'a Net<D>,
    pub(crate) votes: &'a Votes,
    pub(crate) dangles: Dangles,
    pub(crate) rules: EdgeRules,
}

/// Joins and trims. Returns how many samples changed.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then some of it is done.
pub(crate) fn mend<const D: usize>(state: &mut State<'_, D>, votes: &Votes) -> Result<usize> {
    let level = state.level;
    let Some(net) = &level.net else { return Ok(0) };
    let budget = state.budget.stage("mending strokes");
    budget.spend(SAMPLE * net.nodes.len() as u64)?;
    let rules = EdgeRules::of(net, &budget)?;
    let repair = Repair { net, votes, dangles: Dangles::of(net), rules, budget };
    let mut changed = repair.rules.restore(state, votes)? + repair.put_back_junctions(state)?;
    for _ in 0..ROUNDS {
        let joined = repair.join_near(state)?;
        changed += joined;
        if joined == 0 {
            break;
        }
    }
    changed += repair.bridge(state)? + repair.reach_border(state)?;
    if net.branches() {
        changed += repair.extend(state)?;
    }
    changed += repair.rules.restore(state, votes)?;
    Ok(changed + repair.trim(state)?)
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
    pub(crate) fn false_ends(&self, state: &State<'_, D>) -> Result<Vec<u32>> {
        let mut meter = self.budget.meter();
        let mut ends = Vec::new();
        for &s in state.living() {
            // An end is followed along its stroke, from sample to sample.
            meter.spend(if state.degree(s) == 1 { 20 * SAMPLE } else { SAMPLE / 4 })?;
            if self.is_false_end(state, s) {
                ends.push(s);
            }
        }
        Ok(ends)
    }

    /// Takes away false ends that are a single edge long, and samples without any edge.
    fn trim(&self, state: &mut State<'_, D>) -> Result<usize> {
        self.budget.spend(SAMPLE * state.living().len() as u64)?;
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
        Ok(gone.len())
    }
}
