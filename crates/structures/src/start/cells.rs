//! Points in cells that take new ones.

use std::collections::HashMap;

use arabesque_core::{Domain, Vector};

/// Numbers of points by place; more can come at any time.
#[derive(Clone, Debug)]
pub(crate) struct Cells<const D: usize> {
    size: [f64; D],
    counts: Option<[i64; D]>,
    places: Vec<Vector<D>>,
    cells: HashMap<[i64; D], Vec<u32>>,
}

impl<const D: usize> Cells<D> {
    /// For queries of about `radius`.
    pub(crate) fn new(radius: f64, domain: &Domain<D>) -> Self {
        let counts = domain.period().map(|p| p.0.map(|l| ((l / radius) as i64).max(1)));
        let size = match (domain.period(), counts) {
            (Some(p), Some(n)) => std::array::from_fn(|k| p[k] / n[k] as f64),
            _ => [radius; D],
        };
        Self { size, counts, places: Vec::new(), cells: HashMap::new() }
    }

    fn cell(&self, p: Vector<D>) -> [i64; D] {
        std::array::from_fn(|k| {
            let c = (p[k] / self.size[k]).floor() as i64;
            self.counts.map_or(c, |n| c.rem_euclid(n[k]))
        })
    }

    /// Adds a point; the first one has number 0.
    pub(crate) fn add(&mut self, p: Vector<D>) {
        self.cells.entry(self.cell(p)).or_default().push(self.places.len() as u32);
        self.places.push(p);
    }

    /// Calls `visit` with each point within `radius` of `p` and the offset to it, in a fixed order.
    pub(crate) fn within(
        &self,
        domain: &Domain<D>,
        p: Vector<D>,
        radius: f64,
        mut visit: impl FnMut(usize, Vector<D>),
    ) {
        let low: [i64; D] = std::array::from_fn(|k| ((p[k] - radius) / self.size[k]).floor() as i64);
        let mut span: [i64; D] = std::array::from_fn(|k| ((p[k] + radius) / self.size[k]).floor() as i64 - low[k] + 1);
        if let Some(n) = self.counts {
            (0..D).for_each(|k| span[k] = span[k].min(n[k]));
        }
        for step in 0..span.iter().product::<i64>() {
            let mut rest = step;
            let at: [i64; D] = std::array::from_fn(|k| {
                let c = low[k] + rest % span[k];
                rest /= span[k];
                self.counts.map_or(c, |n| c.rem_euclid(n[k]))
            });
            for &i in self.cells.get(&at).into_iter().flatten() {
                let offset = domain.offset(p, self.places[i as usize]);
                if offset.norm2() <= radius * radius {
                    visit(i as usize, offset);
                }
            }
        }
    }
}
