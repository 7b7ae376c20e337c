//! Finding the repeat of an exemplar.

use std::cell::OnceCell;

use arabesque_core::{Budget, Exemplar, Result, Vector};

use crate::repeat::{
    description::{Extent, Repeat},
    lattice::Lattice,
    lines::Lines,
    marks::{Anchor, Kinds, Mark, Marks},
    near::rows::{Near, near},
    offsets::search::{EXACT, FEW, MANY, Mode, NEAR, ROWS, Search, marks_in},
    stacking::Stacking,
    straight,
    support::LineIndex,
    unknown::drawn,
};

/// How far a period may lie from a lattice within it, as a share of its sides: coordinates are rounded.
const ROUNDED: f64 = 1e-3;

/// What looks alike, exactly.
const BY_LOOKS: Mode = Mode { kinds: Kinds::Looks, anchor: Anchor::Centre, tolerance: EXACT, least: 3, seen: FEW };

/// A way of finding a repeat.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// By offsets that marks share.
    Offsets(Mode),
    /// By rows that places keep to all over the drawing; `true`: where what looks alike comes again.
    Rows(bool),
}

const fn offsets(kinds: Kinds, anchor: Anchor, tolerance: f64, least: usize, seen: (usize, f64)) -> Way {
    Way::Offsets(Mode { kinds, anchor, tolerance, least, seen })
}

/// The ways, in the order of how much they explain.
const WAYS: [Way; 10] = [
    offsets(Kinds::Looks, Anchor::Centre, EXACT, 3, FEW),
    Way::Rows(true),
    offsets(Kinds::Looks, Anchor::Centre, NEAR, 16, MANY),
    offsets(Kinds::Shapes, Anchor::Centre, EXACT, 9, FEW),
    offsets(Kinds::Any, Anchor::Centre, EXACT, 9, FEW),
    offsets(Kinds::Any, Anchor::Box, EXACT, 9, FEW),
    Way::Rows(false),
    offsets(Kinds::Classes, Anchor::Centre, NEAR, 16, MANY),
    offsets(Kinds::Any, Anchor::Centre, NEAR, 16, MANY),
    offsets(Kinds::Any, Anchor::Box, NEAR, 16, MANY),
];

impl Way {
    fn is_exact(self) -> bool {
        matches!(self, Self::Offsets(mode) if mode.tolerance <= EXACT)
    }
}

/// So many marks in a cell may be there because of one that is odd.
const MANY_IN_CELL: f64 = 3.5;

/// More jitter than this, in mean distances of marks, was made by a hand. A lattice that was found by looking exactly may then be
/// one that some marks keep to by chance, with a smaller one in it, of at most this share of its cell.
const BY_HAND: f64 = 0.002;
const SMALLER: f64 = 0.7;

/// Share of the places at which the shapes come again, at least: with fewer, shapes differ by hand.
const OF_SHAPES: f64 = 0.97;

/// Elements that take one another's places where they lie about where they should differ by less than this in size.
const OF_A_SIZE: f64 = 4.0;

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
    let (lines, index, stacking) = (&lines, &index, stacking.as_ref());
    let finder = Finder { exemplar, lines, index, stacking, budget, rows: OnceCell::new() };
    if let Some(period) = exemplar.period {
        return finder.within_period(period, make);
    }
    for way in WAYS {
        // Lines either go over into themselves or they do not.
        if !way.is_exact() && !lines.is_empty() || way.is_exact() && doubtful.is_some() {
            continue;
        }
        let Some(found) = finder.found(way)? else { continue };
        let tried = match doubtful.take() {
            None if way.is_exact() && lines.is_empty() && found.is_by_hand => {
                doubtful = Some(found.repeat);
                continue;
            }
            None => vec![found.repeat],
            Some(large) if found.repeat.lattice.cell() > SMALLER * large.lattice.cell() => vec![large, found.repeat],
            Some(large) => vec![found.repeat, large],
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
        return match straight::stripes(lines, index, budget)? {
            Some(found) => make(&found),
            None => Ok(None),
        };
    }
    Ok(None)
}

/// What one of the ways has found.
struct Found {
    repeat: Repeat,
    /// Whether it has more jitter than a construction.
    is_by_hand: bool,
}

/// An exemplar, to be looked at in one way after the other.
struct Finder<'a> {
    exemplar: &'a Exemplar<2>,
    lines: &'a Lines,
    index: &'a LineIndex<'a>,
    /// What lies on what.
    stacking: Option<&'a Stacking>,
    budget: &'a Budget,
    /// The rows that its places keep to, once they were looked for.
    rows: OnceCell<Option<Near>>,
}

impl Finder<'_> {
    fn rows(&self) -> Result<Option<&Near>> {
        if self.rows.get().is_none() {
            let _ = self.rows.set(near(self.exemplar, self.budget)?);
        }
        Ok(self.rows.get().and_then(Option::as_ref))
    }

    /// What one of the repeats gives that a drawing of one period has: the smaller one that looks tell of, or the period itself.
    fn within_period<T>(
        &self,
        [a, b]: [Vector<2>; 2],
        mut make: impl FnMut(&Repeat) -> Result<Option<T>>,
    ) -> Result<Option<T>> {
        let Some(lattice) = Lattice::new(a, b) else { return Ok(None) };
        let slack = ROUNDED * (a.norm() + b.norm());
        let holds = |repeat: &Repeat| [a, b].into_iter().all(|v| repeat.lattice.nearest(v).1.norm() <= slack);
        if let Some(Found { repeat, is_by_hand: false }) = self.by_offsets(BY_LOOKS)?
            && repeat.extent == Extent::Plane
            && holds(&repeat)
            && let Some(made) = make(&repeat)?
        {
            return Ok(Some(made));
        }
        make(&Repeat::drawn(lattice))
    }

    fn found(&self, way: Way) -> Result<Option<Found>> {
        match way {
            Way::Offsets(mode) => self.by_offsets(mode),
            Way::Rows(by_looks) => {
                let found = self.rows()?.filter(|near| near.by_looks == by_looks);
                Ok(found.map(|near| Found { repeat: near.repeat.clone(), is_by_hand: true }))
            }
        }
    }

    fn by_offsets(&self, mode: Mode) -> Result<Option<Found>> {
        let (exemplar, lines, budget) = (self.exemplar, self.lines, self.budget);
        // Dots between flowers are no flowers: what lies at such places is not left to chance.
        if mode.kinds == Kinds::Any && mode.tolerance > EXACT && are_of_all_sizes(exemplar) {
            return Ok(None);
        }
        let Some(marks) = Marks::new(exemplar, lines, mode.kinds, mode.anchor, budget)? else { return Ok(None) };
        if marks.all.len() < mode.least {
            return Ok(None);
        }
        let order = self.stacking.filter(|_| !mode.kinds.is_of_places());
        let search = Search { marks: &marks, lines: self.index, order, mode, side: exemplar.view().side(), budget };
        let mut found = search.lattice()?;
        let search = Search { order: None, ..search };
        if found.is_none() && order.is_some() {
            found = search.lattice()?;
        }
        if mode.kinds == Kinds::Looks && mode.tolerance <= EXACT && lines.is_empty() {
            found = self.within_margins(&marks, mode, found)?;
        }
        let Some(mut found) = found else { return Ok(None) };
        if mode.kinds == Kinds::Shapes && (found.share < OF_SHAPES || !self.says_all_of_places(mode, &found)?) {
            return Ok(None);
        }
        if mode.kinds == Kinds::Any && mode.anchor == Anchor::Centre {
            // Different things are aligned by their boxes as often as by their centres.
            let by_box = Mode { anchor: Anchor::Box, ..mode };
            let marks = Marks::new(exemplar, lines, mode.kinds, Anchor::Box, budget)?;
            if let Some(marks) = &marks
                && let Some(other) = (Search { marks, mode: by_box, ..search }).lattice()?
                && prefers(&other, &found)
            {
                found = other;
            }
        }
        if mode.kinds == Kinds::Any {
            found = self.fitted_by_looks(found)?;
        }
        if mode.tolerance <= EXACT && lines.is_empty() && marks_in(&marks, &found.lattice) >= MANY_IN_CELL {
            found = match mode.kinds {
                Kinds::Any => self.of_single_places(found)?,
                Kinds::Shapes => found,
                Kinds::Looks | Kinds::Classes => self.but_for_odd_ones(&marks, found)?,
            };
        }
        let is_by_hand = found.jitter > BY_HAND * marks.unit;
        Ok(Some(Found { repeat: found, is_by_hand }))
    }

    /// Whether the repeat of shapes goes in as many directions as that of places does.
    fn says_all_of_places(&self, mode: Mode, found: &Repeat) -> Result<bool> {
        if found.extent == Extent::Plane {
            return Ok(true);
        }
        let places = self.by_offsets(Mode { kinds: Kinds::Any, ..mode })?;
        Ok(places.is_none_or(|places| places.repeat.extent != Extent::Plane))
    }

    /// What repeats where it is drawn, with a margin around that says nothing.
    fn within_margins(&self, marks: &Marks, mode: Mode, found: Option<Repeat>) -> Result<Option<Repeat>> {
        if found.as_ref().is_some_and(|repeat| repeat.extent == Extent::Plane) {
            return Ok(found);
        }
        let Some(drawn) = drawn(self.exemplar) else { return Ok(found) };
        let marks = marks.seen_in(drawn);
        let mode = Mode { seen: ROWS, ..mode };
        let (order, side) = (self.stacking.filter(|_| mode.kinds != Kinds::Any), self.exemplar.view().side());
        let search = Search { marks: &marks, lines: self.index, order, mode, side, budget: self.budget };
        let Some(other) = search.lattice()? else { return Ok(found) };
        match other.step(&drawn) {
            None => Ok(Some(other)),
            Some(_) if found.is_some() => Ok(found),
            Some(step) => {
                let mut across = self.exemplar.window.size();
                across[usize::from(step[1].abs() > step[0].abs())] = 0.0;
                Ok(Lattice::new(step, across).map(|lattice| Repeat { lattice, ..other }))
            }
        }
    }

    /// The lattice that has one place in each cell, where there is one: where things are missing, a longer vector is met that
    /// happens to miss none.
    fn of_single_places(&self, found: Repeat) -> Result<Repeat> {
        let single = self.rows()?.map(|near| &near.repeat);
        let is_smaller = |repeat: &&Repeat| repeat.lattice.cell() < SMALLER * found.lattice.cell();
        Ok(single.filter(is_smaller).cloned().unwrap_or(found))
    }

    /// The repeat of all but a few odd things, where a longer one was found that takes none of these to another like it: nothing
    /// says that they come back.
    fn but_for_odd_ones(&self, marks: &Marks, found: Repeat) -> Result<Repeat> {
        let Some(Near { repeat, odd, by_looks }) = self.rows()? else { return Ok(found) };
        let is_smaller = repeat.lattice.cell() < SMALLER * found.lattice.cell();
        if !by_looks || !is_smaller || repeat.jitter > BY_HAND * marks.unit {
            return Ok(found);
        }
        let mark = |e: &usize| marks.all.iter().find(|mark| mark.element == Some(*e as u32));
        let odd: Vec<&Mark> = odd.iter().filter_map(mark).collect();
        let slack = EXACT * marks.unit;
        let comes_back = odd.iter().enumerate().any(|(k, one)| {
            let others = odd[k + 1..].iter().filter(|other| other.kind == one.kind);
            others.map(|other| found.lattice.nearest(other.place - one.place).1).any(|rest| rest.norm() <= slack)
        });
        Ok(if comes_back { found } else { repeat.clone() })
    }

    /// A lattice of places, its vectors fitted to things of one look: the middles of different ones lie differently at
    /// their places.
    fn fitted_by_looks(&self, found: Repeat) -> Result<Repeat> {
        let marks = Marks::new(self.exemplar, self.lines, Kinds::Looks, Anchor::Centre, self.budget)?;
        let Some(marks) = marks else { return Ok(found) };
        let side = self.exemplar.view().side();
        let (mode, order) = (BY_LOOKS, None);
        let search = Search { marks: &marks, lines: self.index, order, mode, side, budget: self.budget };
        let fit = search.fit(&found.lattice)?;
        let better = fit.jitter < 0.5 * found.jitter && fit.pairs >= MANY.0;
        match Lattice::new(fit.vectors[0], fit.vectors[1]).filter(|_| better) {
            Some(lattice) => Ok(Repeat { lattice, jitter: fit.jitter, ..found }),
            None => Ok(found),
        }
    }
}

/// Whether a repeat says more than another: by a smaller cell, or by one as large and more exactly.
fn prefers(one: &Repeat, other: &Repeat) -> bool {
    let (cell, than) = (one.lattice.cell(), other.lattice.cell());
    cell < 0.8 * than || (cell < 1.2 * than && one.jitter < other.jitter)
}

/// Whether some elements are out of all proportion to others.
fn are_of_all_sizes(exemplar: &Exemplar<2>) -> bool {
    let radii = exemplar.elements.iter().map(|e| e.outline.radius(e.centre));
    let (low, high) = radii.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    high > OF_A_SIZE * low
}
