//! Laying boards row by row.

use arabesque_core::{Budget, Result, Stage, Stream};

use crate::orderly::boards::find::{Board, Course, Courses};

/// Draws of this module.
const LAY: Stage = Stage::new(13);

/// Joints lie from those of the row before as in the exemplar: what a difference of the height of a row costs, and what it costs at
/// most.
const BOND: (f64, f64) = (1.0, 1.0);
/// What it costs to lie beside, or over, another class than in the exemplar.
const BESIDE: f64 = 0.25;
/// What it costs where joints lie nearer to one another than nearly all of the exemplar's.
const NARROW: f64 = 3.0;
/// Share of the joints of the exemplar that may be that near.
const FEW: f64 = 0.05;
/// Costs within this of the least are as good.
const AS_GOOD: f64 = 0.12;
/// Work for each board that is tried.
const WORK: u64 = 40;

/// A board of the exemplar, and what lies around it there.
#[derive(Clone, Copy, Debug)]
struct Model {
    board: Board,
    row: usize,
    /// From its end to the nearest joint of the row before; `None` where that is not shown.
    bond: Option<f64>,
    /// Class of the board before it, and of that in the row before at its middle.
    before: Option<u32>,
    under: Option<u32>,
}

/// A board laid: row and board of the exemplar, and where it begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Laid {
    pub(crate) row: usize,
    pub(crate) board: Board,
    pub(crate) from: f64,
}

impl Laid {
    fn to(&self) -> f64 {
        self.from + self.board.to - self.board.from
    }
}

/// What is known for laying boards.
pub(crate) struct Laying<'a> {
    courses: &'a Courses,
    models: Vec<Model>,
    /// Kinds of rows by their height, one for each.
    kinds: Vec<usize>,
    /// Distance of joints that nearly all keep.
    least: f64,
    height: f64,
}

impl<'a> Laying<'a> {
    pub(crate) fn new(courses: &'a Courses) -> Self {
        let rows = &courses.rows;
        let height = rows.iter().map(|row| row.high - row.low).sum::<f64>() / rows.len().max(1) as f64;
        let mut models = Vec::new();
        for (r, row) in rows.iter().enumerate() {
            // Rows that are cut between two others are not known to follow one another.
            let below = r
                .checked_sub(1)
                .map(|b| &rows[b])
                .filter(|b| (row.low - b.high - courses.gaps[1]).abs() < 0.2 * height);
            for (k, board) in row.boards.iter().enumerate().filter(|(_, board)| board.is_whole) {
                let bond = below
                    .and_then(|below| nearest(below.boards.iter().map(|b| b.to), board.to))
                    .filter(|d| d.abs() < 8.0 * height);
                let before = k.checked_sub(1).map(|b| row.boards[b].class);
                let middle = 0.5 * (board.from + board.to);
                let under =
                    below.and_then(|b| b.boards.iter().find(|b| b.from <= middle && middle <= b.to)).map(|b| b.class);
                models.push(Model { board: *board, row: r, bond, before, under });
            }
        }
        let mut bonds: Vec<f64> = models.iter().filter_map(|m| m.bond.map(f64::abs)).collect();
        bonds.sort_by(f64::total_cmp);
        let least = bonds.get((FEW * bonds.len() as f64) as usize).copied().unwrap_or(0.0);
        let mut kinds: Vec<usize> = Vec::new();
        for (r, row) in rows.iter().enumerate() {
            let is_like = |other: &Course| ((other.high - other.low) - (row.high - row.low)).abs() < 0.03 * height;
            kinds.push((0..r).find(|&other| is_like(&rows[other])).unwrap_or(r));
        }
        Self { courses, models, kinds, least, height }
    }

    /// Rows that cover what lies between these places, across and along: for each where it begins across, and its boards.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn rows(
        &self,
        across: [f64; 2],
        along: [f64; 2],
        seed: u64,
        budget: &Budget,
    ) -> Result<Vec<(f64, Vec<Laid>)>> {
        let rows = &self.courses.rows;
        let step = |r: usize| rows[r].high - rows[r].low + self.courses.gaps[1];
        // Begins with the first row of the exemplar, where the page begins as it does.
        let (mut low, mut row) = (rows[0].low, 0);
        while low > across[0] {
            row = (row + rows.len() - 1) % rows.len();
            low -= step(row);
        }
        while low + step(row) < across[0] {
            low += step(row);
            row = (row + 1) % rows.len();
        }
        let mut made: Vec<(f64, Vec<Laid>)> = Vec::new();
        let mut number = 0;
        while low < across[1] {
            let mut stream = Stream::new(seed, LAY, number);
            let below = made.last().map(|(_, boards)| boards.as_slice()).unwrap_or_default();
            made.push((low, self.row(self.kinds[row], below, along, &mut stream, budget)?));
            low += step(row);
            // Goes on as some row of this kind does in the exemplar.
            let follows: Vec<usize> = (1..rows.len()).filter(|&next| self.kinds[next - 1] == self.kinds[row]).collect();
            row = if follows.is_empty() { (row + 1) % rows.len() } else { follows[stream.below(follows.len())] };
            number += 1;
        }
        Ok(made)
    }

    /// A row of a kind over the row before.
    fn row(
        &self,
        kind: usize,
        below: &[Laid],
        along: [f64; 2],
        stream: &mut Stream,
        budget: &Budget,
    ) -> Result<Vec<Laid>> {
        let models: Vec<&Model> = self.models.iter().filter(|model| self.kinds[model.row] == kind).collect();
        let Some(longest) = models.iter().map(|m| m.board.to - m.board.from).max_by(f64::total_cmp) else {
            return Ok(Vec::new());
        };
        let gap = self.courses.gaps[0];
        let first = models[stream.below(models.len())];
        // Ends before the page does, where a joint of the row before has it.
        let joints: Vec<f64> = below.iter().map(Laid::to).filter(|to| *to < along[0]).collect();
        let end = match (joints.last(), first.bond) {
            (Some(joint), Some(bond)) => joint - bond,
            _ => first.board.to.min(along[0]) - if below.is_empty() { 0.0 } else { stream.range(0.0, longest) },
        };
        let mut row =
            vec![Laid { row: first.row, board: first.board, from: end - (first.board.to - first.board.from) }];
        // The row before has to be known where the first joints are.
        while let Some(last) = row.last().copied().filter(|last| last.to() < along[1] + longest) {
            budget.spend(WORK * models.len() as u64)?;
            let from = last.to() + gap;
            let cost = |model: &Model| {
                let to = from + model.board.to - model.board.from;
                let bond = nearest(below.iter().map(Laid::to), to);
                let differs = match (bond, model.bond) {
                    (Some(a), Some(b)) => (BOND.0 * (a - b).abs() / self.height).min(BOND.1),
                    _ => 0.5 * BOND.1,
                };
                let narrow = bond.is_some_and(|bond| bond.abs() < 0.9 * self.least);
                let middle = 0.5 * (from + to);
                let under = below.iter().find(|b| b.from <= middle && middle <= b.to()).map(|b| b.board.class);
                let beside =
                    |a: Option<u32>, b: Option<u32>| if a.is_some() && b.is_some() && a != b { BESIDE } else { 0.0 };
                differs
                    + if narrow { NARROW } else { 0.0 }
                    + beside(Some(last.board.class), model.before)
                    + beside(under, model.under)
            };
            let costs: Vec<f64> = models.iter().map(|model| cost(model)).collect();
            let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
            let good: Vec<usize> = (0..models.len()).filter(|&m| costs[m] <= least + AS_GOOD).collect();
            let Some(&chosen) = good.get(stream.below(good.len())) else { break };
            row.push(Laid { row: models[chosen].row, board: models[chosen].board, from });
        }
        Ok(row)
    }
}

/// From a place to the nearest of others, with its sign.
fn nearest(others: impl Iterator<Item = f64>, at: f64) -> Option<f64> {
    others.map(|other| other - at).min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::Vector;

    use super::*;

    fn courses() -> Courses {
        let row = |r: usize| {
            let mut from = -7.0 * r as f64;
            let boards = (0..6).map(|k| {
                let to = from + 20.0 + 10.0 * ((k + 2 * r) % 3) as f64;
                let board = Board { element: (6 * r + k) as u32, from, to, class: 0, is_whole: true };
                from = to + 1.0;
                board
            });
            Course { low: 10.0 * r as f64, high: 10.0 * r as f64 + 9.0, boards: boards.collect() }
        };
        let (along, across) = (Vector::xy(1.0, 0.0), Vector::xy(0.0, 1.0));
        Courses { along, across, rows: (0..4).map(row).collect(), gaps: [1.0, 1.0] }
    }

    #[test]
    fn rows_cover_the_page_and_boards_lie_end_to_end() {
        let courses = courses();
        let laid = Laying::new(&courses).rows([-3.0, 97.0], [0.0, 300.0], 1, &Budget::default()).unwrap();
        assert!(laid[0].0 <= -3.0 && laid.last().unwrap().0 + 9.0 >= 96.0);
        for (n, (low, row)) in laid.iter().enumerate() {
            assert!((low - laid[0].0 - 10.0 * n as f64).abs() < 1e-9);
            assert!(row[0].from <= 0.0 && row.last().unwrap().to() >= 300.0, "{n}: {row:?}");
            assert!(row.windows(2).all(|pair| (pair[1].from - pair[0].to() - 1.0).abs() < 1e-9));
        }
    }

    #[test]
    fn joints_keep_the_distances_of_the_exemplar() {
        let courses = courses();
        let laying = Laying::new(&courses);
        let laid = laying.rows([0.0, 200.0], [0.0, 400.0], 2, &Budget::default()).unwrap();
        let joints = |row: &[Laid]| row.iter().map(Laid::to).filter(|x| (0.0..400.0).contains(x)).collect::<Vec<_>>();
        let near = laid.windows(2).flat_map(|pair| {
            let below = joints(&pair[0].1);
            joints(&pair[1].1).into_iter().filter_map(move |x| nearest(below.iter().copied(), x))
        });
        let all: Vec<f64> = near.collect();
        let narrow = all.iter().filter(|d| d.abs() < 0.85 * laying.least).count();
        assert!(laying.least > 0.0 && narrow as f64 <= 0.1 * all.len() as f64, "{narrow} of {}", all.len());
    }
}
