//! The first layout: wherever there is most room, the element that fits best.
//!
//! Candidates are what goes on from the elements around as in the exemplar [Ma 2011 §4.2], and any other; the one that lies least in the
//! others is taken. Places outside of the domain from which elements reach into it are laid out as well, so that the pattern is cut by
//! its border as that of the exemplar is by the frame.

use std::{cmp::Ordering, collections::BinaryHeap};

use arabesque_core::{Border, Bounds, Build, Domain, Matrix, Request, Result, Stage, Stream, Vector};

use super::{
    bodies::{Bodies, Laid, walked},
    form::Form,
    natural::{LOOK, Natural, laid, quantile, sizes},
    wall,
};

const PLACES: Stage = Stage::new(451);
const CHOICES: Stage = Stage::new(452);

/// Places that are looked at lie so many widths apart.
const STEP: f64 = 1.0;
/// There are no more of them than this.
const MOST_PLACES: f64 = 4e6;
/// Room is measured as far as so many widths.
const FAR: f64 = 2.0;
/// Candidates that go on from others, and any others.
const COHERENT: usize = 10;
const RANDOM: usize = 24;
/// A candidate that is worse than this is not taken, twice that when some were laid out and taken apart before, and so on; and how often a place is tried.
const WORST: f64 = 0.06;
const TRIES: u8 = 3;
/// What it costs to lie beyond a wall, beside lying in others, and to be bent by one.
const OUT: f64 = 0.25;
const BENT: f64 = 0.6;
/// What a candidate that goes on from others has in advance.
const ADVANCE: f64 = 0.004;
/// Elements reach out of the domain as far as this share of them do in the exemplar.
const USUAL: f64 = 0.7;
/// Work of one sample.
const SAMPLE: u64 = 40;

/// What a layout needs to know.
pub(super) struct Plan<'a, const D: usize> {
    pub(super) request: &'a Request<D>,
    pub(super) forms: &'a [Form<D>],
    pub(super) natural: &'a Natural,
    /// The exemplar.
    pub(super) known: Laid<D>,
    /// The box around it.
    shown: Bounds<D>,
    /// The elements of each class that may be copied.
    members: Vec<Vec<usize>>,
    /// How often elements were laid out before.
    pub(super) round: u64,
    /// Where elements may have their middle.
    pub(super) room: Domain<D>,
}

/// A place with the room that there was around it when it was last looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Roomy {
    room: f64,
    place: u32,
    tries: u8,
}

impl Eq for Roomy {}

impl PartialOrd for Roomy {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Roomy {
    fn cmp(&self, other: &Self) -> Ordering {
        self.room.total_cmp(&other.room).then(other.place.cmp(&self.place)).then(other.tries.cmp(&self.tries))
    }
}

impl<'a, const D: usize> Plan<'a, D> {
    pub(super) fn new(
        exemplar: &arabesque_core::Exemplar<D>,
        forms: &'a [Form<D>],
        natural: &'a Natural,
        request: &'a Request<D>,
    ) -> Self {
        let known = laid(exemplar, forms);
        let shown = known.bounds();
        let scale = request.fields.scale.range().1;
        let room = match &request.domain {
            Domain::Box(bounds) if request.border != Border::Inside => {
                Domain::Box(wider(bounds, request, forms, scale))
            }
            other => other.clone(),
        };
        let mut members = vec![Vec::new(); natural.density.len()];
        let copyable = forms.iter().enumerate().filter(|(_, f)| f.copyable);
        copyable.for_each(|(n, f)| members[f.class].push(n));
        Self { request, forms, natural, known, shown, members, round: 0, room }
    }

    /// Elements of each class that there should be in the domain.
    fn targets(&self) -> Vec<f64> {
        let centre = self.room.bounds().centre();
        let spacing = self.request.fields.frame(centre).spacing_scale;
        let volume = self.request.domain.measure() / spacing.powi(D as i32);
        self.natural.density.iter().map(|d| d * volume).collect()
    }

    /// How many elements there should be.
    pub(super) fn expected(&self) -> f64 {
        self.targets().iter().sum()
    }

    /// By how many elements the domain is short.
    pub(super) fn missing(&self, bodies: &Bodies<D>) -> f64 {
        let mut left = self.targets();
        for body in &bodies.list {
            let form = &self.forms[body.source];
            left[form.class] -= self.counted(form, bodies.samples(body, form));
        }
        left.iter().map(|n| n.max(0.0)).sum()
    }

    /// Places all over the room, in no order.
    fn places(&self) -> Result<Vec<Vector<D>>> {
        let bounds = self.room.bounds();
        let scale = self.request.fields.scale.range().1;
        let step = (STEP * self.natural.width * scale).max((bounds.measure() / MOST_PLACES).powf(1.0 / D as f64));
        let counts: [usize; D] = bounds.size().map(|side| (side / step).ceil().max(1.0)).0.map(|n| n as usize);
        let mut random = Stream::new(self.request.seed, PLACES, self.round);
        let budget = self.request.budget.stage("laying out elements that bend");
        let mut meter = budget.meter();
        let cell = Vector(std::array::from_fn(|k| bounds.size()[k] / counts[k] as f64));
        let mut found = Vec::new();
        for n in 0..counts.iter().product() {
            meter.spend(SAMPLE)?;
            let middle = bounds.cell_centre(n, &counts);
            let place = middle.zip(cell, |m, c| m + c * random.range(-0.5, 0.5));
            let is_above = self.request.ground.as_ref().is_none_or(|ground| ground.height(place) > 0.0);
            if is_above && self.room.contains(place) {
                found.push(place);
            }
        }
        random.shuffle(&mut found);
        Ok(found)
    }

    /// Lays elements out; `told` hears how many there are, and of how many.
    pub(super) fn laid_out(&self, laid: &mut Laid<D>, told: &mut dyn FnMut(&Laid<D>, f64) -> Result<()>) -> Result<()> {
        let budget = self.request.budget.stage("laying out elements that bend");
        let mut meter = budget.meter();
        let places = self.places()?;
        let targets = self.targets();
        let expected = self.expected();
        let far = FAR * self.natural.width * self.request.fields.scale.range().1;
        let mut heap: BinaryHeap<Roomy> =
            (0..places.len() as u32).map(|place| Roomy { room: far, place, tries: 0 }).collect();
        let mut counts = vec![0.0; targets.len()];
        for body in &laid.bodies.list {
            let form = &self.forms[body.source];
            counts[form.class] += self.counted(form, laid.bodies.samples(body, form));
        }
        let mut random = Stream::new(self.request.seed, CHOICES, self.round);
        let mut step = 0;
        while let Some(top) = heap.pop() {
            let Some(class) = short(&targets, &counts, &mut random) else { break };
            let place = places[top.place as usize];
            let (room, cost) = laid.gap(place, far);
            meter.spend(LOOK * cost)?;
            if room < top.room - 1e-12 {
                if room > 0.0 {
                    heap.push(Roomy { room, ..top });
                }
                continue;
            }
            match self.best(laid, place, class, &mut random, &mut meter)? {
                Some((source, samples, scale)) => {
                    let form = &self.forms[source];
                    laid.push(source, form, &samples, scale, None);
                    counts[form.class] += self.counted(form, &samples);
                    step += 1;
                    if step % 64 == 0 {
                        told(laid, (step as f64 / expected.max(1.0)).min(1.0))?;
                    }
                }
                None if top.tries + 1 < TRIES => heap.push(Roomy { room: 0.7 * room, tries: top.tries + 1, ..top }),
                None => {}
            }
        }
        Ok(())
    }

    /// 1 for what is part of the result, 0 for what only reaches into it.
    fn counted(&self, form: &Form<D>, samples: &[Vector<D>]) -> f64 {
        f64::from(u8::from(self.request.domain.contains(form.soft.middle(samples))))
    }

    /// The candidate that fits best at a place, if one does.
    fn best(
        &self,
        laid: &Laid<D>,
        place: Vector<D>,
        class: usize,
        random: &mut Stream,
        meter: &mut arabesque_core::Meter<'_>,
    ) -> Result<Option<(usize, Vec<Vector<D>>, f64)>> {
        let mut best: Option<(f64, usize, Vec<Vector<D>>, f64)> = None;
        let going_on = self.going_on(laid, place, random, meter)?;
        let any = (0..RANDOM).filter_map(|_| self.any(class, random)).collect::<Vec<_>>();
        let all = going_on.into_iter().map(|c| (c, ADVANCE)).chain(any.into_iter().map(|c| (c, 0.0)));
        let mut samples = Vec::new();
        for ((source, at), advance) in all {
            let form = &self.forms[source];
            if form.class != class || !form.copyable {
                continue;
            }
            let scale = walked(form, (at, place), self.request, &mut samples);
            meter.spend(SAMPLE * samples.len() as u64)?;
            if !self.room.contains(form.soft.middle(&samples)) {
                continue;
            }
            let most = best.as_ref().map_or(WORST * (1 << self.round) as f64, |b| b.0) + advance;
            if let Some(cost) = self.cost(laid, form, (&samples, scale), most, meter)? {
                best = Some((cost - advance, source, samples.clone(), scale));
            }
        }
        Ok(best.map(|(_, source, samples, scale)| (source, samples, scale)))
    }

    /// Sources and samples that come to lie at a place where the exemplar goes on from what is around it.
    fn going_on(
        &self,
        laid: &Laid<D>,
        place: Vector<D>,
        random: &mut Stream,
        meter: &mut arabesque_core::Meter<'_>,
    ) -> Result<Vec<(usize, usize)>> {
        let width = self.natural.width * self.request.fields.scale.range().1;
        let mut around: Vec<(f64, u32, [u32; 2])> = Vec::new();
        let cost = laid.near(place, FAR * width, |piece, d| around.push((d, piece.body, piece.ends)));
        meter.spend(LOOK * cost)?;
        around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut seen = Vec::new();
        let mut found = Vec::new();
        for (_, body, ends) in around {
            if found.len() >= COHERENT || seen.contains(&body) {
                continue;
            }
            seen.push(body);
            let own = laid.bodies.list[body as usize];
            let frame = self.request.fields.frame(laid.bodies.points[ends[0] as usize]);
            let source = &self.forms[own.source].soft.samples[ends[0] as usize - own.first];
            let there = *source + frame.to_exemplar(place - laid.bodies.points[ends[0] as usize]);
            if !self.shown.contains(there) {
                continue;
            }
            let mut near = Vec::new();
            let cost = self.known.near(there, 0.5 * self.natural.width, |piece, d| {
                if piece.body as usize != own.source {
                    near.push((d, piece.body, piece.ends));
                }
            });
            meter.spend(LOOK * cost)?;
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
            if let Some((_, other, ends)) = near.first() {
                let first = self.known.bodies.list[*other as usize].first;
                found.push((*other as usize, ends[random.below(2)] as usize - first));
            }
        }
        Ok(found)
    }

    /// Any element of a class, and any sample of it.
    fn any(&self, class: usize, random: &mut Stream) -> Option<(usize, usize)> {
        let members = self.members.get(class)?;
        let source = *members.get(random.below(members.len()))?;
        Some((source, random.below(self.forms[source].len())))
    }

    /// How much samples lie too near to what is there, or outside where they must be inside; `None` from `most` on.
    fn cost(
        &self,
        laid: &Laid<D>,
        form: &Form<D>,
        (samples, scale): (&[Vector<D>], f64),
        most: f64,
        meter: &mut arabesque_core::Meter<'_>,
    ) -> Result<Option<f64>> {
        let mut sum = BENT * bent(form, samples, scale);
        let share = 1.0 / samples.len() as f64;
        let has_walls = wall::is_there(self.request);
        for (p, r) in samples.iter().zip(&form.soft.radii) {
            let r = r * scale;
            let reach = r + laid.thickest + self.natural.widest().max(0.0) * scale;
            let mut deepest = 0.0_f64;
            let looked = laid.near(*p, reach, |piece, d| {
                let apart = piece.radius + r + self.natural.gap(form.class as u32, piece.class) * scale;
                deepest = deepest.max(1.0 - d / apart.max(1e-12));
            });
            meter.spend(LOOK * looked)?;
            sum += deepest * deepest * share;
            if has_walls {
                sum += OUT * wall::beyond(self.request, *p, r).powi(2) * share;
            }
            if sum >= most {
                return Ok(None);
            }
        }
        Ok((sum < most).then_some(sum))
    }
}

/// How much a strand is bent more than its source: mean square of what its long links have become shorter by.
fn bent<const D: usize>(form: &Form<D>, samples: &[Vector<D>], scale: f64) -> f64 {
    if form.soft.build != Build::Strand {
        return 0.0;
    }
    let long = form.links.iter().filter(|link| link.b - link.a > 2);
    let lost = long.map(|link| {
        let length = (samples[link.a as usize] - samples[link.b as usize]).norm();
        (1.0 - length / (link.length * scale).max(f64::MIN_POSITIVE)).powi(2)
    });
    let (sum, count) = lost.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// The class that is farthest from its number, by chance; `None` where none is short of half an element.
fn short(targets: &[f64], counts: &[f64], random: &mut Stream) -> Option<usize> {
    let missing: Vec<f64> = targets.iter().zip(counts).map(|(t, c)| if t - c >= 0.5 { t - c } else { 0.0 }).collect();
    let total: f64 = missing.iter().sum();
    if total <= 0.0 {
        return None;
    }
    let mut left = random.unit() * total;
    for (class, m) in missing.iter().enumerate() {
        left -= m;
        if left <= 0.0 && *m > 0.0 {
            return Some(class);
        }
    }
    missing.iter().rposition(|m| *m > 0.0)
}

/// A box, wider by as much as elements with their middle outside reach into it.
fn wider<const D: usize>(bounds: &Bounds<D>, request: &Request<D>, forms: &[Form<D>], scale: f64) -> Bounds<D> {
    let turn = request.fields.frame(bounds.centre()).rotation;
    let reach = |axis: usize| {
        let mut all: Vec<f64> = forms.iter().map(|form| along(form, &turn, axis) * scale).collect();
        quantile(&mut all, USUAL).unwrap_or(0.0)
    };
    let more = Vector(std::array::from_fn(reach));
    Bounds::new(bounds.min - more, bounds.max + more)
}

/// How far an element reaches from its middle along an axis, once it is turned.
fn along<const D: usize>(form: &Form<D>, turn: &Matrix<D>, axis: usize) -> f64 {
    let middle = form.soft.middle(&form.soft.samples);
    let samples = form.soft.samples.iter().zip(&form.soft.radii);
    samples.map(|(p, r)| turn.apply(*p - middle)[axis].abs() + r).fold(0.0, f64::max)
}

/// A layout of elements that are in their places.
pub(super) fn holding<const D: usize>(plan: &Plan<'_, D>, bodies: &Bodies<D>) -> Laid<D> {
    let mut laid = empty(plan);
    for body in &bodies.list {
        let form = &plan.forms[body.source];
        laid.push(body.source, form, bodies.samples(body, form), body.scale, body.frozen);
    }
    laid
}

/// An empty layout for a plan.
pub(super) fn empty<const D: usize>(plan: &Plan<'_, D>) -> Laid<D> {
    let (half, thickest) = sizes(plan.forms);
    let scale = plan.request.fields.scale.range().1;
    let reach = plan.forms.iter().map(|f| f.reach).fold(0.0, f64::max) * scale;
    let cell = (2.0 * half).max(2.0 * thickest).max(1e-9) * scale;
    Laid::new(plan.room.bounds().grown(reach), cell, half * scale, thickest * scale)
}
