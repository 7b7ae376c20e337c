//! Slopes and distances of the lines of an output, from patches of the exemplar.

use arabesque_core::{Budget, Result, Stage, Stream};

use crate::orderly::abreast::find::Lines;

/// Draws of this module.
const QUILT: Stage = Stage::new(14);

/// Size of a patch: lines, as a share of the exemplar's and at least and at most; columns, as a share.
const LINES: (f64, usize, usize) = (0.4, 3, 10);
const COLUMNS: f64 = 0.5;
/// Share of a patch over which it fades on each side.
const FADE: f64 = 1.0 / 3.0;
/// Columns in which patches are compared, and columns at which they are tried to begin.
const COMPARED: usize = 32;
const TRIED: usize = 32;
/// Share of a patch that has to be known.
const KNOWN: f64 = 0.7;
/// What it costs to lie on a line of another style, for all lines of a patch.
const STYLE: f64 = 6.0;
/// What it costs that more of a patch is not known.
const HIDDEN: f64 = 1e3;
/// Costs are as good as the least when they are above it by this share and this much.
const AS_GOOD: (f64, f64) = (0.2, 0.03);
/// Distances of lines differ by this share of the mean without being seen.
const UNSEEN: f64 = 0.1;
/// A weight that hardly counts.
const FAINT: f64 = 1e-3;
/// Work for each place that is compared.
const WORK: usize = 6;

/// The places of an output: lines and columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// On a tile: how many lines on it goes after one turn around along the lines.
    pub(crate) closes: Option<usize>,
}

impl Sheet {
    /// The number of a place, around a tile of the one that is the same.
    pub(crate) fn number(&self, row: usize, column: usize) -> Option<usize> {
        let Some(shift) = self.closes else {
            return (row < self.rows && column < self.columns).then_some(row * self.columns + column);
        };
        let turns = column / self.columns;
        let row = (row + turns * shift) % self.rows;
        Some(row * self.columns + column % self.columns)
    }
}

/// What is wanted at each place: a value, and how much is known of it.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    /// From the place to the next of its line: rise beside the mean slope.
    pub(crate) rises: Vec<(f64, f64)>,
    /// From the place to the line above it.
    pub(crate) gaps: Vec<(f64, f64)>,
}

/// The exemplar as patches see it, line by line.
struct Source<'a> {
    lines: &'a Lines,
    rises: Vec<Option<f64>>,
    gaps: Vec<Option<f64>>,
    /// How many rises are known before a line and a column.
    known: Vec<usize>,
    /// Mean squares of rises, and of what distances differ from their mean by.
    scale: [f64; 2],
}

impl<'a> Source<'a> {
    fn new(lines: &'a Lines) -> Self {
        let mean = lines.slope * lines.step;
        let (rows, columns) = (lines.lines.len(), lines.columns);
        let height = |row: usize, column: usize| lines.lines.get(row)?.heights.get(column).copied().flatten();
        let places = || (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let rises: Vec<Option<f64>> =
            places().map(|(row, column)| Some(height(row, column + 1)? - height(row, column)? - mean)).collect();
        let gaps: Vec<Option<f64>> =
            places().map(|(row, column)| Some(height(row + 1, column)? - height(row, column)?)).collect();
        let square = |all: &[Option<f64>], from: f64| {
            let known = all.iter().flatten().map(|v| (v - from).powi(2));
            let (sum, n) = known.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
            sum / f64::max(n, 1.0)
        };
        let scale = [
            square(&rises, 0.0).max((1e-6 * lines.gap).powi(2)),
            square(&gaps, lines.gap) + (UNSEEN * lines.gap).powi(2),
        ];
        let mut known = vec![0; (rows + 1) * (columns + 1)];
        for (row, column) in places() {
            let at = |row: usize, column: usize| row * (columns + 1) + column;
            let sum = known[at(row, column + 1)] + known[at(row + 1, column)] - known[at(row, column)];
            known[at(row + 1, column + 1)] = sum + usize::from(rises[row * columns + column].is_some());
        }
        Self { lines, rises, gaps, known, scale }
    }

    /// Share of a part that is known.
    fn share_known(&self, from: [usize; 2], size: [usize; 2]) -> f64 {
        let at = |row: usize, column: usize| self.known[row * (self.lines.columns + 1) + column];
        let [to_row, to_column] = [from[0] + size[0], from[1] + size[1]];
        let sum = at(to_row, to_column) + at(from[0], from[1]) - at(from[0], to_column) - at(to_row, from[1]);
        sum as f64 / (size[0] * size[1]) as f64
    }
}

/// A place of a patch at which something is sewn already.
struct Target {
    row: usize,
    column: usize,
    rise: Option<f64>,
    gap: Option<f64>,
}

/// A quilt as far as it is sewn: sums of weighted values, and of weights.
struct Quilt<'a> {
    sheet: Sheet,
    styles: &'a [usize],
    source: Source<'a>,
    /// Lines and columns of a patch.
    size: [usize; 2],
    rises: Vec<(f64, f64)>,
    gaps: Vec<(f64, f64)>,
}

/// Sews patches of the exemplar together, so that each goes on as the ones before it do.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn quilt(lines: &Lines, sheet: Sheet, styles: &[usize], seed: u64, budget: &Budget) -> Result<Wanted> {
    let all = lines.lines.len();
    let count = ((LINES.0 * all as f64) as usize).clamp(LINES.1, LINES.2);
    let mut size = [count.min(all - 1), ((COLUMNS * lines.columns as f64) as usize).max(2)];
    if sheet.closes.is_some() {
        // Two patches at least on the way around, so that their ends meet others.
        size = [size[0].min((2 * sheet.rows).div_ceil(3)), size[1].min((2 * sheet.columns).div_ceil(3))];
    }
    let places = sheet.rows * sheet.columns;
    let empty = vec![(0.0, 0.0); places];
    let mut quilt = Quilt { sheet, styles, source: Source::new(lines), size, rises: empty.clone(), gaps: empty };
    let [rows, columns] = [begins(sheet.rows, size[0], sheet), begins(sheet.columns, size[1], sheet)];
    let mut stream = Stream::new(seed, QUILT, 0);
    for &row in &rows {
        for &column in &columns {
            let from = quilt.choose([row, column], &mut stream, budget)?;
            quilt.sew([row, column], from);
        }
    }
    let mean = |all: Vec<(f64, f64)>| all.into_iter().map(|(sum, weight)| (sum / weight.max(1e-12), weight)).collect();
    Ok(Wanted { rises: mean(quilt.rises), gaps: mean(quilt.gaps) })
}

/// Where patches of a size begin, so that each fades into the next.
fn begins(length: usize, size: usize, sheet: Sheet) -> Vec<usize> {
    let step = ((1.0 - FADE) * size as f64).floor().max(1.0);
    let count = (length as f64 / step).ceil().max(1.0);
    if sheet.closes.is_some() {
        return (0..count as usize).map(|k| (k as f64 * length as f64 / count) as usize).collect();
    }
    (0..count as usize).map(|k| k * step as usize).collect()
}

/// How much a patch counts at one of its places.
fn fade(at: usize, size: usize) -> f64 {
    let inside = (at as f64 + 0.5).min(size as f64 - at as f64 - 0.5);
    let share = (inside / (FADE * size as f64)).min(1.0);
    (share * share * (3.0 - 2.0 * share)).max(FAINT)
}

impl Quilt<'_> {
    /// The part of the exemplar that goes on best there: its first line and column.
    fn choose(&self, at: [usize; 2], stream: &mut Stream, budget: &Budget) -> Result<[usize; 2]> {
        let lines = self.source.lines;
        let [rows, columns] = [lines.lines.len() - self.size[0], lines.columns - self.size[1]];
        let targets = self.targets(at);
        let styles: Vec<usize> = (0..self.size[0])
            .take_while(|row| self.sheet.closes.is_some() || at[0] + row < self.sheet.rows)
            .map(|row| self.styles[(at[0] + row) % self.sheet.rows])
            .collect();
        let mut costs: Vec<([usize; 2], f64)> = Vec::new();
        for row in 0..=rows {
            budget.spend((WORK * (targets.len() + styles.len()) * TRIED) as u64)?;
            let begins = (0..=columns).step_by((columns / TRIED).max(1));
            costs.extend(begins.map(|column| ([row, column], self.cost(&targets, &styles, [row, column]))));
        }
        let least = costs.iter().map(|(_, cost)| *cost).fold(f64::INFINITY, f64::min);
        let bound = least * (1.0 + AS_GOOD.0) + AS_GOOD.1;
        let good: Vec<_> = costs.iter().filter(|(_, cost)| *cost <= bound).map(|(from, _)| *from).collect();
        Ok(good.get(stream.below(good.len().max(1))).copied().unwrap_or([0, 0]))
    }

    /// What is sewn already where a patch is to lie.
    fn targets(&self, at: [usize; 2]) -> Vec<Target> {
        let mean = |(sum, weight): (f64, f64)| (weight > FAINT).then(|| sum / weight);
        let stride = (self.size[1] / COMPARED).max(1);
        let all = (0..self.size[0]).flat_map(|row| (0..self.size[1]).step_by(stride).map(move |column| (row, column)));
        all.filter_map(|(row, column)| {
            let n = self.sheet.number(at[0] + row, at[1] + column)?;
            let (rise, gap) = (mean(self.rises[n]), mean(self.gaps[n]));
            (rise.is_some() || gap.is_some()).then_some(Target { row, column, rise, gap })
        })
        .collect()
    }

    /// How much a part of the exemplar differs from what is sewn already.
    fn cost(&self, targets: &[Target], styles: &[usize], from: [usize; 2]) -> f64 {
        let source = &self.source;
        let (mut sum, mut count) = (0.0, 0.0);
        for target in targets {
            let place = (from[0] + target.row) * source.lines.columns + from[1] + target.column;
            let pairs = [(target.rise, source.rises[place]), (target.gap, source.gaps[place])];
            for ((wanted, there), scale) in pairs.into_iter().zip(source.scale) {
                if let (Some(wanted), Some(there)) = (wanted, there) {
                    sum += (wanted - there).powi(2) / scale;
                    count += 1.0;
                }
            }
        }
        let lines = source.lines.lines[from[0]..].iter();
        let other = lines.zip(styles).filter(|(line, style)| line.style != **style).count();
        let hidden = (KNOWN - source.share_known(from, self.size)).max(0.0);
        sum / f64::max(count, 1.0) + STYLE * other as f64 / self.size[0] as f64 + HIDDEN * hidden
    }

    /// Lays a part of the exemplar over what is there.
    fn sew(&mut self, at: [usize; 2], from: [usize; 2]) {
        for row in 0..self.size[0] {
            for column in 0..self.size[1] {
                let Some(n) = self.sheet.number(at[0] + row, at[1] + column) else { continue };
                let weight = fade(row, self.size[0]) * fade(column, self.size[1]);
                let place = (from[0] + row) * self.source.lines.columns + from[1] + column;
                let add = |to: &mut (f64, f64), value: Option<f64>| {
                    if let Some(value) = value {
                        *to = (to.0 + weight * value, to.1 + weight);
                    }
                };
                add(&mut self.rises[n], self.source.rises[place]);
                add(&mut self.gaps[n], self.source.gaps[place]);
            }
        }
    }
}
