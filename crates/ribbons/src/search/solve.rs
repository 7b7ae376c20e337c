//! The whole dynamic programme along one curve, open or closed [Zhou 2013 §1.4, §1.5].

use std::sync::Arc;

use arabesque_core::{Budget, Error, Held, Result};

use crate::{
    constraints::valid::{Demands, Grade, Position, Site},
    exemplar::columns::Columns,
    exemplar::strip::Strip,
    geometry::cage::Form,
    params::{Closing, RibbonParams, Search},
    search::reuse::{Reuse, Trail},
    search::row::{NONE, Row, Step},
};

/// One curve, ready to be searched.
#[derive(Debug)]
pub(crate) struct Course<'a> {
    pub(crate) strip: &'a Strip,
    pub(crate) params: &'a RibbonParams,
    /// The pieces.
    pub(crate) forms: &'a [Form],
    /// What is asked of each.
    pub(crate) demands: &'a [Demands],
    pub(crate) closed: bool,
    pub(crate) reuse: Reuse,
    /// What errors call the curve, and where on the canvas each piece is.
    pub(crate) name: &'a str,
    pub(crate) places: &'a [String],
    pub(crate) budget: &'a Budget,
}

/// A row, with what it was computed from, so that a later run can tell whether it still holds.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    form: Form,
    demands: Demands,
    grade: Grade,
    row: Arc<Row>,
}

/// The best way along a curve, or along as much of it as was reached.
#[derive(Debug)]
pub(crate) struct Solution {
    /// A position for each piece.
    pub(crate) positions: Vec<Position>,
    /// Ω plus what re-use and variety add.
    pub(crate) cost: f64,
    /// Pieces at which a rule had to be broken.
    pub(crate) forced: Vec<(usize, Grade)>,
    /// The rows, for another run.
    pub(crate) kept: Vec<Kept>,
    /// Rows that were taken over from the run before.
    pub(crate) resumed: usize,
    /// Why it ended early, if it did.
    pub(crate) ended: Option<Ended>,
}

/// Why a run ended before it was done.
#[derive(Debug)]
pub(crate) enum Ended {
    /// Whoever watched it had enough.
    Watch,
    /// The budget is used up, or somebody asked to stop.
    Budget(Error),
}

impl Ended {
    /// That of an error after which what was done so far is still good; other errors stay errors.
    pub(crate) fn of(error: Error) -> Result<Self> {
        match error {
            Error::Limit { .. } | Error::Stopped { .. } => Ok(Self::Budget(error)),
            other => Err(other),
        }
    }
}

/// Told after each row: the number of rows done and, on demand, the best positions so far. Answers whether to go on.
pub(crate) type Watch<'a> = dyn FnMut(usize, f64, &dyn Fn() -> Vec<Position>) -> bool + 'a;

impl Course<'_> {
    /// Rows of the table: one per piece, and on a closed curve the first piece once more.
    fn rows(&self) -> usize {
        self.forms.len() + usize::from(self.closed)
    }

    /// The piece that row `k` is about.
    fn piece(&self, k: usize) -> usize {
        k % self.forms.len()
    }

    /// Valid positions of a piece by the strictest grade that has any.
    fn valid(&self, piece: usize) -> Result<(Grade, Vec<Position>)> {
        let site = self.site(piece);
        let grades = if self.params.relax { &Grade::ALL[..] } else { &Grade::ALL[..1] };
        for &grade in grades {
            let found = site.positions(grade)?;
            if !found.is_empty() {
                return Ok((grade, found));
            }
        }
        Err(self.nowhere(piece)?)
    }

    fn site(&self, piece: usize) -> Site<'_> {
        let (form, demands) = (&self.forms[piece], &self.demands[piece]);
        Site { strip: self.strip, form, demands, budget: self.budget }
    }

    /// Why no position is valid, and what to do about it.
    fn nowhere(&self, piece: usize) -> Result<Error> {
        let (demands, site) = (&self.demands[piece], self.site(piece));
        let mut fit = [false; Grade::ALL.len()];
        for (fits, grade) in fit.iter_mut().zip(Grade::ALL) {
            *fits = site.has_any(demands.rows.as_ref(), grade)?;
        }
        let fits = |grade: Grade| fit[grade as usize];
        let reason = if fits(Grade::Forbidden) {
            "every way through it puts the pattern on a place to avoid or on a fold of the ribbon"
        } else if fits(Grade::Cut) {
            "the ribbon is too narrow for the pattern, or too tightly bent"
        } else if fits(Grade::Any) {
            "the pattern has gaps as long as the piece"
        } else {
            "the piece is longer than the part of the exemplar that it may show"
        };
        let n = self.forms.len();
        let problem = format!(
            "{}: piece {} of {n}, at {}, has no valid position: {reason}",
            self.name,
            piece + 1,
            self.places[piece]
        );
        let advice = match () {
            () if fits(Grade::Forbidden) => {
                "avoid less, bend the curve less, or let the pattern be cut there with --relax"
            }
            () if fits(Grade::Cut) => "change --width or --scale, or let the pattern be cut there with --relax",
            () if self.params.relax => "use shorter pieces (--step), or bend the curve less",
            () => "use shorter pieces (--step), bend the curve less, or let the pattern be cut there with --relax",
        };
        Ok(Error::no_result(problem, advice))
    }

    /// The best way. Rows of `before` that would come out the same are taken over.
    pub(crate) fn solve(&self, before: &[Kept], watch: &mut Watch<'_>) -> Result<Solution> {
        let mut table = Table::new(self);
        let mut ended = None;
        for k in 0..self.rows() {
            match table.advance(before.get(k)) {
                Ok(()) => {}
                // Without a single piece there is nothing to show.
                Err(error) if k == 0 => return Err(error),
                Err(error) => {
                    ended = Some(Ended::of(error)?);
                    break;
                }
            }
            let row = &table.kept[k].row;
            let energy = row.cost[row.best()] / (k + 1) as f64;
            if !watch((k + 1).min(self.forms.len()), energy, &|| table.path(table.kept[k].row.best())) {
                ended = (k + 1 < self.rows()).then_some(Ended::Watch);
                break;
            }
        }
        if ended.is_some() || !self.closed || table.kept.len() < self.rows() {
            return Ok(table.finish(ended));
        }
        self.close(table)
    }

    /// The best cycle [Zhou 2013 §1.5].
    fn close(&self, table: Table<'_>) -> Result<Solution> {
        let Some(last) = table.kept.last().map(|k| Arc::clone(&k.row)) else { return Ok(table.finish(None)) };
        let cycle = (0..last.cost.len()).filter(|&u| last.start[u] == u as u32);
        let mut best =
            cycle.min_by(|&a, &b| last.cost[a].total_cmp(&last.cost[b])).map(|u| (last.cost[u], table.path(u)));
        let ended = self.cycles(&table, &last, &mut best).err().map(Ended::of).transpose()?;
        let Some((cost, mut path)) = best else { return Ok(table.finish(ended)) };
        path.truncate(self.forms.len());
        let mut solution = table.finish(ended);
        (solution.cost, solution.positions) = (cost, path);
        Ok(solution)
    }

    /// Looks for cycles that are better than `best`, from the most promising start on.
    fn cycles(&self, table: &Table<'_>, last: &Row, best: &mut Option<(f64, Vec<Position>)>) -> Result<()> {
        let bounds = self.bounds_of_cycles(last)?;
        let mut starts: Vec<usize> = (0..last.cost.len()).collect();
        starts.sort_by(|&a, &b| bounds[a].total_cmp(&bounds[b]).then(a.cmp(&b)));
        for start in starts {
            let hopeless = best.as_ref().is_some_and(|(cost, _)| bounds[start] >= *cost);
            if hopeless || (self.params.closing == Closing::Quick && best.is_some()) {
                break;
            }
            let (cost, path) = self.cycle_through(table, start)?;
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                *best = Some((cost, path));
            }
        }
        Ok(())
    }

    /// For each position of the terminal piece, a cost that no cycle through it falls below.
    fn bounds_of_cycles(&self, last: &Row) -> Result<Vec<f64>> {
        if self.params.closing == Closing::Quick || self.params.repetition == 0.0 {
            return Ok(last.cost.clone());
        }
        // Re-use depends on the path behind, so that P bounds nothing; without it, P does.
        let params = RibbonParams { repetition: 0.0, ..self.params.clone() };
        let free = Course {
            params: &params,
            reuse: self.reuse.without_repetition(),
            places: self.places,
            demands: self.demands,
            ..*self
        };
        let mut table = Table::new(&free);
        for _ in 0..self.rows() {
            table.advance(None)?;
        }
        Ok(table.kept.last().map_or_else(Vec::new, |k| k.row.cost.clone()))
    }

    /// The best cycle through position `start` of the first piece.
    fn cycle_through(&self, table: &Table<'_>, start: usize) -> Result<(f64, Vec<Position>)> {
        let first = &table.kept[0];
        let only = Arc::new(vec![first.row.positions[start]]);
        let row = Row::first(only, &self.reuse, first.form.foot[1], self.budget)?;
        let trails = row.positions.iter().map(|p| Trail::default().followed_by(p.x)).collect();
        let kept = Kept { row: Arc::new(row), demands: first.demands.clone(), ..*first };
        let mut again = Table { kept: vec![kept], trails, ..Table::new(self) };
        for _ in 1..self.rows() {
            again.advance(None)?;
        }
        let last = &again.kept[self.forms.len()].row;
        Ok((last.cost[start], again.path(start)))
    }
}

/// The rows so far.
struct Table<'a> {
    course: &'a Course<'a>,
    kept: Vec<Kept>,
    /// What the paths into the last row have shown.
    trails: Vec<Trail>,
    /// The memory of the trails.
    held: Option<Held>,
    resumed: usize,
}

impl<'a> Table<'a> {
    fn new(course: &'a Course<'a>) -> Self {
        Self { course, kept: Vec::new(), trails: Vec::new(), held: None, resumed: 0 }
    }
    /// One row more; `before` is that row of an earlier run.
    fn advance(&mut self, before: Option<&Kept>) -> Result<()> {
        let course = self.course;
        let k = self.kept.len();
        let piece = course.piece(k);
        let (form, demands) = (course.forms[piece], &course.demands[piece]);
        let unchanged = self.resumed == k;
        if let Some(kept) = before.filter(|b| unchanged && b.form == form && b.demands == *demands) {
            self.follow(&kept.row)?;
            self.kept.push(kept.clone());
            self.resumed += 1;
            return Ok(());
        }
        let (grade, valid) = course.valid(piece)?;
        let positions = Arc::new(valid);
        let row = match self.kept.last() {
            None => Row::first(positions, &course.reuse, form.foot[1], course.budget)?,
            Some(last) => self.next(last, piece, positions)?,
        };
        self.follow(&row)?;
        self.kept.push(Kept { form, demands: demands.clone(), grade, row: Arc::new(row) });
        Ok(())
    }

    fn next(&self, last: &Kept, piece: usize, positions: Arc<Vec<Position>>) -> Result<Row> {
        let (strip, form, budget) = (self.course.strip, &self.course.forms[piece], self.course.budget);
        let context = self.course.params.context;
        let (right, left) = rayon::join(
            || Columns::right(strip, (&last.form, form.rows()), context, &last.row.positions, budget),
            || Columns::left(strip, form, context, &positions, budget),
        );
        let (right, left) = (right?, left?);
        let natural = form.foot * 0.5 - last.form.exit();
        let natural = (natural[0].round() as i64, natural[1].round() as i64);
        // The terminal piece is the first one, whose preference is counted there.
        let none = Reuse::default();
        let reuse = if self.kept.len() < self.course.forms.len() { &self.course.reuse } else { &none };
        let before = &*last.row;
        let step = Step {
            before,
            trails: &self.trails,
            right: &right,
            positions,
            left: &left,
            depth: form.foot[1],
            natural,
            reuse,
            piece,
            budget,
        };
        match self.course.params.search {
            Search::Bounded => step.bounded(),
            Search::Exhaustive => step.exhaustive(),
        }
    }

    /// Brings the trails to `row`.
    fn follow(&mut self, row: &Row) -> Result<()> {
        let bytes = row.positions.len() * size_of::<Trail>();
        let held = self.course.budget.hold("what the paths so far have shown", bytes)?;
        let trail = |(p, &from): (&Position, &u32)| {
            if from == NONE { Trail::default().followed_by(p.x) } else { self.trails[from as usize].followed_by(p.x) }
        };
        self.trails = row.positions.iter().zip(&row.back).map(trail).collect();
        self.held = Some(held);
        Ok(())
    }

    /// The path that ends at position `end` of the last row.
    fn path(&self, end: usize) -> Vec<Position> {
        let mut at = end as u32;
        let mut path: Vec<Position> = self
            .kept
            .iter()
            .rev()
            .map(|kept| {
                let position = kept.row.positions[at as usize];
                at = kept.row.back[at as usize];
                position
            })
            .collect();
        path.reverse();
        path
    }

    fn finish(self, ended: Option<Ended>) -> Solution {
        let end = self.kept.last().map_or(0, |k| k.row.best());
        let cost = self.kept.last().map_or(0.0, |k| k.row.cost[end]);
        let mut positions = self.path(end);
        positions.truncate(self.course.forms.len());
        let forced = self.kept.iter().take(self.course.forms.len()).enumerate();
        let forced = forced.filter(|(_, k)| k.grade != Grade::Whole).map(|(k, kept)| (k, kept.grade)).collect();
        Solution { positions, cost, forced, resumed: self.resumed, kept: self.kept, ended }
    }
}
