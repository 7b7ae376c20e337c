//! A uniform grid of points that can grow and shrink.

use arabesque_core::{Domain, Vector};

/// Point numbers in the cells of a uniform grid over a box; on a torus the cells divide the period.
#[derive(Clone, Debug)]
pub(crate) struct Buckets<const D: usize> {
    origin: Vector<D>,
    cell: Vector<D>,
    cells: [usize; D],
    period: Option<Vector<D>>,
    lists: Vec<Vec<u32>>,
}

impl<const D: usize> Buckets<D> {
    /// An empty grid over the domain grown by `margin`, with cells of about `cell`.
    pub(crate) fn new(domain: &Domain<D>, margin: f64, cell: f64) -> Self {
        let period = domain.period();
        let bounds = if period.is_some() { domain.bounds() } else { domain.bounds().grown(margin) };
        let size = bounds.size();
        let cells: [usize; D] = std::array::from_fn(|k| ((size[k] / cell) as usize).clamp(1, 4096));
        let cell = Vector(std::array::from_fn(|k| size[k] / cells[k] as f64));
        Self { origin: bounds.min, cell, cells, period, lists: vec![Vec::new(); cells.iter().product()] }
    }

    fn index(&self, p: Vector<D>) -> usize {
        (0..D).rev().fold(0, |c, k| {
            let n = self.cells[k] as isize;
            let i = ((p[k] - self.origin[k]) / self.cell[k]).floor() as isize;
            let i = if self.period.is_some() { i.rem_euclid(n) } else { i.clamp(0, n - 1) };
            c * self.cells[k] + i as usize
        })
    }

    /// Adds point `i` at `p`.
    pub(crate) fn insert(&mut self, i: u32, p: Vector<D>) {
        let cell = self.index(p);
        self.lists[cell].push(i);
    }

    /// Calls `visit(i)` for every point in the cells that a ball around `p` touches, in a fixed order.
    pub(crate) fn near(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(u32)) {
        let mut low = [0_isize; D];
        let mut count = [0_usize; D];
        for k in 0..D {
            let at = |v: f64| ((v - self.origin[k]) / self.cell[k]).floor() as isize;
            let (mut a, mut b) = (at(p[k] - radius), at(p[k] + radius));
            let last = self.cells[k] as isize - 1;
            if self.period.is_none() {
                (a, b) = (a.clamp(0, last), b.clamp(0, last));
            }
            low[k] = a;
            count[k] = ((b - a) as usize + 1).min(self.cells[k]);
        }
        for step in 0..count.iter().product() {
            let (mut rest, mut cell, mut stride) = (step, 0, 1);
            for k in 0..D {
                let i = (low[k] + (rest % count[k]) as isize).rem_euclid(self.cells[k] as isize) as usize;
                rest /= count[k];
                cell += i * stride;
                stride *= self.cells[k];
            }
            self.lists[cell].iter().for_each(|&i| visit(i));
        }
    }
}
