//! What evening out works with: the page, what is natural, and the price of a state.
//!
//! The price has three parts, all sums of local terms. Places that are farther from ink than the exemplar tolerates cost the
//! square of the excess; pairs of elements nearer than the exemplar has such pairs cost what is missing, and its square;
//! and so do places where there is more or less ink around than usual. Lengths are in units of the tolerated distance, areas in its square, so that a price means the same in every pattern.

use std::cmp::Ordering;

use arabesque_core::{Budget, Meter, Numbered, Result, Vector};

use crate::{
    border::Extent,
    evenness::{
        ink::Pose,
        natural::Natural,
        page::{NOBODY, PRICE, Page},
        share::{self, Shares},
    },
    exemplar::library::Library,
    params::{Params, Switch},
};

/// Price of a gap that is too narrow: of what is missing, and of its square, in tolerated distances.
const NARROW: (f64, f64) = (2.0, 20.0);

/// Numbers of elements of a class stay within this share of what they should be.
const COUNT: f64 = 0.01;
/// Numbers are whole.
const ROUNDING: f64 = 0.5;

/// Nanoseconds for a pair of elements.
const PAIR: u64 = 600;

/// A step that can be undone.
#[derive(Clone, Copy, Debug)]
enum Undo<const D: usize> {
    Change(u32, Pose<D>),
    Add(u32),
    Remove(u32),
}

/// A page that is evened out.
pub(crate) struct Work<'a, const D: usize> {
    pub(crate) page: Page<'a, D>,
    /// Shares of ink; `None` where the exemplar does not tell what is natural.
    pub(crate) shares: Option<Shares<'a, D>>,
    pub(crate) natural: &'a Natural,
    pub(crate) library: &'a Library<D>,
    pub(crate) extent: &'a Extent<'a, D>,
    /// Elements of each class that are there, and that should be.
    pub(crate) counts: Numbered<f64>,
    pub(crate) targets: Numbered<f64>,
    pub(crate) moves: Moves,
    /// By which share a class may have fewer elements than it should, and by how many beside.
    pub(crate) fewer: f64,
    pub(crate) spare: f64,
    /// What is tried at the same time draws on it.
    pub(crate) budget: Budget,
    steps: Vec<Undo<D>>,
    /// What was kept, where this is a part.
    pub(crate) part: Option<Part<D>>,
    /// When elements last changed, by the part of the page; and now.
    changed: Vec<u32>,
    pub(crate) now: u32,
}

/// What a part of a page knows of the whole.
pub(crate) struct Part<const D: usize> {
    /// The middle and half the side of the box.
    pub(crate) around: (Vector<D>, f64),
    /// Numbers of its first elements on the whole page; the others are new.
    pub(crate) numbers: Vec<u32>,
    /// Elements that have changed.
    pub(crate) kept: Vec<u32>,
}

/// The moves that are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moves {
    pub(crate) shift: bool,
    pub(crate) exchange: bool,
    pub(crate) fill: bool,
    pub(crate) thin: bool,
    /// Whether the share of ink counts.
    pub(crate) share: bool,
}

impl Moves {
    /// Those that are asked for.
    pub(crate) fn new(params: &Params) -> Self {
        let is_on = |switch: Switch| switch == Switch::On;
        Self {
            shift: is_on(params.even_shift),
            exchange: is_on(params.even_exchange),
            fill: is_on(params.even_fill),
            thin: is_on(params.even_thin),
            share: is_on(params.even_share),
        }
    }
}

/// A place whose distance from ink depends on one element.
#[derive(Clone, Copy, Debug)]
struct Held<const D: usize> {
    place: Vector<D>,
    without: f64,
    tolerated: f64,
    /// Its size, in squares or cubes of what is tolerated.
    weight: f64,
    /// What it costs without the element.
    alone: f64,
}

/// How far an element in one pose is from what its price depends on: farther away by no more than it is moved, so that most of a pose
/// nearby is known without a look.
#[derive(Default)]
pub(crate) struct Known<const D: usize> {
    centre: Vector<D>,
    /// Of each place.
    own: Vec<f64>,
    /// Of each neighbour, at least.
    gaps: Vec<f64>,
}

/// What the price of an element depends on, around where it is or may go.
pub(crate) struct Scene<const D: usize> {
    held: Vec<Held<D>>,
    neighbours: Vec<u32>,
    /// Places of strokes that an element may come too near to, and half the width there.
    strokes: Vec<(Vector<D>, f64)>,
    shares: share::Around<D>,
}

impl<'a, const D: usize> Work<'a, D> {
    pub(crate) fn new(
        (page, shares): (Page<'a, D>, Option<Shares<'a, D>>),
        (natural, library): (&'a Natural, &'a Library<D>),
        (extent, budget): (&'a Extent<'a, D>, Budget),
        (counts, targets): (Numbered<f64>, Numbered<f64>),
        moves: Moves,
    ) -> Self {
        let changed = vec![1; page.parts()];
        let steps = Vec::new();
        let (fewer, spare, now) = (COUNT, ROUNDING, 1);
        Self {
            page,
            shares,
            natural,
            library,
            extent,
            counts,
            targets,
            moves,
            fewer,
            spare,
            budget,
            steps,
            part: None,
            changed,
            now,
        }
    }

    /// A part of the page, to be worked on by itself.
    pub(crate) fn part_around(&self, p: Vector<D>, radius: f64, here: &mut [u32]) -> Self {
        let (page, numbers) = self.page.part_around(p, radius, here);
        let shares = self.shares.as_ref().map(|shares| shares.part_around(p, radius));
        let changed = vec![self.now; page.parts()];
        let (counts, targets, budget) = (self.counts.clone(), self.targets.clone(), self.budget.clone());
        let part = Some(Part { around: (p, radius), numbers, kept: Vec::new() });
        Self { page, shares, counts, targets, budget, steps: Vec::new(), part, changed, ..*self }
    }

    /// The number that an element of the whole page has here.
    pub(crate) fn here(&self, b: u32) -> Option<u32> {
        self.part.as_ref().map_or(Some(b), |part| part.numbers.binary_search(&b).ok().map(|k| k as u32))
    }

    /// Whether all that an element in some pose changes, and that its price depends on, is here.
    pub(crate) fn sees(&self, pose: &Pose<D>) -> bool {
        let Some(Part { around: (p, radius), .. }) = &self.part else { return true };
        let near = self.page.reach.max(self.natural.widest * self.page.spacing_scale(pose.centre));
        let shares = self.shares.as_ref().map_or(0.0, Shares::widest);
        let far = (self.page.inks.radius(pose) + near).max(shares);
        self.page.domain().offset(*p, pose.centre).0.iter().all(|d| d.abs() + far <= *radius)
    }

    /// Whether a class may have one element more.
    pub(crate) fn wants(&self, class: u32) -> bool {
        self.counts[class] + 1.0 <= (1.0 + COUNT) * self.targets[class] + ROUNDING
    }

    /// Whether a class may have one element less.
    pub(crate) fn spares(&self, class: u32) -> bool {
        self.counts[class] - 1.0 >= (1.0 - self.fewer) * self.targets[class] - self.spare
    }

    /// Whether anything has changed around `p` since some time.
    pub(crate) fn has_changed(&self, p: Vector<D>, since: u32) -> bool {
        self.changed[self.page.part(p)] >= since
    }

    /// Price of a place.
    pub(crate) fn price_at(empty: f64, tolerated: f64) -> f64 {
        let excess = empty / tolerated - 1.0;
        if excess > 0.0 { excess * excess } else { 0.0 }
    }

    /// What the price of an element depends on that has its centre at most `step` from `centre` and is no larger than
    /// `radius`. `body`: its number, where it is on the page already.
    pub(crate) fn scene(
        &self,
        body: Option<u32>,
        centre: Vector<D>,
        (radius, step): (f64, f64),
        meter: &mut Meter<'_>,
    ) -> Result<Scene<D>> {
        let body = body.unwrap_or(NOBODY);
        let page = &self.page;
        let mut held = Vec::new();
        let mut looked = 0;
        let measure: f64 = page.lattice.cell().0.into_iter().product();
        let reach = radius + step + page.reach;
        page.lattice.around(centre, reach, |c, at| {
            looked += 1;
            let cell = &page.cells[c];
            let without = cell.without(body);
            if without > cell.tolerated {
                let place = page.lattice.centre_at(at);
                let tolerated = f64::from(cell.tolerated);
                let weight = measure * tolerated.powi(-(D as i32));
                let without = f64::from(without);
                let alone = Self::price_at(without, tolerated) * weight;
                held.push(Held { place, without, tolerated, weight, alone });
            }
        });
        if step > 0.0 {
            // What costs most first: then prices reach their limit soon.
            held.sort_unstable_by(|a, b| {
                b.alone.total_cmp(&a.alone).then_with(|| a.place.0.partial_cmp(&b.place.0).unwrap_or(Ordering::Equal))
            });
        }
        let scale = page.spacing_scale(centre);
        let widest = self.natural.widest.max(0.0) * scale;
        let mut neighbours = page.neighbours(centre, radius + step + widest, body);
        if step > 0.0 {
            let far = |o: u32| {
                let other = &page.body(o).pose;
                page.domain().offset(centre, other.centre).norm() - page.inks.radius(other)
            };
            neighbours.sort_by_cached_key(|&o| (far(o) / page.reach * 1e9) as i64);
        }
        let mut strokes = Vec::new();
        let clearest = self.natural.clearest * scale;
        page.strokes.near(centre, radius + step + clearest, |offset, radius| strokes.push((centre + offset, radius)));
        meter.spend(PRICE.0 * (looked + 20 * neighbours.len() as u64 + strokes.len() as u64))?;
        let there = |b: u32| page.bodies.get(b as usize).map(|body| ink_of(&body.pose));
        let shares = match &self.shares {
            Some(shares) => shares.around(centre, step, there(body), meter)?,
            None => share::Around::default(),
        };
        Ok(Scene { held, neighbours, strokes, shares })
    }

    /// Price of the surroundings of an element in some pose; without it for `None`. Beyond `limit`, any number larger than that.
    pub(crate) fn price(
        &self,
        scene: &Scene<D>,
        pose: Option<&Pose<D>>,
        limit: f64,
        meter: &mut Meter<'_>,
    ) -> Result<f64> {
        self.price_near(scene, pose, None, limit, meter)
    }

    /// The same near a pose that is known.
    pub(crate) fn price_near(
        &self,
        scene: &Scene<D>,
        pose: Option<&Pose<D>>,
        known: Option<&Known<D>>,
        limit: f64,
        meter: &mut Meter<'_>,
    ) -> Result<f64> {
        let sum = self.price_of_space(scene, pose, known, limit, meter)?;
        Ok(match &self.shares {
            Some(shares) if sum <= limit => sum + shares.price(&scene.shares, pose.map(ink_of)),
            _ => sum,
        })
    }

    /// Looks at everything around an element once, for poses at most `far` away. `None` where a pose changes with its place.
    pub(crate) fn known(
        &self,
        scene: &Scene<D>,
        pose: &Pose<D>,
        far: f64,
        meter: &mut Meter<'_>,
    ) -> Result<Option<Known<D>>> {
        if !self.page.is_neutral {
            return Ok(None);
        }
        meter.spend(PRICE.1 * scene.held.len() as u64 + PAIR * scene.neighbours.len() as u64)?;
        let placed = self.page.inks.placed(pose);
        let own = scene.held.iter().map(|held| placed.distance(held.place - pose.centre)).collect();
        let widest = self.natural.widest;
        let gap = |&o: &u32| {
            let (a, b) = in_order(pose, &self.page.body(o).pose);
            let offset = self.page.domain().offset(a.centre, b.centre);
            let least = self.page.inks.apart(a, b, offset, widest + far);
            if least >= widest { least } else { self.page.inks.gap(a, b, offset, widest).min(widest) }
        };
        Ok(Some(Known { centre: pose.centre, own, gaps: scene.neighbours.iter().map(gap).collect() }))
    }

    /// The same without the shares of ink.
    pub(crate) fn price_of_space(
        &self,
        scene: &Scene<D>,
        pose: Option<&Pose<D>>,
        known: Option<&Known<D>>,
        limit: f64,
        meter: &mut Meter<'_>,
    ) -> Result<f64> {
        let mut sum = 0.0;
        let moved = match (known, pose) {
            // Distances between places are looked up in maps, which are not quite exact.
            (Some(known), Some(pose)) => 1.05 * self.page.domain().offset(known.centre, pose.centre).norm(),
            _ => f64::INFINITY,
        };
        if let Some(pose) = pose {
            sum += narrow(self.cramped(pose, &scene.strokes, meter)?);
            for (k, &o) in scene.neighbours.iter().enumerate() {
                let least = known.map_or(f64::NEG_INFINITY, |known| known.gaps[k] - moved);
                sum += narrow(self.missing(pose, &self.page.body(o).pose, least, meter)?);
                if sum > limit {
                    return Ok(sum);
                }
            }
        }
        meter.spend(PRICE.1 * scene.held.len() as u64)?;
        let Some(pose) = pose else { return Ok(sum + scene.held.iter().map(|held| held.alone).sum::<f64>()) };
        let radius = self.page.inks.radius(pose);
        let placed = self.page.inks.placed(pose);
        for (k, held) in scene.held.iter().enumerate() {
            if let Some(own) = known.map(|known| known.own[k]) {
                if own + moved <= held.tolerated {
                    continue;
                }
                if own - moved >= held.without {
                    sum += held.alone;
                    if sum > limit {
                        break;
                    }
                    continue;
                }
            }
            let (offset, far) = (held.place - pose.centre, held.without + radius);
            sum += if offset.norm2() >= far * far {
                held.alone
            } else {
                let own = placed.distance(offset);
                Self::price_at(own.min(held.without), held.tolerated) * held.weight
            };
            if sum > limit {
                break;
            }
        }
        Ok(sum)
    }

    /// What is missing of the narrowest gap that the exemplar has between such an element and strokes, in tolerated distances.
    fn cramped(&self, pose: &Pose<D>, strokes: &[(Vector<D>, f64)], meter: &mut Meter<'_>) -> Result<f64> {
        let Some(least) = self.natural.clear(self.library.class[pose.source]).filter(|_| !strokes.is_empty()) else {
            return Ok(0.0);
        };
        meter.spend(PRICE.1 * strokes.len() as u64)?;
        let scale = self.page.spacing_scale(pose.centre);
        let least = least * scale;
        let mut gap = least;
        let reach = self.page.inks.radius(pose);
        for (place, radius) in strokes {
            let (offset, far) = (*place - pose.centre, reach + gap + radius);
            if far > 0.0 && offset.norm2() < far * far {
                gap = gap.min(self.page.inks.distance(pose, offset) - radius);
            }
        }
        Ok((least - gap) / (self.natural.tolerated * scale))
    }

    /// What is missing of the narrowest gap that the exemplar has between two elements, of which it is known that they are at least so
    /// far apart; in tolerated distances.
    fn missing(&self, a: &Pose<D>, b: &Pose<D>, known: f64, meter: &mut Meter<'_>) -> Result<f64> {
        let (a, b) = in_order(a, b);
        let (x, y) = (self.library.class[a.source], self.library.class[b.source]);
        let scale = self.page.spacing_scale(a.centre);
        let offset = self.page.domain().offset(a.centre, b.centre);
        let least = self.natural.gap(x, y, self.page.unturned(a.centre, offset)) * scale;
        if known >= least || offset.norm() - self.page.inks.radius(a) - self.page.inks.radius(b) >= least {
            return Ok(0.0);
        }
        meter.spend(PAIR)?;
        let gap = self.page.inks.gap(a, b, offset, least);
        Ok(((least - gap) / (self.natural.tolerated * scale)).max(0.0))
    }

    /// Whether there are more of the class of an element than there should be.
    pub(crate) fn is_surplus(&self, b: u32) -> bool {
        let class = self.library.class[self.page.body(b).pose.source];
        self.counts[class] > self.targets[class] + 0.5
    }

    /// The most that is missing of a gap around an element.
    pub(crate) fn worst(&self, b: u32, meter: &mut Meter<'_>) -> Result<f64> {
        let body = self.page.body(b);
        if !body.alive {
            return Ok(0.0);
        }
        let scale = self.page.spacing_scale(body.pose.centre);
        let reach = self.page.inks.radius(&body.pose) + self.natural.widest.max(0.0) * scale;
        let mut strokes = Vec::new();
        let own = self.page.inks.radius(&body.pose) + self.natural.clearest * scale;
        let centre = body.pose.centre;
        self.page.strokes.near(centre, own, |offset, radius| strokes.push((centre + offset, radius)));
        let mut most = if body.fixed { 0.0 } else { self.cramped(&body.pose, &strokes, meter)? };
        for o in self.page.neighbours(body.pose.centre, reach, b) {
            let other = self.page.body(o);
            if !(body.fixed && other.fixed) {
                most = most.max(self.missing(&body.pose, &other.pose, f64::NEG_INFINITY, meter)?);
            }
        }
        Ok(most)
    }

    /// Price of the whole page.
    #[cfg(test)]
    pub(crate) fn total(&self, meter: &mut Meter<'_>) -> Result<f64> {
        let page = &self.page;
        let measure: f64 = page.lattice.cell().0.into_iter().product();
        let price = |cell: &crate::evenness::page::Cell| {
            let tolerated = f64::from(cell.tolerated);
            Self::price_at(f64::from(cell.empty()), tolerated) * measure / tolerated.powi(D as i32)
        };
        let mut sum: f64 = page.cells.iter().map(price).sum();
        sum += self.shares.as_ref().map_or(0.0, Shares::total);
        for b in 0..page.bodies.len() as u32 {
            let body = page.body(b);
            let reach = page.inks.radius(&body.pose) + self.natural.widest.max(0.0);
            for o in page.neighbours(body.pose.centre, reach, b).into_iter().filter(|&o| o > b && body.alive) {
                sum += narrow(self.missing(&body.pose, &page.body(o).pose, f64::NEG_INFINITY, meter)?);
            }
        }
        Ok(sum)
    }

    /// Puts an element elsewhere.
    pub(crate) fn change(&mut self, b: u32, pose: Pose<D>, meter: &mut Meter<'_>) -> Result<()> {
        let before = self.page.body(b).pose;
        self.steps.push(Undo::Change(b, before));
        self.count(&before, -1.0);
        self.count(&pose, 1.0);
        self.page.change(b, pose, meter)
    }

    /// Adds an element.
    pub(crate) fn add(&mut self, pose: Pose<D>, meter: &mut Meter<'_>) -> Result<u32> {
        let b = self.page.add(pose, meter)?;
        self.count(&pose, 1.0);
        self.steps.push(Undo::Add(b));
        Ok(b)
    }

    /// Takes an element away.
    pub(crate) fn remove(&mut self, b: u32, meter: &mut Meter<'_>) -> Result<()> {
        let pose = self.page.body(b).pose;
        self.count(&pose, -1.0);
        self.steps.push(Undo::Remove(b));
        self.page.remove(b, meter)
    }

    fn count(&mut self, pose: &Pose<D>, by: f64) {
        if self.page.domain().contains(pose.centre) {
            self.counts[self.library.class[pose.source]] += by;
        }
        if let Some(shares) = &mut self.shares {
            let (ink, centre) = ink_of(pose);
            shares.count(ink, centre, by);
        }
    }

    /// Everything up to here stays.
    pub(crate) fn keep(&mut self) {
        for step in std::mem::take(&mut self.steps) {
            let (Undo::Change(b, _) | Undo::Add(b) | Undo::Remove(b)) = step;
            let pose = self.page.body(b).pose;
            if let Some(part) = &mut self.part {
                part.kept.push(b);
            }
            let (page, changed, now) = (&self.page, &mut self.changed, self.now);
            page.parts_around(&pose, |part| changed[part] = now);
        }
    }

    /// Undoes everything since the last [`Work::keep`].
    pub(crate) fn undo(&mut self, meter: &mut Meter<'_>) -> Result<()> {
        while let Some(step) = self.steps.pop() {
            let (Undo::Change(b, _) | Undo::Add(b) | Undo::Remove(b)) = step;
            let now = self.page.body(b).pose;
            match step {
                Undo::Change(b, pose) => {
                    self.count(&now, -1.0);
                    self.count(&pose, 1.0);
                    self.page.change(b, pose, meter)?;
                }
                Undo::Add(b) => {
                    self.count(&now, -1.0);
                    self.page.remove(b, meter)?;
                    self.page.bodies.pop();
                }
                Undo::Remove(b) => {
                    self.count(&now, 1.0);
                    self.page.restore(b, meter)?;
                }
            }
        }
        Ok(())
    }
}

/// Two poses in an order that does not depend on who asks: then a gap between them is the same number to the last digit.
fn in_order<'p, const D: usize>(a: &'p Pose<D>, b: &'p Pose<D>) -> (&'p Pose<D>, &'p Pose<D>) {
    if a.centre.0 > b.centre.0 { (b, a) } else { (a, b) }
}

/// Price of a gap of which so much is missing.
fn narrow(missing: f64) -> f64 {
    if missing > 0.0 { (NARROW.0 + NARROW.1 * missing) * missing } else { 0.0 }
}

/// An element as a mass at its centre.
fn ink_of<const D: usize>(pose: &Pose<D>) -> ((u32, f64), Vector<D>) {
    ((pose.source, pose.scale), pose.centre)
}
