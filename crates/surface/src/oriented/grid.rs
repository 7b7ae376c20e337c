//! Points in the cells of a regular grid, cell by cell in one list.

use arabesque_core::{Bounds, Vector};

/// Cells for each point at most; where points lie far apart the cells are larger.
const CELLS: f64 = 4.0;

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

    /// Calls `visit` for all points in the cells that meet a box.
    pub(super) fn within(&self, bounds: &Bounds<3>, mut visit: impl FnMut(u32)) {
        let (low, high) = (self.of(bounds.min), self.of(bounds.max));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let (first, last) = (self.flat([low[0], y, z]), self.flat([high[0], y, z]));
                let run = self.starts[first] as usize..self.starts[last + 1] as usize;
                self.order[run].iter().for_each(|&i| visit(i));
            }
        }
    }

    /// The nearest point of those for which `distance2` gives something, if it is no farther than `reach`.
    pub(super) fn nearest(
        &self,
        p: Vector<3>,
        reach: f64,
        mut distance2: impl FnMut(u32) -> Option<f64>,
    ) -> Option<(u32, f64)> {
        let (mut best, mut radius): (Option<(u32, f64)>, f64) = (None, (0.5 * self.cell).min(reach));
        loop {
            self.within(&Bounds::new(p, p).grown(radius), |i| {
                let Some(d2) = distance2(i) else { return };
                if best.is_none_or(|(other, least)| d2 < least || d2 == least && i < other) {
                    best = Some((i, d2));
                }
            });
            match best {
                // Nothing nearer can lie outside of the box that was searched.
                Some((_, d2)) if d2 <= radius * radius => return best.filter(|_| d2 <= reach * reach),
                Some((_, d2)) => radius = d2.sqrt().min(reach).max(radius * 1.001),
                None => radius *= 2.0,
            }
            if radius >= reach {
                if radius >= 2.0 * reach {
                    return best.filter(|(_, d2)| *d2 <= reach * reach);
                }
                radius = reach;
                self.within(&Bounds::new(p, p).grown(radius), |i| {
                    let Some(d2) = distance2(i) else { return };
                    if best.is_none_or(|(other, least)| d2 < least || d2 == least && i < other) {
                        best = Some((i, d2));
                    }
                });
                return best.filter(|(_, d2)| *d2 <= reach * reach);
            }
        }
    }
}
