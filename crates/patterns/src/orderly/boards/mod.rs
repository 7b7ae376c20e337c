//! Boards in rows: floors of planks, walls of stones of one height, whose joints lie anywhere.
//!
//! Whole boards are laid end to end, row by row. Each is one of the exemplar that lies over such joints and beside such boards as it
//! does there.

mod find;
mod lay;
#[cfg(test)]
mod tests;

use arabesque_core::{
    Border, Budget, Domain, Error, Exemplar, Outcome, Placement, Progress, Request, Result, Similarity, Snapshot,
    StopReason, Watch,
};

use crate::{
    ending::heard,
    exemplar::checks,
    obstacles::obstacles,
    regular::{
        admit::{Admission, outline_of},
        grid::Grid,
    },
    repeat::{Lattice, Repeat},
};
use find::Courses;
use lay::{Laid, Laying};

/// Work for a board, for the forecast.
const PER_BOARD: f64 = 1e5;

/// An exemplar of boards in rows, ready for any number of runs.
#[derive(Clone, Debug)]
pub(crate) struct Boards {
    courses: Courses,
    /// Rows and boards of mean size, by which a page is laid on the exemplar.
    repeat: Repeat,
}

impl Boards {
    /// Finds the rows; `None` where there are none.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let Some(courses) = Courses::find(exemplar, &budget.stage("looking for rows of boards"))? else {
            return Ok(None);
        };
        let count = courses.rows.len() as f64;
        let height = courses.rows.iter().map(|row| row.high - row.low).sum::<f64>() / count + courses.gaps[1];
        let boards = courses.rows.iter().flat_map(|row| &row.boards);
        let (sum, number) = boards.fold((0.0, 0.0), |(sum, n), board| (sum + board.to - board.from, n + 1.0));
        let vectors = [courses.along * (sum / f64::max(number, 1.0)), courses.across * height];
        let Some(lattice) = Lattice::new(vectors[0], vectors[1]) else { return Ok(None) };
        Ok(Some(Self { courses, repeat: Repeat::drawn(lattice) }))
    }

    /// Fills a domain; `None` for a tile, whose rows have to close, and where fields bend rows or something stays.
    ///
    /// # Errors
    /// As for [`crate::Prepared::run`].
    pub(crate) fn fill(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Outcome<2>>> {
        let is_tile = matches!(request.domain, Domain::Torus(_));
        let stays = !request.frozen.is_empty() || request.known.is_some();
        if is_tile || stays || matches!(request.border, Border::Turn | Border::Inside) {
            return Ok(None);
        }
        let Ok(grid) = Grid::new(&self.repeat, exemplar, request) else { return Ok(None) };
        if (grid.scale() / grid.element_scale - 1.0).abs() > 1e-9 {
            return Ok(None);
        }
        let count = request.domain.measure() / grid.lattice.cell();
        checks::expected(count, &request.budget)?;
        request.budget.allow_elements(count);
        watch.foreseen(&request.budget.forecast(count, count * PER_BOARD));
        let budget = &request.budget.stage("laying boards");
        let [along, across] = grid.ranges(&request.domain, [self.courses.along, self.courses.across]);
        let laid = Laying::new(&self.courses).rows(across, along, request.seed, budget)?;
        let placements = self.placements(&laid, exemplar, (&grid, request), budget)?;
        if placements.is_empty() {
            let advice = "make the domain larger, lower the scale, or allow elements to cross its border";
            return Err(Error::no_result("no element fits into the domain", advice));
        }
        let count = placements.len();
        let made = Progress { stage: "laying boards".into(), done: 1, total: 1, fraction: 1.0, energy: None, count };
        let preview = || Snapshot { placements: placements.clone(), ..Snapshot::default() };
        let stopped = match heard(watch.step(&made, &preview), &made) {
            Ok(()) => StopReason::Finished,
            Err(_) => StopReason::Stopped,
        };
        let (sequence, curves, areas, energy, warnings) = Default::default();
        Ok(Some(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    fn placements(
        &self,
        laid: &[(f64, Vec<Laid>)],
        exemplar: &Exemplar<2>,
        (grid, request): (&Grid, &Request<2>),
        budget: &Budget,
    ) -> Result<Vec<Placement<2>>> {
        let obstacles = obstacles(request)?;
        let admission = Admission::new(request, obstacles.as_ref(), Vec::new());
        let mut made = Vec::new();
        for (low, row) in laid {
            for board in row {
                let source = board.board.element as usize;
                let centre = exemplar.elements[source].centre;
                let moved = self.courses.along * (board.from - board.board.from)
                    + self.courses.across * (low - self.courses.rows[board.row].low);
                let at = grid.place(centre + moved, [0, 0]);
                let transform = Similarity::about(centre, at, grid.rotation, grid.element_scale);
                let placement = Placement { source, transform, control: Vec::new(), frozen: None };
                if admission.admits(&outline_of(&placement, exemplar), at, budget)? {
                    made.push(placement);
                }
            }
        }
        Ok(made)
    }
}
