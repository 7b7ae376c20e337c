//! Heights of lines that have wanted slopes and distances, as nearly as can be.

use arabesque_core::{Budget, Equations, Result, Vector, conjugate_gradients};

use crate::orderly::abreast::quilt::{Sheet, Wanted};

/// Weight of what is not known, beside what is.
const UNKNOWN: f64 = 0.02;
/// Lines are held to the mean slope as weakly as this, relative to the length of the exemplar, which shows nothing that is longer.
const HELD: f64 = 1.5;
/// Rounds in which lines that come too near are pushed apart, and the factor by which this counts more in each.
const ROUNDS: (usize, f64) = (2, 12.0);
/// Precision of the heights at first, that of what is corrected, and steps to it at most.
const SOLVED: (f64, f64, usize) = (5e-4, 1e-2, 2000);
/// Work of a round for each place.
const WORK: u64 = 30;

/// Measures of the lines of an output.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    /// Distance of columns, and of lines in the mean.
    pub(crate) step: f64,
    pub(crate) gap: f64,
    /// Length of the exemplar along its lines.
    pub(crate) length: f64,
    /// The distance that lines should keep, and the one that they do keep.
    pub(crate) wanted: f64,
    pub(crate) least: f64,
}

/// Least squares for what is to be added to heights beside those of evenly spaced lines of the mean slope.
struct Heights<'a> {
    sheet: Sheet,
    measures: &'a Measures,
    /// For each place, to the next of its line and to the line above: the difference that is wanted, and its weight.
    along: Vec<(f64, f64)>,
    across: Vec<(f64, f64)>,
    /// The places after and above, and those before and below; at the edge the place itself, and none.
    ahead: Vec<usize>,
    above: Vec<usize>,
    before: Vec<Option<usize>>,
    below: Vec<Option<usize>>,
    held: f64,
    so_far: Vec<Vector<1>>,
}

/// The heights of all lines, beside those of evenly spaced lines of the mean slope. No line comes nearer to the next than all do.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn heights(sheet: Sheet, wanted: &Wanted, measures: &Measures, budget: &Budget) -> Result<Vec<f64>> {
    let mut equations = Heights::new(sheet, wanted, measures);
    for round in 0..=ROUNDS.0 {
        let precision = if round == 0 { SOLVED.0 } else { SOLVED.1 };
        let solved = conjugate_gradients(&equations, precision, SOLVED.2, budget)?;
        equations.so_far.iter_mut().zip(solved).for_each(|(height, more)| *height += more);
        budget.spend(WORK * equations.so_far.len() as u64)?;
        if round == ROUNDS.0 || !equations.push_apart() {
            break;
        }
    }
    let mut made: Vec<f64> = equations.so_far.iter().map(|height| height[0]).collect();
    for column in 0..sheet.columns {
        equations.part(column, &mut made);
    }
    Ok(made)
}

impl<'a> Heights<'a> {
    fn new(sheet: Sheet, wanted: &Wanted, measures: &'a Measures) -> Self {
        let count = sheet.rows * sheet.columns;
        let (mut before, mut below) = (vec![None; count], vec![None; count]);
        let (mut along, mut across) = (vec![(0.0, 0.0); count], vec![(0.0, 0.0); count]);
        let (mut ahead, mut above): (Vec<usize>, Vec<usize>) = ((0..count).collect(), (0..count).collect());
        let square = [measures.step.powi(-2), measures.gap.powi(-2)];
        for row in 0..sheet.rows {
            for column in 0..sheet.columns {
                let n = row * sheet.columns + column;
                if let Some(next) = sheet.number(row, column + 1).filter(|next| *next != n) {
                    (ahead[n], before[next]) = (next, Some(n));
                    let (rise, weight) = wanted.rises[n];
                    along[n] = if weight > 0.0 { (rise, square[0]) } else { (0.0, UNKNOWN * square[0]) };
                }
                if let Some(next) = sheet.number(row + 1, column).filter(|next| *next != n) {
                    (above[n], below[next]) = (next, Some(n));
                    let (gap, weight) = wanted.gaps[n];
                    let known = (gap - measures.gap, square[1]);
                    across[n] = if weight > 0.0 { known } else { (0.0, UNKNOWN * square[1]) };
                }
            }
        }
        let held = (HELD / measures.length).powi(2);
        let so_far = vec![Vector::ZERO; count];
        Self { sheet, measures, along, across, ahead, above, before, below, held, so_far }
    }

    /// Asks for more room where lines come too near; whether there are such places.
    fn push_apart(&mut self) -> bool {
        let mut is_any = false;
        for n in 0..self.so_far.len() {
            let above = self.above[n];
            if above == n || self.across[n].1 == 0.0 {
                continue;
            }
            let gap = self.measures.gap + self.so_far[above][0] - self.so_far[n][0];
            if gap < self.measures.wanted {
                let target = self.across[n].0.max(1.1 * self.measures.wanted - self.measures.gap);
                self.across[n] = (target, self.across[n].1 * ROUNDS.1);
                is_any = true;
            }
        }
        is_any
    }

    /// Moves the lines in a column as little as it takes for all to keep the least distance.
    fn part(&self, column: usize, made: &mut [f64]) {
        let rows = self.sheet.rows;
        let place = |row: usize| row % rows * self.sheet.columns + column;
        let gap = |row: usize, made: &[f64]| self.measures.gap + made[place(row + 1)] - made[place(row)];
        let is_near = |row: usize, made: &[f64]| gap(row, made) < self.measures.least;
        let last = if self.sheet.closes.is_some() { rows } else { rows - 1 };
        if rows < 2 || !(0..last).any(|row| is_near(row, made)) {
            return;
        }
        // Around a tile, from the widest gap on.
        let widest = (0..last).max_by(|&a, &b| gap(a, made).total_cmp(&gap(b, made))).unwrap_or(0);
        let first = if self.sheet.closes.is_some() { widest + 1 } else { 0 };
        let spare = self.measures.gap - self.measures.least;
        let mut blocks: Vec<(f64, usize)> = Vec::new();
        for k in 0..rows {
            blocks.push((made[place(first + k)] + spare * k as f64, 1));
            while let [.., (a, n), (b, m)] = blocks[..]
                && b < a
            {
                blocks.truncate(blocks.len() - 2);
                blocks.push(((a * n as f64 + b * m as f64) / (n + m) as f64, n + m));
            }
        }
        let values = blocks.iter().flat_map(|&(value, count)| std::iter::repeat_n(value, count));
        values.enumerate().for_each(|(k, value)| made[place(first + k)] = value - spare * k as f64);
    }
}

impl Equations<1> for Heights<'_> {
    fn row(&self, i: usize, x: &[Vector<1>]) -> Vector<1> {
        let (ahead, above) = (self.ahead[i], self.above[i]);
        let mut sum = x[i] * self.held + (x[i] - x[ahead]) * self.along[i].1 + (x[i] - x[above]) * self.across[i].1;
        if let Some(k) = self.before[i] {
            sum += (x[i] - x[k]) * self.along[k].1;
        }
        if let Some(k) = self.below[i] {
            sum += (x[i] - x[k]) * self.across[k].1;
        }
        sum
    }

    fn diagonal(&self, i: usize) -> f64 {
        let back = self.before[i].map_or(0.0, |k| self.along[k].1) + self.below[i].map_or(0.0, |k| self.across[k].1);
        self.held + self.along[i].1 + self.across[i].1 + back
    }

    fn right(&self, i: usize) -> Vector<1> {
        let ahead = self.along[i].0 * self.along[i].1 + self.across[i].0 * self.across[i].1;
        let behind = self.before[i].map_or(0.0, |k| self.along[k].0 * self.along[k].1)
            + self.below[i].map_or(0.0, |k| self.across[k].0 * self.across[k].1);
        Vector([behind - ahead]) - self.row(i, &self.so_far)
    }

    fn count(&self) -> usize {
        self.along.len()
    }

    fn price(&self) -> u64 {
        12 * self.along.len() as u64
    }
}
