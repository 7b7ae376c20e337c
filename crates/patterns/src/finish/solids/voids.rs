//! Room that the exemplar does not have: what lies around it draws nearer.
//!
//! Samples say where neighbours are, not how much room is left between surfaces: in a heap of several kinds things overlap in one place
//! and leave a void beside it. Voids are found by the largest empty balls at random places, against those of the exemplar.

use arabesque_core::{Buckets, Budget, Domain, GridIndex, Result, Stage, Stream, Vector};
use rayon::prelude::*;

use super::{
    contact::{Body, Contact},
    place::Place,
    relax::Push,
    things::Things,
};

const PLACES: Stage = Stage::new(438);

/// Random places for each body, and at least.
const DENSE: usize = 20;
const LEAST: usize = 4000;
/// Share of the places of the exemplar whose empty balls are no larger than what counts as room by nature.
const QUANTILE: f64 = 0.98;
/// Fewest places of the exemplar that tell what its room is.
const ENOUGH: usize = 300;
/// Rounds of drawing nearer.
const ROUNDS: u64 = 8;
/// Steps of taking apart after each round.
const STEPS: usize = 4;
/// Bodies that reach into a ball so many times as large as the void draw nearer.
const AROUND: f64 = 1.5;
/// Bodies are looked for so far away, in radii of the widest.
const REACH: f64 = 2.0;
/// Work for a place of a surface that is looked at.
const LOOK: u64 = 3;

/// The largest empty ball at some place.
#[derive(Clone, Copy, Debug)]
struct Void<const D: usize> {
    centre: Vector<D>,
    radius: f64,
    /// By how much it is larger than those of the exemplar.
    excess: f64,
}

/// Bodies that are asked for the room between them.
struct Between<'a, const D: usize> {
    bodies: &'a [Body<'a, D>],
    index: &'a GridIndex<D>,
    widest: f64,
}

impl<const D: usize> Between<'_, D> {
    /// The empty ball around a place, 0 for what lies in a body or has no more room than `enough`, with the cost of knowing. No larger
    /// than the widest body.
    fn room(&self, p: Vector<D>, enough: f64) -> (f64, u64) {
        let (mut room, mut cost) = ((REACH - 1.0) * self.widest, 200);
        let (mut near, mut nearest) = (Vec::new(), (f64::INFINITY, 0));
        cost += 10
            * self.index.within(p, REACH * self.widest, |j, offset| {
                let least = offset.norm() - self.bodies[j].radius;
                if least < room {
                    nearest = if least < nearest.0 { (least, near.len()) } else { nearest };
                    near.push((least, j, offset));
                }
            });
        // What is nearest leaves little room for the rest to be looked at.
        if !near.is_empty() {
            near.swap(0, nearest.1);
        }
        for (least, j, offset) in near {
            if least >= room {
                continue;
            }
            let body = &self.bodies[j];
            let seen = body.centre - offset;
            // Long bodies reach far along their length alone.
            if body.beyond_box(seen) >= room {
                cost += 10;
                continue;
            }
            let depth = body.depth(seen);
            if depth > 0.0 {
                return (0.0, cost);
            }
            // Beyond its grid a solid does not tell how far it is.
            let far = if depth.is_finite() { -depth } else { body.nearest(seen).0 };
            cost += if depth.is_finite() { 20 } else { LOOK * body.solid.points.len() as u64 };
            room = room.min(far);
            if room <= enough {
                return (0.0, cost);
            }
        }
        (room, cost)
    }

    /// Empty balls at random places that lie within the domain as a whole, or in a layer within its sides, largest first; of those
    /// that are larger than `natural` there where it is not 0.
    fn voids(
        &self,
        place: &Place<'_, D>,
        (count, natural): (usize, &(dyn Fn(Vector<D>) -> f64 + Sync)),
        (seed, round): (u64, u64),
        budget: &Budget,
    ) -> Result<Vec<Void<D>>> {
        let one = |n: usize| -> Result<Option<Void<D>>> {
            let mut random = Stream::new(seed, PLACES, round << 32 | n as u64);
            let Some((centre, depth)) = place.draw(&mut random) else { return Ok(None) };
            let natural = natural(centre);
            let (radius, cost) = self.room(centre, natural);
            budget.spend(cost)?;
            let excess = radius - natural;
            let counts = (natural == 0.0 || excess > 0.0)
                && place.holds(centre, depth, radius)
                && radius < (REACH - 1.0) * self.widest;
            Ok(counts.then_some(Void { centre, radius, excess }))
        };
        let found: Result<Vec<_>> = (0..count).into_par_iter().with_min_len(64).map(one).collect();
        let mut found: Vec<_> = found?.into_iter().flatten().collect();
        found.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        Ok(found)
    }
}

impl<const D: usize> Things<'_, D> {
    /// The room between the bodies of the exemplar, largest by nature; nothing where the exemplar is too small to tell.
    pub(super) fn natural_room(&self, budget: &Budget) -> Result<Option<f64>> {
        let solids = self.exemplar.elements.iter().zip(&self.exemplar.solids);
        let bodies: Vec<_> = solids.map(|(e, s)| Body::new(s, e.pose)).collect();
        let widest = bodies.iter().map(|b| b.radius).fold(0.0, f64::max);
        let domain = Domain::Box(self.exemplar.window);
        let centres: Vec<_> = bodies.iter().map(|b| b.centre).collect();
        let index = GridIndex::new(&centres, widest.max(1e-9), &domain);
        let between = Between { bodies: &bodies, index: &index, widest };
        let count = (DENSE * bodies.len()).max(LEAST);
        let place = Place::new(&domain, thinnest(&bodies), 0, budget)?;
        let found = between.voids(&place, (count, &|_| 0.0), (0, 0), budget)?;
        let all = found.len();
        Ok((all >= ENOUGH).then(|| found[((1.0 - QUANTILE) * all as f64) as usize].radius))
    }

    /// Draws bodies together around voids that are larger than `natural`, and takes apart what then overlaps.
    pub(super) fn close_voids(&mut self, natural: f64, budget: &Budget) -> Result<()> {
        if self.bodies.is_empty() {
            return Ok(());
        }
        let request = self.extent.request();
        let spacing = self.library.spacing;
        // Where things are to be sparser, the room between them grows by as much as their distances do.
        let natural_at = |p: Vector<D>| {
            let frame = request.fields.frame(p);
            natural * frame.element_scale + spacing * (frame.spacing_scale - frame.element_scale)
        };
        let place = Place::new(&request.domain, thinnest(&self.bodies), request.seed, budget)?;
        for round in 0..ROUNDS {
            let index = self.index();
            let between = Between { bodies: &self.bodies, index: &index, widest: self.widest };
            let count = (DENSE * self.bodies.len()).max(LEAST);
            let voids = between.voids(&place, (count, &natural_at), (request.seed, round + 1), budget)?;
            let voids = apart(voids, &request.domain);
            if voids.is_empty() {
                break;
            }
            self.draw(&voids, &index);
            self.relax(STEPS, budget)?;
        }
        Ok(())
    }

    /// Moves what lies around voids towards them.
    fn draw(&mut self, voids: &[Void<D>], index: &GridIndex<D>) {
        let mut pushes = vec![Push::none(); self.bodies.len()];
        for void in voids {
            let reach = AROUND * void.radius;
            let mut near = Vec::new();
            index.within(void.centre, reach + self.widest, |j, offset| near.push((j, offset)));
            for (j, offset) in near {
                let body = &self.bodies[j];
                let seen = body.centre - offset;
                if self.placements[j].frozen.is_some() || offset.norm() - body.radius > reach {
                    continue;
                }
                let (far, at) = body.nearest(seen);
                if far < reach && far > 0.0 {
                    let fade = 1.0 - (far - void.radius).max(0.0) / (reach - void.radius);
                    let found = Contact { depth: 0.0, at, way: (seen - at) * (1.0 / far) };
                    self.add(&mut pushes[j], j, &found, fade * void.excess);
                }
            }
        }
        for (j, push) in pushes.iter().enumerate() {
            let start = self.bodies[j].centre;
            if self.apply(j, push, start, self.widest) > 0.0 {
                self.moved[j] = true;
            }
        }
    }
}

/// The radius of the largest ball in the thinnest of some bodies.
fn thinnest<const D: usize>(bodies: &[Body<'_, D>]) -> f64 {
    bodies.iter().map(|b| b.solid.inradius() * b.pose.scale).fold(f64::INFINITY, f64::min)
}

/// The largest voids that do not reach into one another.
fn apart<const D: usize>(voids: Vec<Void<D>>, domain: &Domain<D>) -> Vec<Void<D>> {
    let Some(largest) = voids.first().map(|void| void.radius) else { return voids };
    let mut near = Buckets::new(domain, largest, largest);
    let mut kept: Vec<Void<D>> = Vec::new();
    for void in voids {
        let mut is_free = true;
        near.near(void.centre, largest, |k| {
            let other = &kept[k as usize];
            is_free &= domain.offset(other.centre, void.centre).norm() >= other.radius.max(void.radius);
        });
        if is_free {
            near.insert(kept.len() as u32, void.centre);
            kept.push(void);
        }
    }
    kept
}
