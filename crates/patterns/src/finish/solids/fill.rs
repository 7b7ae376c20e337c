//! What is missing goes where there is room.

use arabesque_core::{Buckets, Budget, Matrix, Numbered, Placement, Result, Stage, Stream, Vector};

use super::{
    contact::{Body, contact},
    place::Place,
    things::Things,
};

const PLACES: Stage = Stage::new(437);

/// Candidate places for each missing element, and sources tried at each.
const TRIES: usize = 40;
const SOURCES: usize = 6;
/// After so many places in a row at which nothing fits, and as many more as this share of what is missing, the others have no room either: they
/// have less.
const VAIN: f64 = 60.0;
const VAIN_SHARE: f64 = 0.25;
/// Steps by which a candidate moves to where it fits.
const STEPS: usize = 8;
/// A candidate fits where it lies too deep by no more than this share of its inner radius. Where much is missing, what is around makes room for it in the
/// earlier rounds, so that a dense heap gets what it is short of; where little is, that would only break its order.
const FITS: [f64; 3] = [0.5, 0.3, 0.08];
/// Share of the elements that have to be missing for that.
const MUCH: f64 = 0.05;

impl<const D: usize> Things<'_, D> {
    /// Puts elements of the classes that are short where there is most room.
    pub(super) fn fill(&mut self, targets: &Numbered<f64>, slack: f64, round: u64, budget: &Budget) -> Result<()> {
        let mut count = Numbered::filled(0.0, targets.len());
        (0..self.bodies.len()).for_each(|i| count[self.class(i)] += 1.0);
        let short: Vec<f64> = targets.iter().zip(&count).map(|(t, c)| t * (1.0 - slack) - c).collect();
        let missing = short.iter().map(|s| s.max(0.0).ceil()).sum::<f64>() as usize;
        if missing == 0 {
            return Ok(());
        }
        let mut random = Stream::new(self.extent.request().seed, PLACES, round);
        let is_much = missing as f64 > MUCH * targets.iter().sum::<f64>();
        let last = FITS.len() - 1;
        let fits = FITS[if is_much { (round as usize).min(last) } else { last }];
        let mut roomy = self.roomy(TRIES * missing, &mut random, budget)?;
        roomy.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut short = short;
        let mut near = self.buckets();
        let (mut vain, most) = (0.0, VAIN + VAIN_SHARE * missing as f64);
        for (_, place) in roomy {
            let Some(class) = (0..short.len()).max_by(|&a, &b| short[a].total_cmp(&short[b])) else { break };
            if short[class] <= 0.0 || vain > most {
                break;
            }
            vain += 1.0;
            if let Some(placement) = self.fitting((class as u32, place, fits), &near, &mut random, budget)? {
                let body = self.body(placement.source, &placement.transform);
                near.insert(self.bodies.len() as u32, body.centre);
                self.put(placement, body);
                short[class] -= 1.0;
                vain = 0.0;
            }
        }
        Ok(())
    }

    /// Random places outside of all bodies, with the distance to the nearest centre.
    fn roomy(&self, tries: usize, random: &mut Stream, budget: &Budget) -> Result<Vec<(f64, Vector<D>)>> {
        let request = self.extent.request();
        let place = Place::new(&request.domain, 0.0, request.seed, budget)?;
        let index = self.index();
        let mut meter = budget.meter();
        let mut found = Vec::new();
        for _ in 0..tries {
            meter.spend(3000)?;
            let Some((p, _)) = place.draw(random) else { continue };
            let mut deepest = -2.0 * self.widest;
            let looked = index.within(p, self.widest, |j, offset| {
                let body = &self.bodies[j];
                let shifted = body.centre - offset;
                deepest = deepest.max(body.depth(shifted).max(body.radius - 3.0 * self.widest));
            });
            meter.spend(60 * looked)?;
            if deepest < 0.0 {
                found.push((-deepest, p));
            }
        }
        Ok(found)
    }

    /// An element of a class that fits at a place, too deep by `fits` of its inner radius at most, moved a little where that helps.
    fn fitting(
        &self,
        (class, place, fits): (u32, Vector<D>, f64),
        near: &Buckets<D>,
        random: &mut Stream,
        budget: &Budget,
    ) -> Result<Option<Placement<D>>> {
        let members = self.library.members(class);
        let mut meter = budget.meter();
        for _ in 0..SOURCES {
            let source = members[random.below(members.len())];
            if !self.library.copyable[source] {
                continue;
            }
            let mut at = self.extent.grounded(source, place);
            for _ in 0..STEPS {
                let transform = self.extent.turned(source, at, &Matrix::identity());
                let body = self.body(source as usize, &transform);
                let (push, over, cost) = self.wish(&body, class, near);
                meter.spend(cost)?;
                let inner = body.solid.inradius() * body.pose.scale;
                if over <= fits * inner && self.extent.admits(source, at) {
                    let placement = Placement { source: source as usize, transform, control: Vec::new(), frozen: None };
                    return Ok(Some(placement));
                }
                at = self.extent.grounded(source, self.extent.request().domain.wrap(at + push));
            }
        }
        Ok(None)
    }

    /// Where a body would go, how deep it lies too deep, and the cost of knowing.
    fn wish(&self, body: &Body<'_, D>, class: u32, near: &Buckets<D>) -> (Vector<D>, f64, u64) {
        let (mut push, mut worst, mut cost) = (Vector::ZERO, 0.0_f64, 500);
        for (j, offset) in self.met(near, body) {
            let (found, looked) = contact(body, &self.bodies[j], offset);
            cost += looked;
            let Some(found) = found else { continue };
            let over = found.depth - self.allowed.of(class, self.class(j));
            if over > 0.0 {
                worst = worst.max(over);
                push += found.way * over;
            }
        }
        (push, worst, cost)
    }

    fn buckets(&self) -> Buckets<D> {
        let cell = self.widest.max(1e-9);
        let mut near = Buckets::new(&self.extent.request().domain, cell, cell);
        self.bodies.iter().zip(0..).for_each(|(body, i)| near.insert(i, body.centre));
        near
    }

    /// The bodies that a body may touch, with the way to each.
    fn met(&self, near: &Buckets<D>, body: &Body<'_, D>) -> Vec<(usize, Vector<D>)> {
        let domain = &self.extent.request().domain;
        let mut met = Vec::new();
        near.near(body.centre, body.radius + self.widest, |j| {
            let other = &self.bodies[j as usize];
            let offset = domain.offset(body.centre, other.centre);
            if offset.norm() < body.radius + other.radius {
                met.push((j as usize, offset));
            }
        });
        met.sort_by_key(|(j, _)| *j);
        met
    }
}
