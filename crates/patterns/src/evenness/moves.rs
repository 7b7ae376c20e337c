//! The moves that even a page out; each is kept only if the price falls.

use arabesque_core::{Matrix, Meter, Result, Vector};
use rayon::prelude::*;

use crate::{
    dimension::Dimension,
    evenness::{
        ink::Pose,
        share::Shares,
        work::{Scene, Work},
    },
};

/// A step must lower the price by this much to count.
const WORTH: f64 = 1e-4;

/// One element more or less must lower it by this much.
const WORTH_ONE: f64 = 0.04;

/// An element that pays less stays where it is.
const QUIET: f64 = 8e-3;

/// Steps of an element that looks for a better place, in tolerated distances: short ones first, so that it goes no farther than
/// it must, and at the end what the long ones leave.
const STEPS: [f64; 4] = [0.12, 0.3, 0.6, 0.15];

/// Steps longer than this, in what an element may go, are reason to look at everything around it again.
const FRESH: f64 = 0.2;

/// How far it may go, in tolerated distances.
pub(crate) const FAR: f64 = 1.0;

/// Steps of one length.
const TURNS: usize = 3;

/// Elements around a place that give way.
const AROUND: usize = 8;

/// Elements that are tried in a hole or in place of another: as they are, moved to where they fit best, and with others giving
/// way.
const CANDIDATES: (usize, usize, usize) = (24, 4, 2);

/// What raises the price by more than this is not tried any farther.
const HOPELESS: f64 = 8.0;

/// The same for others that would have to give way.
const CROWDED: f64 = 1.5;

/// Elements that differ by less, in mean spacings, are not worth an exchange.
const SAME: f64 = 0.03;

/// Weight of how little an element agrees with its neighbours.
const AGREEMENT: f64 = 0.15;

/// Elements that one thread looks at by itself.
const ALONE: usize = 4;

/// Nanoseconds for a part of the page that is looked at.
const LOOK: u64 = 4;

impl<const D: usize> Work<'_, D>
where
    Vector<D>: Dimension<D>,
{
    /// Length of a tolerated distance at `p`.
    pub(crate) fn unit(&self, p: Vector<D>) -> f64 {
        self.natural.tolerated * self.page.spacing_scale(p)
    }

    fn admits(&self, pose: &Pose<D>) -> bool {
        self.sees(pose) && self.extent.admits(pose.source, pose.centre)
    }

    /// Those of some elements that pay enough to look for a better place.
    pub(crate) fn unsettled(&self, bodies: &[u32]) -> Result<Vec<u32>> {
        let pays = |&b: &u32| {
            let body = self.page.body(b);
            if body.fixed || !body.alive || !self.moves.shift {
                return Ok(None);
            }
            let mut meter = self.budget.meter();
            let scene = self.scene(Some(b), body.pose.centre, (self.page.inks.radius(&body.pose), 0.0), &mut meter)?;
            Ok((self.price_of_space(&scene, Some(&body.pose), None, QUIET, &mut meter)? >= QUIET).then_some(b))
        };
        let found = bodies.par_iter().with_min_len(ALONE).map(pays).collect::<Result<Vec<_>>>()?;
        self.budget.spend(0)?;
        Ok(found.into_iter().flatten().collect())
    }

    /// How far from its centre an element looks that is moved, and what moves there changes what it sees.
    fn sight(&self, b: u32) -> f64 {
        let pose = &self.page.body(b).pose;
        let shares = self.shares.as_ref().map_or(0.0, Shares::widest);
        FAR * self.unit(pose.centre) + shares.max(self.page.inks.radius(pose) + self.page.reach)
    }

    /// Moves elements to where the price is lowest nearby, at the same time those that do not see one another. Calls `moved` for each that
    /// has moved.
    pub(crate) fn settle_all(
        &mut self,
        mut open: Vec<u32>,
        meter: &mut Meter<'_>,
        moved: &mut dyn FnMut(&mut Self, u32) -> Result<()>,
    ) -> Result<()> {
        let mut seen = vec![0_u32; self.page.parts()];
        for turn in 1.. {
            let (mut now, mut later) = (Vec::new(), Vec::new());
            for b in open {
                let (centre, sight) = (self.page.body(b).pose.centre, self.sight(b));
                let mut looked = 0;
                let mut is_alone = true;
                self.page.parts_within(centre, sight, |part| {
                    looked += 1;
                    is_alone &= seen[part] != turn;
                });
                meter.spend(LOOK * looked)?;
                if is_alone {
                    self.page.parts_within(centre, sight, |part| seen[part] = turn);
                    now.push(b);
                } else {
                    later.push(b);
                }
            }
            let better = |&b: &u32| self.better_place(b, &mut self.budget.meter());
            let better = now.par_iter().map(better).collect::<Result<Vec<_>>>()?;
            self.budget.spend(0)?;
            for (b, pose) in now.into_iter().zip(better) {
                if let Some((pose, _)) = pose {
                    self.change(b, pose, meter)?;
                    moved(self, b)?;
                }
            }
            if later.is_empty() {
                break;
            }
            open = later;
        }
        Ok(())
    }

    /// Moves an element to where the price is lowest nearby. Returns by how much it fell.
    pub(crate) fn settle(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<f64> {
        let Some((pose, gain)) = self.better_place(b, meter)? else { return Ok(0.0) };
        self.change(b, pose, meter)?;
        Ok(gain)
    }

    /// How an element would lie where the price is lowest nearby, and by how much it would fall.
    fn better_place(&self, b: u32, meter: &mut Meter<'_>) -> Result<Option<(Pose<D>, f64)>> {
        let body = *self.page.body(b);
        if body.fixed || !body.alive || !self.moves.shift || !self.sees(&body.pose) {
            return Ok(None);
        }
        let unit = self.unit(body.pose.centre);
        let far = FAR * unit;
        let radius = self.page.inks.radius(&body.pose);
        let scene = self.scene(Some(b), body.pose.centre, (radius, far), meter)?;
        // Shares of ink alone are as they are in many places of the exemplar.
        if self.price_of_space(&scene, Some(&body.pose), None, f64::INFINITY, meter)? < QUIET {
            return Ok(None);
        }
        let start = self.price(&scene, Some(&body.pose), f64::INFINITY, meter)?;
        let (pose, price) = self.descend(&scene, (start, body.pose), (far, f64::INFINITY), meter)?;
        if start - price < WORTH {
            return Ok(None);
        }
        Ok(Some((pose, start - price)))
    }

    /// The cheapest pose that steps lead to, none longer than `far`; it is given up where it is sure enough not to become cheaper than
    /// `goal`.
    fn descend(
        &self,
        scene: &Scene<D>,
        (mut price, mut pose): (f64, Pose<D>),
        (far, goal): (f64, f64),
        meter: &mut Meter<'_>,
    ) -> Result<(Pose<D>, f64)> {
        let turn = self.turn(&pose);
        let (first, start) = (price, pose.centre);
        let mut leading = Vector::ZERO;
        let mut known = self.known(scene, &pose, far, meter)?;
        for (n, step) in STEPS.into_iter().enumerate() {
            let step = step * far;
            // As much again as was gained so far is not to be expected of what is left.
            if price < WORTH || (n > 1 && price - goal > first - price) {
                break;
            }
            let mut left = TURNS;
            loop {
                // What helped last is tried first.
                let tried = std::iter::once(leading).filter(|way| *way != Vector::ZERO).chain(ways::<D>());
                let mut better = None;
                for way in tried {
                    let centre = pose.centre + way * step;
                    if self.page.domain().offset(start, centre).norm() > far {
                        continue;
                    }
                    let moved = self.page.pose(pose.source, centre, &turn);
                    let there = self.price_near(scene, Some(&moved), known.as_ref(), price, meter)?;
                    if there < price - WORTH && self.admits(&moved) {
                        better = Some((moved, there, way));
                        break;
                    }
                }
                let Some((moved, there, way)) = better else { break };
                (pose, price, leading) = (moved, there, way);
                if step > FRESH * far {
                    known = self.known(scene, &pose, far, meter)?;
                }
                left -= 1;
                if left == 0 || price < WORTH {
                    break;
                }
            }
        }
        Ok((pose, price))
    }

    /// How an element is turned from the local frame.
    fn turn(&self, pose: &Pose<D>) -> Matrix<D> {
        self.page.request.fields.frame(pose.centre).rotation.transpose().compose(&pose.rotation)
    }

    /// Lets the elements around a place give way, nearest first, and once more where that helped.
    pub(crate) fn give_way(&mut self, p: Vector<D>, meter: &mut Meter<'_>) -> Result<f64> {
        let group = self.group(p, AROUND);
        let mut sum = 0.0;
        for _ in 0..2 {
            let mut gain = 0.0;
            for &b in &group {
                gain += self.settle(b, meter)?;
            }
            sum += gain;
            if gain < WORTH {
                break;
            }
        }
        Ok(sum)
    }

    /// The elements nearest to a place by their ink, the nearest first.
    pub(crate) fn group(&self, p: Vector<D>, most: usize) -> Vec<u32> {
        let reach = 1.5 * self.library.spacing * self.page.spacing_scale(p);
        let near = self.page.neighbours(p, reach, u32::MAX);
        let distance = |b: u32| {
            let pose = &self.page.body(b).pose;
            self.page.inks.distance(pose, self.page.domain().offset(pose.centre, p))
        };
        let mut near: Vec<_> = near.into_iter().map(|b| (distance(b), b)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.into_iter().take(most).map(|(_, b)| b).collect()
    }

    /// How little an element agrees with those around it: 0 where each stands to it as such elements do in the exemplar, 1
    /// where none does.
    fn disagreement(&self, pose: &Pose<D>, except: Option<u32>, meter: &mut Meter<'_>) -> Result<f64> {
        let frame = self.page.request.fields.frame(pose.centre);
        let reach = 1.3 * self.library.spacing * frame.spacing_scale;
        let near = self.page.neighbours(pose.centre, reach, except.unwrap_or(u32::MAX));
        let (mut sum, mut all) = (0.0, 1e-9);
        for other in near {
            let other = &self.page.body(other).pose;
            let offset = frame.to_exemplar(self.page.domain().offset(pose.centre, other.centre));
            for (from, to, offset) in [(pose, other, offset), (other, pose, -offset)] {
                let class = self.library.class[to.source];
                let place = self.library.centre[from.source] + offset;
                if !self.library.view.contains(place) {
                    continue;
                }
                let alike = self.library.alike(to.source, place, meter)?[0];
                let most = self.library.outlier[class].powi(2);
                sum += alike.map_or(1.0, |(_, cost)| f64::from(cost) / most);
                all += 1.0;
            }
        }
        Ok(sum / all)
    }

    /// Exemplar elements that stand beside those around `p` where they come from, by how many of these have them there.
    fn likely(&self, p: Vector<D>, meter: &mut Meter<'_>) -> Result<Vec<u32>> {
        let frame = self.page.request.fields.frame(p);
        let mut found: Vec<u32> = Vec::new();
        let reach = 1.2 * self.library.spacing;
        for b in self.group(p, AROUND) {
            let pose = &self.page.body(b).pose;
            let offset = frame.to_exemplar(self.page.domain().offset(pose.centre, p));
            let place = self.library.centre[pose.source] + offset;
            meter.spend(self.library.within(place, reach, |e, _| found.push(e)))?;
        }
        let base = self.page.inks.len() as u32;
        // What is joined to strokes does not stand by itself.
        let is_loose = |e: u32| self.natural.clear(self.library.class[e]).is_some();
        found.retain(|&e| e < base && self.library.copyable[e] && is_loose(e));
        found.sort_unstable();
        let mut counted: Vec<(usize, u32)> = found.chunk_by(|a, b| a == b).map(|run| (run.len(), run[0])).collect();
        counted.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        Ok(counted.into_iter().map(|(_, e)| e).take(CANDIDATES.0).collect())
    }

    /// Elements that could be put into a hole around `p`: their rating, the lower the better, by how much the price would
    /// rise, and where they would lie.
    fn rated(&self, p: Vector<D>, meter: &mut Meter<'_>) -> Result<Vec<(f64, f64, Pose<D>)>> {
        let far = FAR * self.unit(p);
        let candidates = self.likely(p, meter)?;
        let largest = candidates.iter().map(|&e| self.library.radius[e]).fold(0.0, f64::max);
        let largest = largest * self.page.request.fields.frame(p).element_scale;
        let scene = self.scene(None, p, (largest, far), meter)?;
        let before = self.price(&scene, None, f64::INFINITY, meter)?;
        let is_wanted = |&source: &u32| self.wants(self.library.class[source]);
        let wanted: Vec<u32> = candidates.into_iter().filter(is_wanted).collect();
        let sorted = self.priced(&scene, &wanted, p, before + HOPELESS, meter)?;
        let rate = |(start, pose): &(f64, Pose<D>)| {
            let meter = &mut self.budget.meter();
            let (pose, price) = self.descend(&scene, (*start, *pose), (far, before + CROWDED), meter)?;
            if !self.admits(&pose) {
                return Ok(None);
            }
            let rise = price - before;
            Ok(Some((rise + AGREEMENT * self.disagreement(&pose, None, meter)?, rise, pose)))
        };
        // Also in parallel within a hole: towards the end of a round there are few holes at a time.
        let tried = &sorted[..sorted.len().min(CANDIDATES.1)];
        let rated = tried.par_iter().map(rate).collect::<Result<Vec<_>>>()?;
        self.budget.spend(0)?;
        Ok(rated.into_iter().flatten().collect())
    }

    /// Elements as they would lie at `p` without being moved, with the price there, the cheapest first; none dearer than `most`.
    fn priced(
        &self,
        scene: &Scene<D>,
        sources: &[u32],
        p: Vector<D>,
        most: f64,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<(f64, Pose<D>)>> {
        let price = |&source: &u32| {
            let pose = self.page.pose(source, p, &Matrix::identity());
            Ok((self.price(scene, Some(&pose), most, meter)?, pose))
        };
        let mut priced: Vec<_> = sources.iter().map(price).collect::<Result<_>>()?;
        priced.retain(|(price, _)| *price <= most);
        priced.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.source.cmp(&b.1.source)));
        Ok(priced)
    }

    /// The place farthest from ink around `p`.
    pub(crate) fn emptiest(&self, p: Vector<D>) -> Option<Vector<D>> {
        let mut best: Option<(f32, Vector<D>)> = None;
        let reach = self.library.spacing * self.page.spacing_scale(p);
        self.page.lattice.around(p, reach, |c, at| {
            let empty = self.page.cells[c].empty();
            if best.is_none_or(|(most, _)| empty > most) {
                best = Some((empty, self.page.lattice.centre_at(at)));
            }
        });
        best.map(|(_, place)| place)
    }

    /// Puts a further element into a hole around `p`, where others may give way.
    pub(crate) fn fill(&mut self, p: Vector<D>, meter: &mut Meter<'_>) -> Result<bool> {
        if !self.moves.fill {
            return Ok(false);
        }
        let mut rated = self.rated(p, meter)?;
        rated.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.source.cmp(&b.2.source)));
        let fits = rated.into_iter().filter(|(_, cost, _)| *cost <= CROWDED);
        for (_, cost, pose) in fits.take(CANDIDATES.2) {
            let b = self.add(pose, meter)?;
            let mut gain = -cost;
            if cost > -WORTH {
                // It is in the way of others: these may make room.
                gain += self.give_way(self.page.body(b).pose.centre, meter)?;
            }
            if gain > WORTH_ONE {
                self.keep();
                return Ok(true);
            }
            self.undo(meter)?;
        }
        Ok(false)
    }

    /// Puts other elements in place of those around `p`, where they suit the room better.
    pub(crate) fn exchange(&mut self, p: Vector<D>, most: usize, meter: &mut Meter<'_>) -> Result<bool> {
        for b in self.group(p, most) {
            if self.exchange_one(b, meter)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn exchange_one(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<bool> {
        let body = *self.page.body(b);
        if body.fixed || !body.alive || !self.moves.exchange || !self.sees(&body.pose) {
            return Ok(false);
        }
        let class = self.library.class[body.pose.source];
        let members = self.library.members(class);
        let step = members.len().div_ceil(CANDIDATES.0).max(1);
        let far = FAR * self.unit(body.pose.centre);
        let largest = members.iter().map(|&e| self.library.radius[e]).fold(0.0, f64::max) * body.pose.scale;
        let scene = self.scene(Some(b), body.pose.centre, (largest, far), meter)?;
        let now = self.price(&scene, Some(&body.pose), f64::INFINITY, meter)?;
        let same = (SAME * self.library.spacing).powi(2) as f32;
        let differs =
            |e: &&u32| self.library.copyable[**e] && self.library.differences.of(**e, body.pose.source) > same;
        let others: Vec<u32> = members.iter().step_by(step).filter(differs).copied().collect();
        let rated = self.priced(&scene, &others, body.pose.centre, now + HOPELESS, meter)?;
        for (start, pose) in rated.into_iter().take(CANDIDATES.1) {
            let (pose, price) = self.descend(&scene, (start, pose), (far, now), meter)?;
            if now - price <= WORTH || !self.admits(&pose) {
                continue;
            }
            let mine = self.disagreement(&body.pose, Some(b), meter)?;
            let worse = self.disagreement(&pose, Some(b), meter)? - mine;
            if now - price > WORTH + AGREEMENT * worse.max(0.0) {
                self.change(b, pose, meter)?;
                self.keep();
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Takes an element out of a clump, where others may close up.
    pub(crate) fn thin(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<bool> {
        let body = *self.page.body(b);
        if body.fixed || !body.alive || !self.moves.thin || !self.sees(&body.pose) {
            return Ok(false);
        }
        if !self.spares(self.library.class[body.pose.source]) {
            return Ok(false);
        }
        let scene = self.scene(Some(b), body.pose.centre, (self.page.inks.radius(&body.pose), 0.0), meter)?;
        let mut gain = self.price(&scene, Some(&body.pose), f64::INFINITY, meter)?
            - self.price(&scene, None, f64::INFINITY, meter)?;
        self.remove(b, meter)?;
        gain += self.give_way(body.pose.centre, meter)?;
        if gain > WORTH_ONE {
            self.keep();
            return Ok(true);
        }
        self.undo(meter)?;
        Ok(false)
    }
}

/// Directions of a step: to the sides and to the corners.
fn ways<const D: usize>() -> impl Iterator<Item = Vector<D>> {
    let count = 3_usize.pow(D as u32);
    (0..count).filter(move |&n| n != count / 2).map(|n| {
        let side = |k: usize| (n / 3_usize.pow(k as u32) % 3) as f64 - 1.0;
        Vector(std::array::from_fn(side)).unit_or_zero()
    })
}
