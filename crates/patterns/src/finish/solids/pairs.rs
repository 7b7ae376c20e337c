//! Which bodies lie too deep in one another, found out again only where something may have changed.
//!
//! Two that are apart stay so until both together have gone as far as that, and two that have not moved overlap as they did.

use arabesque_core::{GridIndex, Vector};
use rayon::prelude::*;

use super::{
    contact::{Contact, Pair, meeting},
    things::Things,
};

/// Work for a pair of which all is known.
const KNOWN: u64 = 10;

/// What a body has to do with another one in which it lies too deep.
pub(super) struct Overlap<const D: usize> {
    pub(super) body: usize,
    pub(super) contact: Contact<D>,
    /// How much too deep it lies, and how much of that is its own to make up.
    pub(super) over: f64,
    pub(super) amount: f64,
}

impl<const D: usize> Things<'_, D> {
    /// Looks for pairs where anything may have changed. Tells who has to be pushed, since it or something around it has moved, and what it
    /// cost.
    pub(super) fn look(&mut self, index: &GridIndex<D>) -> (Vec<bool>, u64) {
        let count = self.bodies.len();
        if self.pairs.len() != count {
            self.pairs = vec![Vec::new(); count];
        }
        let found: Vec<_> = (0..count).into_par_iter().map(|i| self.met_by(i, index)).collect();
        let mut cost = 0;
        for (own, (list, looked)) in self.pairs.iter_mut().zip(found) {
            cost += looked;
            *own = list;
        }
        let mut is_awake = self.moved.clone();
        for (i, own) in self.pairs.iter().enumerate() {
            for (j, _) in own {
                let j = *j as usize;
                is_awake[i] |= self.moved[j];
                is_awake[j] |= self.moved[i];
            }
        }
        (is_awake, cost)
    }

    /// The pairs of one body with those of higher numbers.
    fn met_by(&self, i: usize, index: &GridIndex<D>) -> (Vec<(u32, Pair<D>)>, u64) {
        let body = &self.bodies[i];
        let mut known = self.pairs[i].iter().copied().peekable();
        let mut cost = 100;
        let mut found = Vec::new();
        for (j, offset) in self.around(index, body, |j| j > i) {
            while known.next_if(|(k, _)| (*k as usize) < j).is_some() {}
            let before = known.next_if(|(k, _)| *k as usize == j).map(|(_, pair)| pair);
            let gone = self.gone[i] + self.gone[j];
            cost += KNOWN;
            let pair = match before {
                Some(Pair::Apart(until)) if gone < until => Pair::Apart(until),
                Some(pair) if !self.moved[i] && !self.moved[j] => pair,
                _ => {
                    let (pair, looked) = self.compared(i, (j, offset));
                    cost += looked;
                    pair
                }
            };
            found.push((j as u32, pair));
        }
        (found, cost)
    }

    /// How two bodies lie to one another now.
    fn compared(&self, i: usize, (j, offset): (usize, Vector<D>)) -> (Pair<D>, u64) {
        let found = meeting(&self.bodies[i], &self.bodies[j], offset);
        let allowed = self.allowed.of(self.class(i), self.class(j));
        let gone = self.gone[i] + self.gone[j];
        let pair = match found.contact {
            Some(contact) if contact.depth > allowed => Pair::Over(contact, contact.depth - allowed),
            // How deep they lie in one another changes by no more than they go.
            Some(contact) => Pair::Apart(gone + allowed - contact.depth),
            None => Pair::Apart(gone + allowed + found.gap),
        };
        (pair, found.cost)
    }

    /// The overlaps that are too deep, each once for either of its bodies.
    pub(super) fn overlaps(&self) -> Vec<Overlap<D>> {
        let domain = &self.extent.request().domain;
        let is_frozen = |i: usize| self.placements[i].frozen.is_some();
        let mut all = Vec::new();
        for (i, own) in self.pairs.iter().enumerate() {
            for (j, pair) in own {
                let (j, Pair::Over(contact, over)) = (*j as usize, pair) else { continue };
                let (a, b) = (self.bodies[i].centre, self.bodies[j].centre);
                // Around the back of a torus the place is elsewhere for the other one.
                let around = b - (a + domain.offset(a, b));
                let share = |other: usize| if is_frozen(other) { *over } else { 0.5 * over };
                let seen = Contact { at: contact.at + around, way: -contact.way, ..*contact };
                all.push(Overlap { body: i, contact: *contact, over: *over, amount: share(j) });
                all.push(Overlap { body: j, contact: seen, over: *over, amount: share(i) });
            }
        }
        all
    }
}
