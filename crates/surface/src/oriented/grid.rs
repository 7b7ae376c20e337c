//! Points in the cells of a regular grid, cell by cell in one list.

use std::ops::Range;

use arabesque_core::{Bounds, Vector};

/// Cells for each point at most; where points lie far apart the cells are larger.
const CELLS: f64 = 4.0;

/// The largest whole number that is not larger. A cast of what is too large gives the largest number.
fn floored(v: f64) -> i64 {
    let whole = v as i64;
    if (whole as f64) > v { whole.saturating_sub(1) } else { whole }
}

/// A grid over points. The points of a cell are next to one another, in their order.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    origin: Vector<3>,
    cell: f64,
    counts: [usize; 3],
    /// First place of each cell in the order, and the end.
    starts: Vec<u32>,
    /// Numbers of points.
    order: Vec<u32>,
}

impl Grid {
    pub(super) fn new(points: &[Vector<3>], cell: f64) -> Self {
        let bounds = Bounds::around(points.iter().copied());
        let size = if points.is_empty() { Vector::ZERO } else { bounds.size() };
        let origin = if points.is_empty() { Vector::ZERO } else { bounds.min };
        let most = CELLS * points.len() as f64 + 64.0;
        let (mut cell, count) = (cell, |cell: f64| size.0.map(|s| (s / cell).floor() + 1.0));
        while count(cell).iter().product::<f64>() > most {
            cell *= 1.25;
        }
        let counts = count(cell).map(|n| n as usize);
        let mut grid = Self {
            origin,
            cell,
            counts,
            starts: vec![0; counts.iter().product::<usize>() + 1],
            order: vec![0; points.len()],
        };
        let cells: Vec<u32> = points.iter().map(|&p| grid.flat(grid.of(p)) as u32).collect();
        cells.iter().for_each(|&c| grid.starts[c as usize + 1] += 1);
        for c in 1..grid.starts.len() {
            grid.starts[c] += grid.starts[c - 1];
        }
        let mut next = grid.starts.clone();
        for (i, &c) in cells.iter().enumerate() {
            grid.order[next[c as usize] as usize] = i as u32;
            next[c as usize] += 1;
        }
        grid
    }

    /// The cell of a place, the nearest one for places outside.
    fn of(&self, p: Vector<3>) -> [usize; 3] {
        std::array::from_fn(|k| (((p[k] - self.origin[k]) / self.cell).max(0.0) as usize).min(self.counts[k] - 1))
    }

    fn flat(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// Numbers of the points, cell by cell.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `visit` with the places in the order that the cells of a box take.
    pub(super) fn runs(&self, bounds: &Bounds<3>, mut visit: impl FnMut(Range<usize>)) {
        let (low, high) = (self.of(bounds.min), self.of(bounds.max));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let (first, last) = (self.flat([low[0], y, z]), self.flat([high[0], y, z]));
                let run = self.starts[first] as usize..self.starts[last + 1] as usize;
                if !run.is_empty() {
                    visit(run);
                }
            }
        }
    }

    /// The place in the order of the nearest point of those that fit, if it is no farther than `reach`, with its squared distance. Of equally
    /// near ones it is the first in number.
    pub(super) fn nearest(
        &self,
        p: Vector<3>,
        reach: f64,
        mut distance2: impl FnMut(usize) -> Option<f64>,
    ) -> Option<(usize, f64)> {
        let at: [i64; 3] = std::array::from_fn(|k| floored((p[k] - self.origin[k]) / self.cell));
        let last: [i64; 3] = self.counts.map(|n| n as i64 - 1);
        let aside = |k: usize| at[k].saturating_neg().max(at[k].saturating_sub(last[k])).max(0);
        let across = |k: usize| at[k].max(last[k].saturating_sub(at[k]));
        let first = (0..3).map(aside).max().unwrap_or(0);
        let most = (0..3).map(across).max().unwrap_or(0);
        // How near the walls of its own cell are.
        let wall = (0..3).fold(f64::INFINITY, |near: f64, k| {
            let low = p[k] - (self.origin[k] + at[k] as f64 * self.cell);
            near.min(low).min(self.cell - low)
        });
        let mut best: Option<(usize, f64)> = None;
        for shell in first..=most {
            // Rounding may put a point beside its cell.
            let least = wall + (shell as f64 - 1.0 - 1e-9) * self.cell;
            if shell > 0 && (least > reach || best.is_some_and(|(_, d2)| least > 0.0 && least * least > d2)) {
                break;
            }
            self.shell(at, shell, |run| {
                for k in run {
                    let Some(d2) = distance2(k) else { continue };
                    if best.is_none_or(|(other, b2)| d2 < b2 || d2 == b2 && self.order[k] < self.order[other]) {
                        best = Some((k, d2));
                    }
                }
            });
        }
        best.filter(|(_, d2)| *d2 <= reach * reach)
    }

    /// Calls `visit` with the runs of the cells that are so many cells from one.
    fn shell(&self, at: [i64; 3], shell: i64, mut visit: impl FnMut(Range<usize>)) {
        let [low, high]: [[i64; 3]; 2] = [
            std::array::from_fn(|k| at[k].saturating_sub(shell).max(0)),
            std::array::from_fn(|k| at[k].saturating_add(shell).min(self.counts[k] as i64 - 1)),
        ];
        let mut cells = |from: i64, to: i64, y: i64, z: i64| {
            let flat = |x: i64| self.flat([x as usize, y as usize, z as usize]);
            visit(self.starts[flat(from)] as usize..self.starts[flat(to) + 1] as usize);
        };
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                if (z - at[2]).abs() == shell || (y - at[1]).abs() == shell {
                    if low[0] <= high[0] {
                        cells(low[0], high[0], y, z);
                    }
                    continue;
                }
                let ends = [at[0].saturating_sub(shell), at[0].saturating_add(shell)];
                ends.into_iter().filter(|x| (low[0]..=high[0]).contains(x)).for_each(|x| cells(x, x, y, z));
            }
        }
    }
}
