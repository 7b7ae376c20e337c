//! The two shortest offsets that take nearly every mark to another of its kind.

use std::{cmp::Ordering, collections::BTreeMap};

use arabesque_core::{Budget, Result, Vector};

use crate::repeat::{
    description::{Explains, Extent, Repeat},
    lattice::{Lattice, are_parallel},
    marks::{Anchor, Kinds, Mark, Marks},
    offsets::fit::{Fit, Sums},
    stacking::Stacking,
    support::{LineIndex, is_supported},
};

/// A way of comparing marks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mode {
    pub(crate) kinds: Kinds,
    pub(crate) anchor: Anchor,
    /// How far partners may lie off, in mean distances of marks.
    pub(crate) tolerance: f64,
    /// Fewest marks with which this can be trusted.
    pub(crate) least: usize,
    /// Fewest marks that a translation takes to others, as a number and as a share of all.
    pub(crate) seen: (usize, f64),
}

/// So few partners are no chance where they have to be in place exactly.
pub(crate) const FEW: (usize, f64) = (2, 0.12);
/// Where they may be about there.
pub(crate) const MANY: (usize, f64) = (10, 0.3);

/// Where a margin is left out, three rows tell that there are more.
pub(crate) const ROWS: (usize, f64) = (8, 0.55);

/// Rounding of coordinates, and drawing by hand.
pub(crate) const EXACT: f64 = 0.02;
pub(crate) const NEAR: f64 = 0.2;

/// Coordinates are taken to be rounded to this share of the side of the frame at worst.
const ROUNDING: f64 = 4e-4;

/// Marks from which offsets to all others are taken, at most, and so many of one kind.
const ANCHORS: (usize, usize) = (96, 24);

/// Marks to which offsets are taken from each of these at most, the nearest: no cell of a pattern holds more.
const PARTNERS: usize = 6000;

/// Offsets that are looked at more closely.
const CANDIDATES: usize = 40_000;

/// More jitter than this, in terms of the shorter vector, is no lattice.
const JITTER: f64 = 0.12;

/// Most marks in a cell where they lie about where they should.
const FEW_IN_CELL: f64 = 6.5;

/// Work for each offset.
const OFFSET: u64 = 60;
/// Work of a look at a mark.
const LOOK: u64 = 2;

/// The search in one way of comparing.
pub(crate) struct Search<'a> {
    pub(crate) marks: &'a Marks,
    pub(crate) lines: &'a LineIndex<'a>,
    /// What lies on what, where that has to be kept.
    pub(crate) order: Option<&'a Stacking>,
    pub(crate) mode: Mode,
    pub(crate) side: f64,
    pub(crate) budget: &'a Budget,
}

impl Search<'_> {
    fn tolerance(&self) -> f64 {
        let tolerance = (self.mode.tolerance * self.marks.unit).max(ROUNDING * self.side);
        // Where marks crowd along a line or in heaps, the mean distance would take neighbours for one another.
        let is_crowded = self.mode.tolerance <= EXACT && self.marks.closest > 0.0;
        if is_crowded { tolerance.min(NEAR * self.marks.closest) } else { tolerance }
    }

    /// The repeat that the marks show.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn lattice(&self) -> Result<Option<Repeat>> {
        let tolerance = self.tolerance();
        let (mut first, mut along): (Option<Vector<2>>, Option<Vector<2>>) = (None, None);
        for by in self.candidates()? {
            let is_new = first.is_none_or(|a| !are_parallel(a, by));
            let may_be_along = along.is_none() && self.runs_along(by);
            if !(is_new || may_be_along) || !self.holds(by)? {
                continue;
            }
            along = along.or(Some(by).filter(|_| may_be_along));
            match first {
                None => first = Some(by),
                // Two steps of about one vector differ by what is no vector at all.
                Some(a) if !is_new || are_one(a, by, 2.0 * tolerance) => {}
                Some(a) if !self.is_strip() || self.spans(a, by)? => return self.refined(a, by, Extent::Plane),
                Some(_) => {}
            }
        }
        match along.filter(|_| self.mode.kinds == Kinds::Looks && self.mode.tolerance <= EXACT) {
            Some(a) => self.frieze(a),
            None => Ok(None),
        }
    }

    /// Whether a vector takes nearly all to others of its kind.
    fn holds(&self, by: Vector<2>) -> Result<bool> {
        let tolerance = self.tolerance();
        Ok(is_supported(self.marks, by, tolerance, self.mode.seen, self.budget)?
            && self.lines.supports(by, tolerance.min(0.01 * self.side), self.budget)?
            && self.order.map_or(Ok(true), |order| order.supports(self.marks, by, tolerance, self.budget))?)
    }

    /// Whether a vector takes most of what it leaves in the frame to others of its kind, and anything at all.
    fn is_met(&self, by: Vector<2>) -> Result<bool> {
        let (marks, tolerance) = (self.marks, 2.0 * self.tolerance());
        let window = marks.window.grown(1e-6 * self.side);
        let (mut seen, mut met, mut meter) = (0_usize, 0_usize, self.budget.meter());
        for mark in marks.all.iter().filter(|mark| !mark.is_context) {
            if window.contains(mark.extent.min + by) && window.contains(mark.extent.max + by) {
                let (partner, looked) = marks.find(mark.place + by, mark.kind, tolerance);
                meter.spend(8 * (4 + looked))?;
                seen += 1;
                met += usize::from(partner.is_some());
            }
        }
        Ok(seen > 0 && 2 * met > seen)
    }

    /// Whether the shortest vectors that two of them span are seen as well: a row that goes up and down is no pattern of the plane.
    fn spans(&self, a: Vector<2>, b: Vector<2>) -> Result<bool> {
        let Some(lattice) = Lattice::new(a, b) else { return Ok(false) };
        let near = self.tolerance();
        let is_known = |v: Vector<2>| [a, b].iter().any(|u| (*u - v).norm().min((*u + v).norm()) <= near);
        for v in lattice.vectors.into_iter().filter(|v| !is_known(*v)) {
            if !self.is_met(v)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a vector runs along the frame.
    fn runs_along(&self, by: Vector<2>) -> bool {
        by[0].abs().min(by[1].abs()) <= 1e-3 * by.norm()
    }

    /// Whether all lies inside the frame along one of its axes, so that it may be a frieze.
    fn is_strip(&self) -> bool {
        self.mode.tolerance <= EXACT && (self.is_inside(0) || self.is_inside(1))
    }

    /// Whether all lies inside the frame along an axis.
    fn is_inside(&self, axis: usize) -> bool {
        let window = self.marks.window;
        let slack = 1e-6 * window.size().norm();
        let is_inside = |min: f64, max: f64| min >= window.min[axis] - slack && max <= window.max[axis] + slack;
        // What is cut at the sides shows that there is more beyond them.
        let is_cut = |m: &Mark| {
            let (low, high) = (m.extent.min[axis] - window.min[axis], window.max[axis] - m.extent.max[axis]);
            m.is_context && low.min(high) <= slack
        };
        self.marks.all.iter().all(|m| is_inside(m.extent.min[axis], m.extent.max[axis]) && !is_cut(m))
            && self.lines.are_within_or_go_on(axis)
    }

    /// What repeats in one direction alone, along the frame and inside it.
    fn frieze(&self, a: Vector<2>) -> Result<Option<Repeat>> {
        let across = usize::from(a[0].abs() >= a[1].abs());
        if !self.is_inside(across) {
            return Ok(None);
        }
        let mut b = Vector::ZERO;
        b[across] = self.marks.window.size()[across];
        self.refined(a, b, Extent::Frieze)
    }

    /// Offsets that several marks share, shortest first.
    fn candidates(&self) -> Result<Vec<Vector<2>>> {
        let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (i, mark) in self.marks.all.iter().enumerate() {
            members.entry(mark.kind).or_default().push(i);
        }
        let mut kinds: Vec<_> = members.into_values().filter(|m| m.len() > 1).collect();
        kinds.sort_by_key(|m| (m.len(), m[0]));
        let centre = self.marks.window.centre();
        let cell = self.tolerance();
        let mut votes: BTreeMap<(i64, i64), (Vector<2>, u32)> = BTreeMap::new();
        let mut anchors = 0;
        for kind in &kinds {
            if anchors >= ANCHORS.0 {
                break;
            }
            let far = |i: usize| (self.marks.all[i].place - centre).norm2();
            let mut from = kind.clone();
            from.sort_by(|&i, &j| far(i).total_cmp(&far(j)).then(i.cmp(&j)));
            from.truncate(ANCHORS.1);
            anchors += from.len();
            for &i in &from {
                self.budget.spend(OFFSET * kind.len().min(PARTNERS) as u64 + kind.len() as u64 * LOOK)?;
                for offset in self.offsets(i, kind) {
                    let offset = if (offset[1], offset[0]) < (0.0, 0.0) { -offset } else { offset };
                    let key = ((offset[0] / cell).floor() as i64, (offset[1] / cell).floor() as i64);
                    let entry = votes.entry(key).or_insert((Vector::ZERO, 0));
                    *entry = (entry.0 + offset, entry.1 + 1);
                }
            }
        }
        let least = (0.02 * self.marks.unit).min(0.5 * self.marks.closest);
        let shared = votes.into_values().filter(|(_, count)| *count >= 2);
        let mut offsets: Vec<_> = shared.map(|(sum, n)| (sum * (1.0 / f64::from(n)), n)).collect();
        offsets.retain(|(offset, _)| offset.norm() > least.max(2.0 * cell));
        if offsets.len() > CANDIDATES {
            offsets.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
            offsets.truncate(CANDIDATES);
        }
        offsets.sort_by(|(a, _), (b, _)| a.norm2().total_cmp(&b.norm2()));
        Ok(offsets.into_iter().map(|(offset, _)| offset).collect())
    }

    /// From one mark to the nearest of its kind.
    fn offsets(&self, i: usize, kind: &[usize]) -> Vec<Vector<2>> {
        let from = self.marks.all[i].place;
        let mut offsets: Vec<_> = kind.iter().filter(|&&j| j != i).map(|&j| self.marks.all[j].place - from).collect();
        if offsets.len() > PARTNERS {
            offsets.select_nth_unstable_by(PARTNERS, |a, b| {
                a.norm2().total_cmp(&b.norm2()).then_with(|| a.0.partial_cmp(&b.0).unwrap_or(Ordering::Equal))
            });
            offsets.truncate(PARTNERS);
        }
        offsets
    }

    /// The lattice of two vectors, fitted to all marks; `None` where they do not lie on it after all.
    fn refined(&self, a: Vector<2>, b: Vector<2>, extent: Extent) -> Result<Option<Repeat>> {
        let Some(mut lattice) = Lattice::new(a, b) else { return Ok(None) };
        let mut fit = None;
        for _ in 0..2 {
            let next = self.fit(&lattice)?;
            if extent == Extent::Plane {
                lattice = Lattice::new(next.vectors[0], next.vectors[1]).unwrap_or(lattice);
            } else {
                // Only the vector that was found is fitted.
                let k = usize::from(are_parallel(lattice.vectors[1], a));
                lattice.vectors[k] = next.vectors[k];
            }
            fit = Some(next);
        }
        let Some(fit) = fit else { return Ok(None) };
        let shorter = lattice.shorter();
        let explains = if self.mode.kinds.is_of_places() { Explains::Places } else { Explains::Everything };
        // Where marks lie about where they should, a cell of many of them is a chance to find all at once.
        let in_cell = marks_in(self.marks, &lattice);
        let sound = fit.jitter <= JITTER * shorter && (self.mode.tolerance <= EXACT || in_cell <= FEW_IN_CELL);
        let (anchor, jitter, share) = (self.mode.anchor, fit.jitter, fit.share);
        Ok(sound.then_some(Repeat { lattice, explains, extent, anchor, jitter, share }))
    }

    /// Walks from mark to mark and fits the vectors to all of them by least squares.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn fit(&self, lattice: &Lattice) -> Result<Fit> {
        let marks = self.marks;
        let window = marks.window.grown(1e-6 * self.side);
        let tolerance = self.tolerance();
        let mut node: Vec<Option<[i64; 2]>> = vec![None; marks.all.len()];
        let mut sums = Sums::default();
        let (mut seen, mut found) = (0_usize, 0_usize);
        let mut meter = self.budget.meter();
        for start in 0..marks.all.len() {
            if node[start].is_some() || marks.all[start].is_context {
                continue;
            }
            node[start] = Some([0, 0]);
            let mut walk = vec![(start, [0_i64, 0])];
            let mut next = 0;
            while let Some(&(i, at)) = walk.get(next) {
                next += 1;
                let mark = marks.all[i];
                if mark.is_context {
                    continue;
                }
                for step in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
                    let by = lattice.at(step);
                    let (partner, looked) = marks.find(mark.place + by, mark.kind, tolerance);
                    meter.spend(8 * (4 + looked))?;
                    let is_unknown = || mark.element.is_none() && marks.unknown.contains(mark.place + by);
                    let is_in = window.contains(mark.extent.min + by) && window.contains(mark.extent.max + by);
                    if is_in && (partner.is_some() || !is_unknown()) {
                        seen += 1;
                        found += usize::from(partner.is_some());
                    }
                    let there = [at[0] + step[0], at[1] + step[1]];
                    // What the frame has cut is not where it would be as a whole.
                    if let Some(j) = partner.filter(|&j| node[j].is_none() && !marks.all[j].is_context) {
                        node[j] = Some(there);
                        walk.push((j, there));
                    }
                }
            }
            sums.add(&walk.iter().map(|&(i, n)| (n, marks.all[i].place)).collect::<Vec<_>>());
        }
        let vectors = sums.vectors().unwrap_or(lattice.vectors);
        let jitter = sums.jitter(&vectors);
        Ok(Fit { vectors, jitter, share: found as f64 / seen.max(1) as f64, pairs: found })
    }
}

/// Mean number of marks in a cell.
pub(crate) fn marks_in(marks: &Marks, lattice: &Lattice) -> f64 {
    marks.all.len() as f64 * lattice.cell() / marks.window.measure()
}

/// Whether two vectors span nothing but multiples of one, as nearly as `within`.
fn are_one(a: Vector<2>, b: Vector<2>, within: f64) -> bool {
    Lattice::new(a, b).is_none_or(|lattice| lattice.vectors.iter().any(|v| v.norm() < within))
}
