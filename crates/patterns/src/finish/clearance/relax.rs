//! Pushing overlapping elements apart, all together: in a crowd one has to make room for the other.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Meter, Outline, Result, Vector, ring};
use rayon::prelude::*;

use crate::finish::clearance::{
    arrangement::PlacedFigure,
    figure::extent,
    repair::{Repair, Violation},
};

/// Most rounds over the overlapping pairs.
const SWEEPS: usize = 12;

/// Rounds without progress after which pushing is given up.
const PATIENCE: usize = 2;

/// Share of the excess that a round must get below to be progress.
const PROGRESS: f64 = 0.95;

/// Directions in which the width of an overlap is measured, over half a turn.
const DIRECTIONS: u32 = 8;

impl Repair<'_> {
    /// Pushes pairs apart, round by round, and keeps the state with the least excess. Returns the violations left in
    /// it.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn relax(&mut self, violations: Vec<Violation>) -> Result<Vec<Violation>> {
        let budget = self.arrangement.budget.clone();
        let mut meter = budget.meter();
        let (mut best, mut best_bodies) = (violations.clone(), Vec::<(usize, PlacedFigure)>::new());
        let mut original = BTreeMap::<usize, PlacedFigure>::new();
        let mut active = violations;
        let mut idle = 0;
        for _ in 0..SWEEPS {
            if active.is_empty() || idle > PATIENCE {
                break;
            }
            let mut suspects: BTreeSet<usize> = active.iter().flat_map(|v| [v.0, v.1]).collect();
            for &(i, j, _) in &active {
                for (k, body) in self.push(i, j, &mut meter)?.into_iter().flatten() {
                    suspects.insert(k);
                    let before = std::mem::replace(&mut self.arrangement.bodies[k], body);
                    original.entry(k).or_insert(before);
                }
            }
            active = self.violations_among(&suspects)?;
            idle = if excess(&active) < PROGRESS * excess(&best) { 0 } else { idle + 1 };
            if excess(&active) < excess(&best) {
                best_bodies = original.keys().map(|&k| (k, self.arrangement.bodies[k].clone())).collect();
                best.clone_from(&active);
            }
        }
        original.extend(best_bodies);
        for (k, body) in original {
            self.arrangement.bodies[k] = body;
        }
        Ok(best)
    }

    /// Violations in which a suspect takes part, in order.
    fn violations_among(&self, suspects: &BTreeSet<usize>) -> Result<Vec<Violation>> {
        let budget = &self.arrangement.budget;
        let list: Vec<usize> = suspects.iter().copied().collect();
        // A pair of suspects is looked at once, from the lower one.
        let of = |&i: &usize| self.violations_of(i, |j| j > i || !suspects.contains(&j), &mut budget.meter());
        let found: Vec<Vec<Violation>> = list.par_iter().map(of).collect::<Result<_>>()?;
        budget.spend(0)?;
        let mut found = found.concat();
        found.sort_by_key(|v| (v.0, v.1));
        Ok(found)
    }

    /// Bodies `i` and `j` moved apart, each by the share of the other's area: a small element gives way to a large one.
    fn push(&self, i: usize, j: usize, meter: &mut Meter<'_>) -> Result<[Option<(usize, PlacedFigure)>; 2]> {
        let (a, b) = (&self.arrangement.bodies[i], &self.arrangement.bodies[j]);
        if i == j {
            return Ok([None, None]);
        }
        let Some((common, offset)) = self.arrangement.overlap_region(a, b, meter)? else {
            return Ok([None, None]);
        };
        let (area, allowed) = (common.area(), self.allowed_area([i, j], a, b));
        if area <= allowed {
            return Ok([None, None]);
        }
        let apart = narrowest(&common, offset) * (1.0 - allowed / area);
        let gap = self.limits.gap(a, b) * a.place.scale.min(b.place.scale);
        let apart = apart * (1.0 + gap / apart.norm().max(f64::MIN_POSITIVE));
        let share = match (a.fixed, b.fixed) {
            (true, _) => 0.0,
            (_, true) => 1.0,
            _ => b.area / (a.area + b.area).max(f64::MIN_POSITIVE),
        };
        Ok([self.shifted(i, -(apart * share), meter)?, self.shifted(j, apart * (1.0 - share), meter)?])
    }

    /// PlacedFigure `i` moved by `shift` as far as its reach and the border let it.
    fn shifted(&self, i: usize, shift: Vector<2>, meter: &mut Meter<'_>) -> Result<Option<(usize, PlacedFigure)>> {
        let body = &self.arrangement.bodies[i];
        let moved = self.within_reach(i, body.centre + shift);
        let stays = body.fixed || (!self.admits(&moved, meter)? && self.admits(body, meter)?);
        Ok((!stays).then_some((i, moved)))
    }
}

fn excess(violations: &[Violation]) -> f64 {
    violations.iter().map(|v| v.2).sum()
}

/// Shortest way that parts two bodies, from the second one's side: the width of the largest piece of their overlap
/// across its narrowest direction. `offset` leads from the first to the second.
fn narrowest(common: &Outline<2>, offset: Vector<2>) -> Vector<2> {
    let piece = common.rings.iter().max_by(|a, b| ring::area(a).abs().total_cmp(&ring::area(b).abs()));
    let piece: &[Vector<2>] = piece.map_or(&[], |ring| ring);
    let unit = offset.unit_or_zero();
    let compass = (0..DIRECTIONS).map(|k| f64::from(k) / f64::from(DIRECTIONS) * std::f64::consts::PI);
    let directions =
        std::iter::once(unit).filter(|u| u.norm2() > 0.5).chain(compass.map(|a| Vector::xy(a.cos(), a.sin())));
    let width = |d: &Vector<2>| {
        let (low, high) = extent(piece, *d);
        high - low
    };
    let best = directions.min_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(unit);
    best * if best.dot(offset) < 0.0 { -width(&best) } else { width(&best) }
}
