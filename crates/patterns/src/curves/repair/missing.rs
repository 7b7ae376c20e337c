//! Samples that are missing are put in: junctions that several strokes reach for, and what lies beyond the border.

use arabesque_core::{GridIndex, Matrix, Result, Vector};

use crate::{
    curves::{
        repair::{
            joints::FACING,
            mend::{PAIR, Repair, SAMPLE},
        },
        votes::edges::{OpenArm, open_arms},
    },
    output::{draft::Item, state::State},
};

/// Edges that end within this many sampling distances of one another want the same sample.
const SAME_PLACE: f64 = 0.5;

/// Missing edges that end at one place.
struct Gathering<const D: usize> {
    /// Indices of the missing edges.
    arms: Vec<usize>,
    /// The mean of where they end.
    place: Vector<D>,
}

impl<const D: usize> Repair<'_, D> {
    /// Takes strokes over the border where their sources go on beyond it, so that they are cut there rather than end
    /// before it. Returns how many.
    pub(crate) fn reach_border(&self, state: &mut State<'_, D>) -> Result<usize> {
        self.budget.spend(3 * SAMPLE * state.living().len() as u64)?;
        let is_inside = |s: u32| !state.is_frozen(s) && state.domain().contains(state.sample(s).position);
        let inside = state.living().iter().filter(|&&s| is_inside(s));
        let is_beyond = |arm: &OpenArm<D>| {
            let is_out = !state.domain().contains(arm.place) || state.extent.is_blocked(arm.place, 0.0);
            is_out && !state.extent.is_known(arm.place)
        };
        let new: Vec<_> = inside.flat_map(|&s| open_arms(state, self.net, s)).filter(is_beyond).collect();
        for arm in &new {
            let sample = put_in(state, arm.node, arm.place);
            state.link(sample, arm.sample);
        }
        Ok(new.len())
    }

    /// Puts back samples that several strokes reach for: where the missing edges of three or more samples end at one
    /// place, or two run into each other, and nothing is there. Returns how many.
    ///
    /// Existence assignment [Tu 2020 §4.3.4] adds a sample when most neighbourhoods miss it; a junction is only missed
    /// by those few that lie around it, and each of its strokes ends as if nothing were wanting.
    pub(crate) fn put_back_junctions(&self, state: &mut State<'_, D>) -> Result<usize> {
        self.budget.spend(3 * SAMPLE * state.living().len() as u64)?;
        let mut meter = self.budget.meter();
        let wanted = |arm: &OpenArm<D>| state.domain().contains(arm.place) && !state.extent.is_blocked(arm.place, 0.0);
        let living = state.living().iter();
        let open: Vec<_> = living.flat_map(|&s| open_arms(state, self.net, s)).filter(wanted).collect();
        let unit = self.net.spacing * state.extent.smallest_spacing_scale;
        let places: Vec<_> = open.iter().map(|arm| state.domain().wrap(arm.place)).collect();
        let index = GridIndex::new(&places, unit, state.domain());
        let mut used = vec![false; open.len()];
        let mut restored = 0;
        for i in 0..open.len() {
            let mut arms: Vec<usize> = Vec::new();
            let looked = index.within(places[i], SAME_PLACE * unit, |j, _| {
                let is_new = arms.iter().all(|&g| open[g].sample != open[j].sample);
                if !used[j] && is_new && self.share_style(open[i].node, open[j].node) {
                    arms.push(j);
                }
            });
            meter.spend(PAIR * looked * (1 + arms.len() as u64))?;
            arms.sort_unstable();
            let gathering = gathered(state, &places, i, arms);
            let is_asked_for = gathering.arms.len() >= 3 || is_gap(state, &open, &gathering.arms);
            if used[i] || !is_asked_for || self.is_taken(state, open[i].node, gathering.place) {
                continue;
            }
            let Some(node) = self.best_node(&open, &gathering.arms) else { continue };
            let sample = put_in(state, node, gathering.place);
            for j in gathering.arms {
                used[j] = true;
                state.link(sample, open[j].sample);
            }
            restored += 1;
        }
        if restored > 0 {
            state.reindex();
        }
        Ok(restored)
    }

    /// Of the nodes that the missing edges end at, the one with as many edges as there are strokes reaching for it.
    fn best_node(&self, open: &[OpenArm<D>], arms: &[usize]) -> Option<u32> {
        let misfit = |j: usize| self.net.degree(open[j].node).abs_diff(arms.len());
        arms.iter().copied().min_by_key(|&j| (misfit(j), j)).map(|j| open[j].node)
    }

    /// Whether something that could be `node` lies at `place` already.
    fn is_taken(&self, state: &State<'_, D>, node: u32, place: Vector<D>) -> bool {
        let mut taken = false;
        let room = SAME_PLACE * self.net.spacing * state.request.fields.frame(place).spacing_scale;
        state.within(place, room, |s, _| {
            taken |= state.node(s).is_some_and(|other| self.share_style(other, node));
        });
        taken
    }

    fn share_style(&self, a: u32, b: u32) -> bool {
        self.net.nodes[a].shares_style(&self.net.nodes[b])
    }
}

/// Adds a sample that was copied from a node. Returns its number.
fn put_in<const D: usize>(state: &mut State<'_, D>, node: u32, position: Vector<D>) -> u32 {
    state.push(Item { source: state.level.base + node, position, frozen: None }, Matrix::identity())
}

/// Missing edges around the end of the one with number `i`.
fn gathered<const D: usize>(state: &State<'_, D>, places: &[Vector<D>], i: usize, arms: Vec<usize>) -> Gathering<D> {
    let shift = arms.iter().fold(Vector::ZERO, |sum, &j| sum + state.domain().offset(places[i], places[j]));
    let place = state.domain().wrap(places[i] + shift * (1.0 / arms.len().max(1) as f64));
    Gathering { arms, place }
}

/// Whether two edges run into each other from opposite sides.
fn is_gap<const D: usize>(state: &State<'_, D>, open: &[OpenArm<D>], arms: &[usize]) -> bool {
    let way = |j: usize| {
        let arm = &open[j];
        (state.domain().offset(state.sample(arm.sample).position, arm.place)).unit_or_zero()
    };
    matches!(arms, [i, j] if way(*i).dot(way(*j)) < -FACING)
}
