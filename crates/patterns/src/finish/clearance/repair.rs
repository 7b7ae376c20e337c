//! Mending what overlaps too much or lies out of the domain.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet, BinaryHeap},
};

use arabesque_core::{Budget, Meter, Placement, Request, Result, Similarity, Vector};
use rayon::prelude::*;

use crate::finish::clearance::{
    arrangement::{Arrangement, PlacedFigure},
    border_check::BorderCheck,
    figure::Figure,
    limits::{ExemplarClearance, NEGLIGIBLE},
    summary::Summary,
};

/// How far an element may be shifted, in mean spacings.
const REACH: f64 = 0.5;

/// Circles on which a free place is looked for, out to the reach.
const RINGS: u32 = 5;

/// Places on each circle.
const PLACES: u32 = 12;

/// Smaller elements that are tried in place of one, at most.
const EXCHANGES: usize = 24;

/// Elements with more overlapping partners than this, counted by size, leave before anything is pushed.
const HOPELESS: u64 = 4;

/// The same once everything has been pushed apart as far as it goes.
const CROWDED: u64 = 2;

/// A partner of the same size or larger.
const ONE: u64 = 1000;

/// Nanoseconds for a body that is sorted or counted, and for an edge that is compared with the border of a region.
const PRICE: (u64, u64) = (50, 300);

/// Two bodies that overlap too much, the lower index first, and by how much area.
pub(crate) type Violation = (usize, usize, f64);

/// An arrangement being mended.
pub(crate) struct Repair<'a> {
    pub(crate) limits: &'a ExemplarClearance,
    pub(crate) arrangement: Arrangement<'a>,
    pub(crate) border_check: BorderCheck<'a>,
    /// Pairs that must be apart although the exemplar has such: there are too many of them.
    surplus: BTreeSet<(usize, usize)>,
    /// Which bodies are still there.
    pub(crate) alive: Vec<bool>,
    /// Longest shift of each body.
    reach: Vec<f64>,
    /// Longest shift of any body.
    pub(crate) slack: f64,
}

/// See [`super::repair`].
pub(crate) fn repair(
    limits: &ExemplarClearance,
    request: &Request<2>,
    placements: &mut Vec<Placement<2>>,
    budget: &Budget,
) -> Result<Summary> {
    let mut repair = Repair::new(limits, request, placements, budget)?;
    let violations = repair.find_violations()?;
    let outside = repair.misplaced()?;
    let mut summary = Summary { pairs: violations.len(), outside: outside.len(), ..Summary::default() };
    if violations.is_empty() && outside.is_empty() {
        return Ok(summary);
    }
    let before = repair.arrangement.bodies.clone();
    let violations = repair.make_room(violations)?;
    repair.settle(&violations, &outside)?;
    repair.thin_out(violations, 0)?;
    summary.restored = repair.fill_holes(&before)?;
    repair.write_back(placements, &mut summary);
    Ok(summary)
}

impl<'a> Repair<'a> {
    fn new(
        limits: &'a ExemplarClearance,
        request: &'a Request<2>,
        placements: &[Placement<2>],
        budget: &Budget,
    ) -> Result<Self> {
        budget.spend(10 * PRICE.0 * placements.len() as u64)?;
        let (mut own, mut bodies) = limits.bodies(placements, budget)?;
        let mut reach: Vec<_> = placements.iter().map(|p| REACH * limits.spacing * p.transform.scale).collect();
        for obstacle in request.obstacles.iter().filter(|o| !o.rings.is_empty()) {
            let figure = Figure::new(obstacle.clone(), obstacle.bounds().centre(), budget)?;
            let body = PlacedFigure::new(limits.figures.len() + own.len(), &figure, Similarity::identity());
            bodies.push(PlacedFigure { fixed: true, ..body });
            own.push(figure);
        }
        reach.resize(bodies.len(), 0.0);
        let slack = reach.iter().copied().fold(0.0, f64::max);
        Ok(Self {
            limits,
            alive: vec![true; bodies.len()],
            arrangement: Arrangement::new(&request.domain, budget.clone(), &limits.figures, own, bodies),
            border_check: BorderCheck { domain: &request.domain, border: request.border },
            surplus: BTreeSet::new(),
            reach,
            slack,
        })
    }

    /// Every violation at the start; decides which allowed overlaps are too many.
    fn find_violations(&mut self) -> Result<Vec<Violation>> {
        let mut allowed = self.arrangement.overlaps()?;
        let mut violations = Vec::new();
        allowed.retain(|o| {
            let excess = self.excess_of(&self.arrangement.bodies[o.a], &self.arrangement.bodies[o.b], o.area);
            if excess > 0.0 {
                violations.push((o.a, o.b, excess));
            }
            excess <= 0.0
        });
        self.surplus = self.limits.surplus(&self.arrangement, &allowed).into_iter().collect();
        for overlap in allowed.iter().filter(|o| self.surplus.contains(&(o.a, o.b))) {
            violations.push((overlap.a, overlap.b, overlap.area));
        }
        violations.sort_by_key(|&(i, j, _)| (i, j));
        Ok(violations)
    }

    fn misplaced(&self) -> Result<Vec<usize>> {
        let mut meter = self.arrangement.budget.meter();
        let mut misplaced = Vec::new();
        for (i, body) in self.arrangement.bodies.iter().enumerate() {
            if !body.fixed && body.radius > 0.0 && !self.admits(body, &mut meter)? {
                misplaced.push(i);
            }
        }
        Ok(misplaced)
    }

    /// Whether the border lets `body` be where it is.
    pub(crate) fn admits(&self, body: &PlacedFigure, meter: &mut Meter<'_>) -> Result<bool> {
        let figure = self.arrangement.figure(body.figure);
        meter.spend(PRICE.0 + self.border_check.looks(body, figure) * PRICE.1)?;
        Ok(self.border_check.admits(body, figure))
    }

    /// Common area of `a` and `b` beyond what they may have.
    fn excess_of(&self, a: &PlacedFigure, b: &PlacedFigure, area: f64) -> f64 {
        if a.fixed && b.fixed { 0.0 } else { (area - self.limits.allowed_area(a, b)).max(0.0) }
    }

    /// Common area that bodies `i` and `j` may have, as `a` and `b`.
    pub(crate) fn allowed_area(&self, [i, j]: [usize; 2], a: &PlacedFigure, b: &PlacedFigure) -> f64 {
        if self.surplus.contains(&(i.min(j), i.max(j))) {
            return NEGLIGIBLE * a.area.min(b.area);
        }
        self.limits.allowed_area(a, b)
    }

    /// Whether bodies `i` and `j`, as `a` and `b`, overlap too much.
    fn conflict(&self, [i, j]: [usize; 2], a: &PlacedFigure, b: &PlacedFigure, meter: &mut Meter<'_>) -> Result<bool> {
        if a.fixed && b.fixed {
            return Ok(false);
        }
        Ok(self.arrangement.overlap_area(a, b, i == j, meter)? > self.allowed_area([i, j], a, b))
    }

    /// Violations of body `i` with the partners that `counts` lets through, ascending.
    pub(crate) fn violations_of(
        &self,
        i: usize,
        counts: impl Fn(usize) -> bool,
        meter: &mut Meter<'_>,
    ) -> Result<Vec<Violation>> {
        let mut found = Vec::new();
        if !self.alive[i] {
            return Ok(found);
        }
        let body = &self.arrangement.bodies[i];
        let neighbours = self.arrangement.neighbours(i, self.slack, meter)?;
        for j in neighbours.into_iter().filter(|&j| self.alive[j] && counts(j)).chain([i]) {
            let other = &self.arrangement.bodies[j];
            let is_fixed = body.fixed && other.fixed;
            let area = if is_fixed { 0.0 } else { self.arrangement.overlap_area(body, other, i == j, meter)? };
            let excess = area - self.allowed_area([i, j], body, other);
            if excess > 0.0 {
                found.push((i.min(j), i.max(j), excess));
            }
        }
        Ok(found)
    }

    /// Whether body `i`, changed to `candidate`, breaks no rule. `neighbours` are those of body `i`.
    fn is_clean(
        &self,
        i: usize,
        candidate: &PlacedFigure,
        neighbours: &[usize],
        meter: &mut Meter<'_>,
    ) -> Result<bool> {
        if !self.admits(candidate, meter)? || self.conflict([i, i], candidate, candidate, meter)? {
            return Ok(false);
        }
        for &j in neighbours {
            if self.alive[j] && self.blocks([i, j], candidate, meter)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether body `j` is in the way of `candidate` for body `i`: where nothing may overlap, a touch is enough.
    fn blocks(&self, [i, j]: [usize; 2], candidate: &PlacedFigure, meter: &mut Meter<'_>) -> Result<bool> {
        let other = &self.arrangement.bodies[j];
        if self.must_be_apart([i, j], candidate, other) {
            return self.arrangement.meet(candidate, other, meter);
        }
        self.conflict([i, j], candidate, other, meter)
    }

    fn must_be_apart(&self, [i, j]: [usize; 2], a: &PlacedFigure, b: &PlacedFigure) -> bool {
        self.limits.must_be_apart(a, b) || self.surplus.contains(&(i.min(j), i.max(j)))
    }

    /// Pushes apart what overlaps. Where far too much lies in one place that cannot succeed: there the most crowded
    /// leave first.
    fn make_room(&mut self, violations: Vec<Violation>) -> Result<Vec<Violation>> {
        let violations = self.thin_out(violations, HOPELESS)?;
        let violations = self.relax(violations)?;
        let before = violations.len();
        let violations = self.thin_out(violations, CROWDED)?;
        if violations.len() < before { self.relax(violations) } else { Ok(violations) }
    }

    /// PlacedFigure `i` at `centre`, no farther from its start than its reach.
    pub(crate) fn within_reach(&self, i: usize, centre: Vector<2>) -> PlacedFigure {
        let origin = self.arrangement.origin(i);
        let shift = centre - origin;
        let factor = (self.reach[i] / shift.norm().max(f64::MIN_POSITIVE)).min(1.0);
        self.arrangement.bodies[i].moved_to(origin + shift * factor)
    }

    /// Mends what pushing could not: body by body, with everything else as it is.
    fn settle(&mut self, violations: &[Violation], outside: &[usize]) -> Result<()> {
        let budget = self.arrangement.budget.clone();
        let mut meter = budget.meter();
        for &i in outside.iter() {
            let neighbours = self.arrangement.neighbours(i, self.slack, &mut meter)?;
            let stays = self.is_clean(i, &self.arrangement.bodies[i], &neighbours, &mut meter)?;
            self.alive[i] = stays || self.relocate(i, &mut meter)? || self.exchange(i, &mut meter)?;
        }
        let mut worst_first = violations.to_vec();
        worst_first.sort_by(|x, y| y.2.total_cmp(&x.2).then((x.0, x.1).cmp(&(y.0, y.1))));
        let mut tried = BTreeSet::new();
        for (i, j, _) in worst_first {
            if self.is_violation(i, j, &mut meter)? {
                let mut free: Vec<_> = [i, j].into_iter().filter(|&k| !self.arrangement.bodies[k].fixed).collect();
                free.sort_by(|&a, &b| {
                    self.arrangement.bodies[a].area.total_cmp(&self.arrangement.bodies[b].area).then(a.cmp(&b))
                });
                // What found no place once will hardly find one later: nothing makes room any more.
                free.retain(|&k| tried.insert(k));
                let mut is_settled = false;
                for &k in &free {
                    is_settled = is_settled || self.relocate(k, &mut meter)?;
                }
                for &k in &free {
                    is_settled = is_settled || self.exchange(k, &mut meter)?;
                }
            }
        }
        Ok(())
    }

    fn is_violation(&self, i: usize, j: usize, meter: &mut Meter<'_>) -> Result<bool> {
        if !self.alive[i] || !self.alive[j] {
            return Ok(false);
        }
        self.conflict([i, j], &self.arrangement.bodies[i], &self.arrangement.bodies[j], meter)
    }

    /// Puts body `i` on the nearest free place within its reach.
    fn relocate(&mut self, i: usize, meter: &mut Meter<'_>) -> Result<bool> {
        let neighbours = self.arrangement.neighbours(i, self.slack, meter)?;
        for ring in 1..=RINGS {
            for place in 0..PLACES {
                let turn = (f64::from(place) + 0.5 * f64::from(ring % 2)) / f64::from(PLACES) * std::f64::consts::TAU;
                let shift = Vector::xy(turn.cos(), turn.sin()) * (self.reach[i] * f64::from(ring) / f64::from(RINGS));
                let candidate = self.arrangement.bodies[i].moved_to(self.arrangement.origin(i) + shift);
                if self.is_clean(i, &candidate, &neighbours, meter)? {
                    self.arrangement.bodies[i] = candidate;
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Puts a smaller element of the same class in the place of body `i`, the largest that fits.
    fn exchange(&mut self, i: usize, meter: &mut Meter<'_>) -> Result<bool> {
        let body = self.arrangement.bodies[i].clone();
        if body.figure >= self.limits.figures.len() {
            // A bent element has no counterpart with its bend.
            return Ok(false);
        }
        let neighbours = self.arrangement.neighbours(i, self.slack, meter)?;
        let smaller: Vec<_> = self.limits.smaller_sources(body.figure).collect();
        let step = smaller.len().div_ceil(EXCHANGES).max(1);
        for &source in smaller.iter().step_by(step) {
            let centre = self.limits.figures[source].centre;
            let place = Similarity::about(centre, body.centre, body.place.rotation, body.place.scale);
            let candidate = self.limits.body(source, place);
            if self.is_clean(i, &candidate, &neighbours, meter)? {
                self.arrangement.bodies[i] = candidate;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Takes bodies out until none has a crowd of more than `most` around it: the most crowded first, of these the
    /// smallest. Returns the violations that are left.
    fn thin_out(&mut self, violations: Vec<Violation>, most: u64) -> Result<Vec<Violation>> {
        let budget = self.arrangement.budget.clone();
        let is_left = |v: &Violation| self.is_violation(v.0, v.1, &mut budget.meter());
        let left: Vec<bool> = violations.par_iter().map(is_left).collect::<Result<_>>()?;
        budget.spend(0)?;
        let mut meter = budget.meter();
        let mut left = left.into_iter();
        let mut violations = violations;
        violations.retain(|_| left.next().unwrap_or(false));
        let mut partners = BTreeMap::<usize, Vec<usize>>::new();
        for &(i, j, _) in &violations {
            partners.entry(i).or_default().push(j);
            partners.entry(j).or_default().push(i);
        }
        // Small area first among equals: the bits of positive numbers are ordered like the numbers.
        let key = |this: &Self, i: usize| {
            (this.crowd(i, &partners[&i]), Reverse(this.arrangement.bodies[i].area.to_bits()), i)
        };
        let free = partners.keys().filter(|&&i| !self.arrangement.bodies[i].fixed);
        let mut queue: BinaryHeap<_> = free.map(|&i| key(self, i)).collect();
        while let Some(entry) = queue.pop() {
            meter.spend(PRICE.0 + 5 * partners[&entry.2].len() as u64)?;
            let now = key(self, entry.2);
            if now.0 <= most * ONE {
                continue;
            }
            if now == entry {
                self.alive[entry.2] = false;
            } else {
                queue.push(now);
            }
        }
        violations.retain(|v| self.alive[v.0] && self.alive[v.1]);
        Ok(violations)
    }

    /// Number of partners that are still there, in multiples of [`ONE`]; one that is smaller than body `i` counts by
    /// its size.
    fn crowd(&self, i: usize, partners: &[usize]) -> u64 {
        let own = self.arrangement.bodies[i].area.max(f64::MIN_POSITIVE);
        let weight = |&j: &usize| ((self.arrangement.bodies[j].area / own).min(1.0) * ONE as f64) as u64;
        partners.iter().filter(|&&j| self.alive[i] && self.alive[j]).map(|j| weight(j).max(1)).sum()
    }

    fn write_back(&self, placements: &mut Vec<Placement<2>>, summary: &mut Summary) {
        for (i, (placement, body)) in placements.iter_mut().zip(&self.arrangement.bodies).enumerate() {
            let exchanged = placement.control.is_empty() && placement.source != body.figure;
            let centre = self.arrangement.domain().wrap(body.centre);
            if !self.alive[i] {
                summary.removed += 1;
            } else if exchanged {
                summary.exchanged += 1;
                placement.source = body.figure;
                placement.transform = body.moved_to(centre).place;
            } else if body.centre != self.arrangement.origin(i) {
                summary.moved += 1;
                shift(placement, centre - self.arrangement.origin(i));
            }
        }
        let mut alive = self.alive.iter();
        placements.retain(|_| alive.next().is_none_or(|&keep| keep));
    }
}

fn shift(placement: &mut Placement<2>, by: Vector<2>) {
    placement.transform.translation += by;
    for (_, target) in &mut placement.control {
        *target += by;
    }
}
