//! Lines that run side by side through the frame, as heights over a row of columns.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Bounds, Budget, Exemplar, Result, Vector};

/// Fewest lines, and fewest of them over one another in the middle column.
const LEAST: (usize, usize) = (6, 4);
/// Lines are flattened to this share of the side of the frame, and may go back by this share of it.
const FLAT: f64 = 1e-4;
const BACK: f64 = 1e-3;
/// How far from the frame a line may end, as a share of its side.
const AT_FRAME: f64 = 0.012;
/// Columns to the mean distance of lines, and how many there may be.
const FINE: f64 = 6.0;
const COLUMNS: (f64, f64) = (48.0, 360.0);
/// Lines that leave the chord of their ends by less than this share of their distance are straight.
const STRAIGHT: f64 = 0.05;
/// Share of the lines that is straight where the drawing is one of straight lines.
const MANY: f64 = 0.7;
/// What lies between the frame and the outermost line, in largest distances of lines, at most, and share of the columns of which
/// this has to be true.
const MARGIN: (f64, f64) = (1.5, 0.85);
/// Share of the distances of lines that may be smaller than what counts as the least.
const FEW: f64 = 0.01;
/// Work for each point of a line, and for each place in a column.
const WORK: u64 = 40;

/// A line of the exemplar.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) curve: usize,
    pub(crate) style: usize,
    /// Its height in each column; `None` where it is not shown.
    pub(crate) heights: Vec<Option<f64>>,
}

/// The lines of an exemplar, from the lowest to the highest.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    /// The axis along which they run: 0 or 1. Heights are along the other.
    pub(crate) axis: usize,
    pub(crate) lines: Vec<Line>,
    /// Distance of columns.
    pub(crate) step: f64,
    pub(crate) columns: usize,
    /// Mean slope of lines, and mean distance from each to the next.
    pub(crate) slope: f64,
    pub(crate) gap: f64,
    /// A distance that nearly all keep, and one that all keep.
    pub(crate) usual_least: f64,
    pub(crate) least: f64,
    /// How far lines come from the mean slope.
    pub(crate) wander: f64,
}

impl Lines {
    /// Finds the lines; `None` where anything else is drawn, some end inside of the frame, turn back, meet or cross, or nearly all
    /// are straight.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn find(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let has_others = !exemplar.elements.is_empty() || !exemplar.areas.is_empty();
        let is_closed = exemplar.curves.iter().any(|curve| curve.path.closed);
        let is_part = exemplar.hole.is_some() || exemplar.period.is_some();
        if has_others || is_closed || is_part || exemplar.curves.len() < LEAST.0 {
            return Ok(None);
        }
        let (window, side) = (exemplar.window, exemplar.view().side());
        let mut points = Vec::new();
        let mut lengths = [0.0, 0.0];
        for curve in &exemplar.curves {
            let flat = curve.path.flatten(FLAT * side);
            budget.spend(WORK * flat.len() as u64)?;
            for pair in flat.windows(2) {
                (0..2).for_each(|axis| lengths[axis] += (pair[1][axis] - pair[0][axis]).abs());
            }
            points.push(flat);
        }
        let axis = usize::from(lengths[1] > lengths[0]);
        let Some(points) =
            points.into_iter().map(|line| onwards(line, axis, &window, side)).collect::<Option<Vec<_>>>()
        else {
            return Ok(None);
        };
        let about = window.measure() / lengths[axis].max(f64::MIN_POSITIVE);
        let length = window.size()[axis];
        let columns = (FINE * length / about).ceil().clamp(COLUMNS.0, COLUMNS.1) as usize;
        let step = length / columns as f64;
        budget.spend(WORK * (columns * points.len()) as u64)?;
        let at = |c: usize| window.min[axis] + (c as f64 + 0.5) * step;
        let shown = window.min[1 - axis]..=window.max[1 - axis];
        let lines: Vec<Line> = (0..)
            .zip(&points)
            .map(|(curve, line)| {
                let height = |c| height(line, axis, at(c)).filter(|height| shown.contains(height));
                let heights = (0..columns).map(height).collect();
                Line { curve, style: exemplar.curves[curve].style, heights }
            })
            .filter(|line| line.heights.iter().flatten().count() > 1)
            .collect();
        let Some(lines) = in_order(lines, columns) else { return Ok(None) };
        Ok(Self::described(lines, (axis, step, columns), [*shown.start(), *shown.end()]))
    }

    /// What lines in order have in common; `None` where they are straight, too few, or leave much of the frame empty.
    fn described(lines: Vec<Line>, (axis, step, columns): (usize, f64, usize), shown: [f64; 2]) -> Option<Self> {
        let in_column = |c: usize| lines.iter().filter_map(move |line| line.heights[c]);
        if lines.len() < LEAST.0 || in_column(columns / 2).count() < LEAST.1 {
            return None;
        }
        let straight = lines.iter().filter(|line| bulge(line) < STRAIGHT * (shown[1] - shown[0]) / lines.len() as f64);
        if straight.count() as f64 > MANY * lines.len() as f64 {
            return None;
        }
        let pairs = lines.windows(2).flat_map(|pair| pair[0].heights.iter().zip(&pair[1].heights));
        let mut gaps: Vec<f64> = pairs.filter_map(|(low, high)| Some((*high)? - (*low)?)).collect();
        gaps.sort_by(f64::total_cmp);
        let (least, largest) = (*gaps.first()?, *gaps.last()?);
        let gap = gaps.iter().sum::<f64>() / gaps.len() as f64;
        let is_near = |c: &usize| {
            let (low, high) = in_column(*c).fold((shown[1], shown[0]), |(low, high), y| (low.min(y), high.max(y)));
            (low - shown[0]).max(shown[1] - high) <= MARGIN.0 * largest
        };
        if least <= 0.0 || ((0..columns).filter(is_near).count() as f64) < MARGIN.1 * columns as f64 {
            return None;
        }
        let usual_least = gaps[(FEW * gaps.len() as f64) as usize];
        let rises = lines.iter().flat_map(|line| line.heights.windows(2)).filter_map(|w| Some(w[1]? - w[0]?));
        let (sum, count) = rises.fold((0.0, 0.0), |(sum, n), rise| (sum + rise, n + 1.0));
        let slope = sum / f64::max(count, 1.0) / step;
        let wander = lines.iter().map(|line| wander(line, slope * step)).fold(0.0, f64::max);
        Some(Self { axis, lines, step, columns, slope, gap, usual_least, least, wander })
    }
}

/// Points of a line in the order of their places along an axis; `None` where it turns back or ends inside of the frame.
fn onwards(mut line: Vec<Vector<2>>, axis: usize, window: &Bounds<2>, side: f64) -> Option<Vec<Vector<2>>> {
    let (first, last) = (*line.first()?, *line.last()?);
    if last[axis] < first[axis] {
        line.reverse();
    }
    let within = window.grown(-AT_FRAME * side);
    let goes_on = line.windows(2).all(|pair| pair[1][axis] > pair[0][axis] - BACK * side);
    (goes_on && !within.contains(first) && !within.contains(last)).then_some(line)
}

/// Where a line passes a place along an axis. Lines that end at the frame are taken to reach it.
fn height(line: &[Vector<2>], axis: usize, at: f64) -> Option<f64> {
    let after = line.partition_point(|p| p[axis] < at);
    let (a, b) = (line.get(after.checked_sub(1)?)?, line.get(after)?);
    let share = (at - a[axis]) / (b[axis] - a[axis]).max(f64::MIN_POSITIVE);
    Some(a[1 - axis] + (b[1 - axis] - a[1 - axis]) * share.clamp(0.0, 1.0))
}

/// How far a line comes from the chord of its ends.
fn bulge(line: &Line) -> f64 {
    let known: Vec<(f64, f64)> =
        line.heights.iter().enumerate().filter_map(|(c, y)| y.map(|y| (c as f64, y))).collect();
    let (Some(&a), Some(&b)) = (known.first(), known.last()) else { return 0.0 };
    let slope = (b.1 - a.1) / (b.0 - a.0).max(1.0);
    known.iter().map(|(c, y)| (y - a.1 - slope * (c - a.0)).abs()).fold(0.0, f64::max)
}

/// How far a line comes from its mean, beside a slope.
fn wander(line: &Line, rise: f64) -> f64 {
    let known: Vec<f64> = line.heights.iter().enumerate().filter_map(|(c, y)| y.map(|y| y - rise * c as f64)).collect();
    let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
    known.iter().map(|y| (y - mean).abs()).fold(0.0, f64::max)
}

/// The lines from the lowest to the highest; `None` where they cross.
fn in_order(lines: Vec<Line>, columns: usize) -> Option<Vec<Line>> {
    let mut above: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for c in 0..columns {
        let mut column: Vec<(f64, usize)> =
            lines.iter().enumerate().filter_map(|(k, line)| line.heights[c].map(|y| (y, k))).collect();
        column.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        column.windows(2).for_each(|pair| {
            above.entry(pair[0].1).or_default().insert(pair[1].1);
        });
    }
    let mut below = vec![0_usize; lines.len()];
    above.values().flatten().for_each(|&k| below[k] += 1);
    let mean = |k: usize| {
        let known: Vec<f64> = lines[k].heights.iter().flatten().copied().collect();
        known.iter().sum::<f64>() / known.len().max(1) as f64
    };
    let means: Vec<f64> = (0..lines.len()).map(mean).collect();
    let mut free: Vec<usize> = (0..lines.len()).filter(|&k| below[k] == 0).collect();
    let mut order = Vec::new();
    while let Some(n) = (0..free.len()).min_by(|&a, &b| means[free[a]].total_cmp(&means[free[b]])) {
        let k = free.swap_remove(n);
        order.push(k);
        for &other in above.get(&k).into_iter().flatten() {
            below[other] -= 1;
            if below[other] == 0 {
                free.push(other);
            }
        }
    }
    let mut lines: Vec<Option<Line>> = lines.into_iter().map(Some).collect();
    (order.len() == lines.len()).then(|| order.iter().filter_map(|&k| lines[k].take()).collect())
}
