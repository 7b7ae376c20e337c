//! Finding the repeat of an exemplar.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Exemplar, Result, Vector};

use crate::repeat::{
    description::{Explains, Extent, Repeat},
    lattice::{Lattice, are_parallel},
    lines::Lines,
    marks::{Anchor, Kinds, Mark, Marks},
    stacking::Stacking,
    straight,
    support::{LineIndex, is_supported},
};

/// A way of comparing marks.
#[derive(Clone, Copy, Debug)]
struct Mode {
    kinds: Kinds,
    anchor: Anchor,
    /// How far partners may lie off, in mean distances of marks.
    tolerance: f64,
    /// Fewest marks with which this can be trusted.
    least: usize,
    /// Fewest marks that a translation takes to others, as a number and as a share of all.
    seen: (usize, f64),
}

/// So few partners are no chance where they have to be in place exactly.
const FEW: (usize, f64) = (2, 0.12);
/// Where they may be about there.
const MANY: (usize, f64) = (10, 0.3);

/// Rounding of coordinates, and drawing by hand.
const EXACT: f64 = 0.02;
const NEAR: f64 = 0.2;

/// The ways of comparing, in the order of how much they explain.
const MODES: [Mode; 7] = [
    Mode { kinds: Kinds::Looks, anchor: Anchor::Centre, tolerance: EXACT, least: 3, seen: FEW },
    Mode { kinds: Kinds::Looks, anchor: Anchor::Centre, tolerance: NEAR, least: 16, seen: MANY },
    Mode { kinds: Kinds::Any, anchor: Anchor::Centre, tolerance: EXACT, least: 9, seen: FEW },
    Mode { kinds: Kinds::Any, anchor: Anchor::Box, tolerance: EXACT, least: 9, seen: FEW },
    Mode { kinds: Kinds::Classes, anchor: Anchor::Centre, tolerance: NEAR, least: 16, seen: MANY },
    Mode { kinds: Kinds::Any, anchor: Anchor::Centre, tolerance: NEAR, least: 16, seen: MANY },
    Mode { kinds: Kinds::Any, anchor: Anchor::Box, tolerance: NEAR, least: 16, seen: MANY },
];

/// Coordinates are taken to be rounded to this share of the side of the frame at worst.
const ROUNDING: f64 = 4e-4;

/// Marks from which offsets to all others are taken, at most, and so many of one kind.
const ANCHORS: (usize, usize) = (96, 24);

/// Offsets that are looked at more closely.
const CANDIDATES: usize = 40_000;

/// More jitter than this, in terms of the shorter vector, is no lattice.
const JITTER: f64 = 0.12;

/// Most marks in a cell where they lie about where they should.
const FEW_IN_CELL: f64 = 6.5;

/// More jitter than this, in mean distances of marks, was made by a hand. A lattice that was found by looking exactly may then be
/// one that some marks keep to by chance, with a smaller one in it, of at most this share of its cell.
const BY_HAND: f64 = 0.002;
const SMALLER: f64 = 0.7;

/// Elements that take one another's places where they lie about where they should differ by less than this in size.
const OF_A_SIZE: f64 = 4.0;

/// Work for each offset.
const OFFSET: u64 = 60;

/// The repeat of an exemplar, where it has one.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn find(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Repeat>> {
    find_for(exemplar, budget, |repeat| Ok(Some(repeat.clone())))
}

/// What the first repeat of an exemplar gives of which `make` makes something.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop, and what `make` gives.
pub(crate) fn find_for<T>(
    exemplar: &Exemplar<2>,
    budget: &Budget,
    mut make: impl FnMut(&Repeat) -> Result<Option<T>>,
) -> Result<Option<T>> {
    let budget = &budget.stage("finding the repeat");
    let lines = Lines::new(exemplar, budget)?;
    let index = LineIndex::new(&lines, exemplar.window, budget)?;
    let stacking = Stacking::new(exemplar, budget)?;
    let mut doubtful: Option<Repeat> = None;
    for mode in MODES {
        // Lines either go over into themselves or they do not.
        if mode.tolerance > EXACT && !lines.is_empty() || mode.tolerance <= EXACT && doubtful.is_some() {
            continue;
        }
        // Dots between flowers are no flowers: what lies at such places is not left to chance.
        if mode.kinds == Kinds::Any && mode.tolerance > EXACT && are_of_all_sizes(exemplar) {
            continue;
        }
        let Some(marks) = Marks::new(exemplar, &lines, mode.kinds, mode.anchor, budget)? else { continue };
        if marks.all.len() < mode.least {
            continue;
        }
        let order = stacking.as_ref().filter(|_| mode.kinds != Kinds::Any);
        let search = Search { marks: &marks, lines: &index, order, mode, side: exemplar.view().side(), budget };
        let in_order = search.lattice()?;
        let search = Search { order: None, ..search };
        let found = if in_order.is_none() && order.is_some() { search.lattice()? } else { in_order };
        let Some(mut found) = found else { continue };
        if mode.kinds == Kinds::Any && mode.anchor == Anchor::Centre {
            // Different things are aligned by their boxes as often as by their centres.
            let by_box = Mode { anchor: Anchor::Box, ..mode };
            let marks = Marks::new(exemplar, &lines, mode.kinds, Anchor::Box, budget)?;
            if let Some(marks) = &marks
                && let Some(other) = (Search { marks, mode: by_box, ..search }).lattice()?
                && prefers(&other, &found)
            {
                found = other;
            }
        }
        if mode.kinds == Kinds::Any {
            found = fitted_by_looks(exemplar, &lines, &index, found, budget)?;
        }
        let tried = match doubtful.take() {
            None if mode.tolerance <= EXACT && lines.is_empty() && found.jitter > BY_HAND * marks.unit => {
                doubtful = Some(found);
                continue;
            }
            None => vec![found],
            Some(large) if found.lattice.cell() > SMALLER * large.lattice.cell() => vec![large, found],
            Some(large) => vec![found, large],
        };
        for repeat in tried {
            if let Some(made) = make(&repeat)? {
                return Ok(Some(made));
            }
        }
    }
    if let Some(large) = doubtful
        && let Some(made) = make(&large)?
    {
        return Ok(Some(made));
    }
    if exemplar.elements.is_empty() {
        return match straight::stripes(&lines, &index, budget)? {
            Some(found) => make(&found),
            None => Ok(None),
        };
    }
    Ok(None)
}

/// Whether a repeat says more than another: by a smaller cell, or by one as large and more exactly.
fn prefers(one: &Repeat, other: &Repeat) -> bool {
    let (cell, than) = (one.lattice.cell(), other.lattice.cell());
    cell < 0.8 * than || (cell < 1.2 * than && one.jitter < other.jitter)
}

/// A lattice of places, its vectors fitted to things of one look: the middles of different ones lie differently at
/// their places.
fn fitted_by_looks(
    exemplar: &Exemplar<2>,
    lines: &Lines,
    index: &LineIndex<'_>,
    found: Repeat,
    budget: &Budget,
) -> Result<Repeat> {
    let Some(marks) = Marks::new(exemplar, lines, Kinds::Looks, Anchor::Centre, budget)? else { return Ok(found) };
    let (mode, order, side) = (MODES[0], None, exemplar.view().side());
    let search = Search { marks: &marks, lines: index, order, mode, side, budget };
    let fit = search.fit(&found.lattice)?;
    let better = fit.jitter < 0.5 * found.jitter && fit.pairs >= MANY.0;
    match Lattice::new(fit.vectors[0], fit.vectors[1]).filter(|_| better) {
        Some(lattice) => Ok(Repeat { lattice, jitter: fit.jitter, ..found }),
        None => Ok(found),
    }
}

/// Whether some elements are out of all proportion to others.
fn are_of_all_sizes(exemplar: &Exemplar<2>) -> bool {
    let radii = exemplar.elements.iter().map(|e| e.outline.radius(e.centre));
    let (low, high) = radii.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    high > OF_A_SIZE * low
}

/// The search in one way of comparing.
struct Search<'a> {
    marks: &'a Marks,
    lines: &'a LineIndex<'a>,
    /// What lies on what, where that has to be kept.
    order: Option<&'a Stacking>,
    mode: Mode,
    side: f64,
    budget: &'a Budget,
}

impl Search<'_> {
    fn tolerance(&self) -> f64 {
        (self.mode.tolerance * self.marks.unit).max(ROUNDING * self.side)
    }

    fn lattice(&self) -> Result<Option<Repeat>> {
        let tolerance = self.tolerance();
        let mut first: Option<Vector<2>> = None;
        for by in self.candidates()? {
            if first.is_some_and(|a| are_parallel(a, by)) {
                continue;
            }
            let holds = is_supported(self.marks, by, tolerance, self.mode.seen, self.budget)?
                && self.lines.supports(by, tolerance.min(0.01 * self.side), self.budget)?
                && self.order.map_or(Ok(true), |order| order.supports(self.marks, by, tolerance, self.budget))?;
            match (holds, first) {
                (false, _) => {}
                (true, None) => first = Some(by),
                // Two steps of about one vector differ by what is no vector at all.
                (true, Some(a)) if are_one(a, by, 2.0 * tolerance) => {}
                (true, Some(a)) => return self.refined(a, by, Extent::Plane),
            }
        }
        match first.filter(|_| self.mode.kinds == Kinds::Looks && self.mode.tolerance <= EXACT) {
            Some(a) => self.frieze(a),
            None => Ok(None),
        }
    }

    /// What repeats in one direction alone, along the frame and inside it.
    fn frieze(&self, a: Vector<2>) -> Result<Option<Repeat>> {
        let (window, size) = (self.marks.window, self.marks.window.size());
        let axis = usize::from(a[1].abs() > a[0].abs());
        let across = 1 - axis;
        let slack = 1e-6 * size.norm();
        let is_inside = |min: f64, max: f64| min >= window.min[across] - slack && max <= window.max[across] + slack;
        let along = a[across].abs() <= 1e-3 * a.norm();
        // What is cut at the sides shows that there is more beyond them.
        let is_cut = |m: &Mark| {
            let (low, high) = (m.extent.min[across] - window.min[across], window.max[across] - m.extent.max[across]);
            m.is_context && low.min(high) <= slack
        };
        let marks_inside =
            self.marks.all.iter().all(|m| is_inside(m.extent.min[across], m.extent.max[across]) && !is_cut(m));
        if !(along && marks_inside && self.lines.are_within_or_go_on(across)) {
            return Ok(None);
        }
        let mut b = Vector::ZERO;
        b[across] = size[across];
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
            self.budget.spend(OFFSET * (from.len() * kind.len()) as u64)?;
            for &i in &from {
                for &j in kind.iter().filter(|&&j| j != i) {
                    let offset = self.marks.all[j].place - self.marks.all[i].place;
                    let offset = if (offset[1], offset[0]) < (0.0, 0.0) { -offset } else { offset };
                    let key = ((offset[0] / cell).floor() as i64, (offset[1] / cell).floor() as i64);
                    let entry = votes.entry(key).or_insert((Vector::ZERO, 0));
                    *entry = (entry.0 + offset, entry.1 + 1);
                }
            }
        }
        let least = 0.02 * self.marks.unit;
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
        let explains = if self.mode.kinds == Kinds::Any { Explains::Places } else { Explains::Everything };
        // Where marks lie about where they should, a cell of many of them is a chance to find all at once.
        let in_cell = marks_in(self.marks, &lattice);
        let sound = fit.jitter <= JITTER * shorter && (self.mode.tolerance <= EXACT || in_cell <= FEW_IN_CELL);
        let (anchor, jitter, share) = (self.mode.anchor, fit.jitter, fit.share);
        Ok(sound.then_some(Repeat { lattice, explains, extent, anchor, jitter, share }))
    }

    /// Walks from mark to mark and fits the vectors to all of them by least squares.
    fn fit(&self, lattice: &Lattice) -> Result<Fit> {
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
fn marks_in(marks: &Marks, lattice: &Lattice) -> f64 {
    marks.all.len() as f64 * lattice.cell() / marks.window.measure()
}

/// Whether two vectors span nothing but multiples of one, as nearly as `within`.
fn are_one(a: Vector<2>, b: Vector<2>, within: f64) -> bool {
    Lattice::new(a, b).is_none_or(|lattice| lattice.vectors.iter().any(|v| v.norm() < within))
}

/// Fitted vectors, and how well they fit.
struct Fit {
    vectors: [Vector<2>; 2],
    jitter: f64,
    share: f64,
    /// Marks that were found from another.
    pairs: usize,
}

/// Normal equations of the vectors, over groups of marks each of which has an unknown origin.
#[derive(Default)]
struct Sums {
    /// Products of node coordinates.
    nodes: [[f64; 2]; 2],
    /// Products of node coordinates and places.
    places: [[f64; 2]; 2],
    /// Squares of places.
    squares: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, group: &[([i64; 2], Vector<2>)]) {
        let count = group.len() as f64;
        let mean = |k: usize| group.iter().map(|(n, _)| n[k] as f64).sum::<f64>() / count;
        let (m, origin) = ([mean(0), mean(1)], group[0].1);
        let centre = group.iter().fold(Vector::ZERO, |sum, (_, p)| sum + (*p - origin)) * (1.0 / count);
        for (n, p) in group {
            let (n, p) = ([n[0] as f64 - m[0], n[1] as f64 - m[1]], *p - origin - centre);
            for r in 0..2 {
                for c in 0..2 {
                    self.nodes[r][c] += n[r] * n[c];
                    self.places[r][c] += n[r] * p[c];
                }
            }
            self.squares += p.norm2();
            self.count += 1.0;
        }
    }

    fn vectors(&self) -> Option<[Vector<2>; 2]> {
        let [[a, b], [c, d]] = self.nodes;
        let measure = a * d - b * c;
        let solved = |r: [f64; 2]| -> Vector<2> {
            let of = |k: usize| (r[0] * self.places[0][k] + r[1] * self.places[1][k]) / measure;
            Vector::xy(of(0), of(1))
        };
        (measure > 1e-9 * (a + d).powi(2)).then(|| [solved([d, -b]), solved([-c, a])])
    }

    /// Root mean square distance from where the vectors have the marks.
    fn jitter(&self, vectors: &[Vector<2>; 2]) -> f64 {
        let mut sum = self.squares;
        for r in 0..2 {
            let place = Vector::xy(self.places[r][0], self.places[r][1]);
            sum -= 2.0 * vectors[r].dot(place);
            sum += (0..2).map(|c| vectors[r].dot(vectors[c]) * self.nodes[r][c]).sum::<f64>();
        }
        (sum.max(0.0) / self.count.max(1.0)).sqrt()
    }
}
