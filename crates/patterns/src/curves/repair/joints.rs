//! False ends are joined: to what is near, across a gap, or to the stroke ahead.

use arabesque_core::{
    GridIndex, Result,
    pairing::{Wish, pair_up},
};

use crate::{
    curves::repair::mend::{EXPECTED, PAIR, Repair, SAMPLE},
    output::state::State,
};

/// How far an end looks for something to join, in sampling distances.
const REACH: f64 = 1.7;

/// Widest gap that two ends bridge when they face each other, in sampling distances.
const SPAN: f64 = 5.0;

/// They face each other when the line between them turns by less than this from either: cosine of 25 degrees.
pub(crate) const FACING: f64 = 0.9;

/// What a false end is taken on to lies ahead of it: cosine of 70 degrees.
const AHEAD: f64 = 0.34;

/// Cost of a joint that makes a new junction, in sampling distances.
const NEW_JUNCTION: f64 = 0.6;

/// Cost of a joint at a right angle to the end's direction, in sampling distances.
const ANGLE: f64 = 0.8;

impl<const D: usize> Repair<'_, D> {
    /// Joins false ends to samples near them. Returns how many.
    pub(crate) fn join_near(&self, state: &mut State<'_, D>) -> Result<usize> {
        let ends = self.false_ends(state)?;
        let mut meter = self.budget.meter();
        let mut wishes = Vec::new();
        for &s in &ends {
            let (found, looked) = self.partners(state, s);
            meter.spend(PAIR * looked + self.price_of_links(found.len()))?;
            wishes.extend(found);
        }
        Ok(pair_up(wishes, state.samples().len(), |a, b| self.link(state, a, b)))
    }

    /// What it will take to try so many joints.
    fn price_of_links(&self, count: usize) -> u64 {
        20 * SAMPLE * count as u64
    }

    /// Joins false ends that face each other across a gap. Returns how many.
    pub(crate) fn bridge(&self, state: &mut State<'_, D>) -> Result<usize> {
        let ends = self.false_ends(state)?;
        let mut meter = self.budget.meter();
        let places: Vec<_> = ends.iter().map(|&s| state.sample(s).position).collect();
        let ways: Vec<_> = ends.iter().map(|&s| state.offset(state.links_of(s)[0], s).unit_or_zero()).collect();
        let unit = self.net.spacing * state.extent.largest_spacing_scale;
        let index = GridIndex::new(&places, SPAN * unit, state.domain());
        let mut wishes = Vec::new();
        for (i, &s) in ends.iter().enumerate() {
            let known = wishes.len();
            let looked = index.within(places[i], SPAN * unit, |j, offset| {
                let across = offset.unit_or_zero();
                let (out, back) = (ways[i].dot(across), -ways[j].dot(across));
                let is_new = !state.is_frozen_edge(s, ends[j]);
                if j > i && is_new && out > FACING && back > FACING && state.share_style(s, ends[j]) {
                    wishes.push(Wish { cost: offset.norm() / unit + ANGLE * (2.0 - out - back), a: i, b: j });
                }
            });
            meter.spend(PAIR * looked + self.price_of_links(wishes.len() - known))?;
        }
        Ok(pair_up(wishes, ends.len(), |i, j| self.link(state, ends[i], ends[j])))
    }

    /// Joins two samples unless the exemplar never shows the like. Returns whether it did.
    fn link(&self, state: &mut State<'_, D>, a: u32, b: u32) -> bool {
        let is_good = self.rules.allow(state, a, b) && !self.dangles.forbid(state, a, b);
        if is_good {
            state.link(a, b);
        }
        is_good
    }

    /// Takes false ends on to the nearest stroke ahead, where strokes branch anyway. Returns how many.
    pub(crate) fn extend(&self, state: &mut State<'_, D>) -> Result<usize> {
        let mut joined = 0;
        let mut meter = self.budget.meter();
        for s in self.false_ends(state)? {
            // An earlier one may have been joined to this.
            let &[before] = state.links_of(s) else { continue };
            let (ahead, looked) = self.ahead(state, before, s);
            meter.spend(PAIR * looked + self.price_of_links(ahead.len()))?;
            if let Some(&(_, o)) = ahead.iter().find(|(_, o)| self.rules.allow(state, s, *o)) {
                state.link(s, o);
                joined += 1;
            }
        }
        Ok(joined)
    }

    /// Samples ahead of the end `s`, which is joined to `before`; those first that are near and straight on. Also
    /// how many were looked at.
    fn ahead(&self, state: &State<'_, D>, before: u32, s: u32) -> (Vec<(f64, u32)>, u64) {
        let position = state.sample(s).position;
        let unit = self.net.spacing * state.request.fields.frame(position).spacing_scale;
        let way = state.offset(before, s).unit_or_zero();
        let mut ahead = Vec::new();
        let looked = state.within(position, SPAN * unit, |o, offset| {
            let cosine = way.dot(offset.unit_or_zero());
            let cost = offset.norm() * (2.0 - cosine);
            let is_own = o == s || o == before || state.are_linked(before, o);
            let may_take_one = (1..=2).contains(&state.degree(o));
            if !is_own && !state.is_frozen_edge(s, o) && cosine > AHEAD && may_take_one && state.share_style(o, s) {
                ahead.push((cost, o));
            }
        });
        ahead.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        (ahead, looked)
    }

    /// What the end `s` could be joined to, with the cost in sampling distances, and how many samples were looked at.
    fn partners(&self, state: &State<'_, D>, s: u32) -> (Vec<Wish<u32>>, u64) {
        let position = state.sample(s).position;
        let unit = self.net.spacing * state.request.fields.frame(position).spacing_scale;
        let Some(&before) = state.links_of(s).first() else { return (Vec::new(), 0) };
        let way = state.offset(before, s).unit_or_zero();
        let branches = self.net.branches();
        // What is too long would only grow with another end of a stroke.
        let takes_ends = self.expected(state, s) > EXPECTED || !self.dangles.has_single();
        let mut found = Vec::new();
        let looked = state.within(position, REACH * unit, |o, offset| {
            let is_near = o == s || o == before || state.are_linked(before, o);
            if is_near || state.is_frozen_edge(s, o) || !state.share_style(o, s) {
                return;
            }
            let degree = state.degree(o);
            if degree == 0 || (degree == 1 && !takes_ends) {
                return;
            }
            let wants = self.expected(state, o) - degree as f64 > 0.4;
            let turn = 1.0 - way.dot(offset.unit_or_zero());
            let cost = offset.norm() / unit + ANGLE * turn + if wants { 0.0 } else { NEW_JUNCTION };
            let is_crowded = degree >= 4 || (!wants && (degree >= 3 || (degree == 2 && !branches)));
            if cost <= REACH && !is_crowded {
                found.push(Wish { cost, a: s, b: o });
            }
        });
        (found, looked)
    }
}
