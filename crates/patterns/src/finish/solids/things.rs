//! The elements of the output as solids.

use arabesque_core::{Budget, Exemplar, GridIndex, Numbered, Placement, Result, Similarity, Vector};
use rayon::prelude::*;

use super::contact::{Allowed, Body, Pair, contact};
use crate::{border::Extent, exemplar::library::Library};

/// An overlap deeper than allowed by this share of the inner radius is too deep to stay.
const TOO_DEEP: f64 = 0.2;

/// One that is deeper by this share is the first to go where there are too many.
const WORSE: f64 = 0.06;

/// The output while it is mended.
pub(super) struct Things<'a, const D: usize> {
    pub(super) exemplar: &'a Exemplar<D>,
    pub(super) library: &'a Library<D>,
    pub(super) extent: &'a Extent<'a, D>,
    pub(super) allowed: &'a Allowed,
    pub(super) placements: Vec<Placement<D>>,
    pub(super) bodies: Vec<Body<'a, D>>,
    /// Whether each has moved since those around it looked.
    pub(super) moved: Vec<bool>,
    /// How far the places of each have gone at most, in sum, and how far that may be before it has to look for the border again.
    pub(super) gone: Vec<f64>,
    pub(super) inside: Vec<f64>,
    /// What is known of each with those of higher numbers around it, by these numbers; nothing once numbers change.
    pub(super) pairs: Vec<Vec<(u32, Pair<D>)>>,
    /// Largest radius of a body of the exemplar at the largest scale.
    pub(super) widest: f64,
}

impl<'a, const D: usize> Things<'a, D> {
    pub(super) fn new(
        placements: &[Placement<D>],
        exemplar: &'a Exemplar<D>,
        library: &'a Library<D>,
        extent: &'a Extent<'a, D>,
        allowed: &'a Allowed,
    ) -> Self {
        let mut things = Self {
            exemplar,
            library,
            extent,
            allowed,
            placements: placements.to_vec(),
            bodies: Vec::new(),
            moved: vec![true; placements.len()],
            gone: vec![0.0; placements.len()],
            inside: vec![0.0; placements.len()],
            pairs: Vec::new(),
            widest: 0.0,
        };
        let bodies: Vec<_> = placements.iter().map(|p| things.body(p.source, &p.transform)).collect();
        let own = exemplar.elements.iter().zip(&exemplar.solids).map(|(e, s)| s.radius() * e.pose.scale);
        let scale = extent.request().fields.scale.range().1;
        things.widest = own.fold(0.0, f64::max) * scale;
        things.bodies = bodies;
        things
    }

    pub(super) fn into_placements(self) -> Vec<Placement<D>> {
        self.placements
    }

    /// An element of the exemplar as it lies after `transform`.
    pub(super) fn body(&self, source: usize, transform: &Similarity<D>) -> Body<'a, D> {
        Body::new(&self.exemplar.solids[source], transform.after(&self.exemplar.elements[source].pose))
    }

    pub(super) fn class(&self, i: usize) -> u32 {
        self.library.class[self.placements[i].source as u32]
    }

    pub(super) fn index(&self) -> GridIndex<D> {
        let centres: Vec<_> = self.bodies.iter().map(|b| b.centre).collect();
        GridIndex::new(&centres, self.widest.max(1e-9), &self.extent.request().domain)
    }

    /// The bodies that may touch one, of those with numbers that are `asked` for, with the way to each.
    pub(super) fn around(
        &self,
        index: &GridIndex<D>,
        body: &Body<'_, D>,
        asked: impl Fn(usize) -> bool,
    ) -> Vec<(usize, Vector<D>)> {
        let mut near = Vec::new();
        index.within(body.centre, body.radius + self.widest, |j, offset| {
            if asked(j) && offset.norm2() < (body.radius + self.bodies[j].radius).powi(2) {
                near.push((j, offset));
            }
        });
        near.sort_unstable_by_key(|(j, _)| *j);
        near
    }

    /// By how much each element lies too deep in others, in sum.
    pub(super) fn excess(&self, budget: &Budget) -> Result<Vec<f64>> {
        let index = self.index();
        let over = |i: usize| -> Result<Vec<(usize, f64)>> {
            let mut meter = budget.meter();
            let mut found = Vec::new();
            let a = &self.bodies[i];
            for (j, offset) in self.around(&index, a, |j| j > i) {
                let (contact, cost) = contact(a, &self.bodies[j], offset);
                meter.spend(cost)?;
                let over = contact.map_or(0.0, |c| c.depth - self.allowed.of(self.class(i), self.class(j)));
                if over > 0.0 {
                    found.push((j, over));
                }
            }
            Ok(found)
        };
        let found: Vec<_> = (0..self.bodies.len()).into_par_iter().map(over).collect::<Result<_>>()?;
        budget.spend(0)?;
        let mut sums = vec![0.0; self.bodies.len()];
        for (i, list) in found.into_iter().enumerate() {
            for (j, over) in list {
                sums[i] += over;
                sums[j] += over;
            }
        }
        Ok(sums)
    }

    /// Takes out what lies too deep in others, worst first, and what is too much of its class. Overlaps up to `deep` of the radius stay.
    pub(super) fn thin(&mut self, targets: &Numbered<f64>, (slack, deep): (f64, f64), budget: &Budget) -> Result<()> {
        let excess = self.excess(budget)?;
        let mut left = Numbered::filled(0.0, targets.len());
        (0..self.bodies.len()).for_each(|i| left[self.class(i)] += 1.0);
        let mut order: Vec<usize> = (0..self.bodies.len()).collect();
        order.sort_by(|&a, &b| excess[b].total_cmp(&excess[a]).then(a.cmp(&b)));
        let mut gone = vec![false; self.bodies.len()];
        let index = self.index();
        let mut meter = budget.meter();
        for i in order {
            let class = self.class(i);
            if self.placements[i].frozen.is_some() {
                continue;
            }
            let body = &self.bodies[i];
            let inner = body.solid.inradius() * body.pose.scale;
            // With others gone it is no more than it was.
            if excess[i] <= WORSE * inner {
                continue;
            }
            // What was taken out already is in nobody's way.
            let mut now = 0.0;
            for (j, offset) in self.around(&index, body, |j| j != i && !gone[j]) {
                let (found, cost) = contact(body, &self.bodies[j], offset);
                meter.spend(cost)?;
                if let Some(found) = found {
                    now += (found.depth - self.allowed.of(class, self.class(j))).max(0.0);
                }
            }
            let too_many = left[class] > targets[class] * (1.0 + slack) && now > WORSE * inner;
            if now > TOO_DEEP * inner + deep * body.radius || too_many {
                gone[i] = true;
                left[class] -= 1.0;
            }
        }
        // Of those in nobody's way the outermost go.
        let domain = &self.extent.request().domain;
        let mut order: Vec<(f64, usize)> =
            self.bodies.iter().enumerate().map(|(i, b)| (domain.signed_distance(b.centre), i)).collect();
        meter.spend(2000 * order.len() as u64)?;
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, i) in order {
            let class = self.class(i);
            let is_free = !gone[i] && self.placements[i].frozen.is_none();
            if is_free && left[class] > (targets[class] * (1.0 + slack)).max(targets[class] + 0.5) {
                gone[i] = true;
                left[class] -= 1.0;
            }
        }
        self.keep(&gone.iter().map(|g| !g).collect::<Vec<_>>());
        Ok(())
    }

    /// Takes out those that are not to be kept.
    fn keep(&mut self, kept: &[bool]) {
        fn only<T>(list: &mut Vec<T>, kept: &[bool]) {
            let mut keep = kept.iter();
            list.retain(|_| keep.next().copied().unwrap_or(true));
        }
        only(&mut self.placements, kept);
        only(&mut self.bodies, kept);
        only(&mut self.moved, kept);
        only(&mut self.gone, kept);
        only(&mut self.inside, kept);
        self.pairs.clear();
    }

    /// Puts an element in.
    pub(super) fn put(&mut self, placement: Placement<D>, body: Body<'a, D>) {
        self.bodies.push(body);
        self.placements.push(placement);
        self.moved.push(true);
        self.gone.push(0.0);
        self.inside.push(0.0);
        self.pairs.clear();
    }
}
