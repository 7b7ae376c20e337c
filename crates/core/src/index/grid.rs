//! Points in the cells of a uniform grid, for queries by radius.

use crate::{
    index::Lattice,
    region::Domain,
    space::{Bounds, Vector, periodic},
};

/// Point indices sorted by grid cell. On a torus the grid divides the period, and queries go around the back.
#[derive(Clone, Debug)]
pub struct GridIndex<const D: usize> {
    lattice: Lattice<D>,
    period: Option<Vector<D>>,
    /// Points of cell `c`: `order[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    order: Vec<u32>,
    /// Positions in the order of `order`; wrapped on a torus.
    points: Vec<Vector<D>>,
}

/// Most cells along all coordinates together: bounds memory for scattered points.
const MOST_CELLS: f64 = 4_000_000.0;

impl<const D: usize> GridIndex<D> {
    /// Indexes `points` for queries of about `radius`; `domain` gives the period of a torus.
    pub fn new(points: &[Vector<D>], radius: f64, domain: &Domain<D>) -> Self {
        let period = domain.period();
        let wrapped: Vec<_> = points.iter().map(|&p| domain.wrap(p)).collect();
        let bounds = match period {
            Some(_) => domain.bounds(),
            None => Bounds::around(wrapped.iter().copied()),
        };
        let bounds = if bounds.is_empty() { Bounds::new(Vector::ZERO, Vector::ZERO) } else { bounds };
        let size = bounds.size();
        let most = (MOST_CELLS.min(4.0 * points.len() as f64 + 16.0)).powf(1.0 / D as f64);
        let cells: [usize; D] =
            std::array::from_fn(|k| ((size[k] / radius.max(f64::MIN_POSITIVE)).min(most) as usize).max(1));
        let lattice = Lattice::new(bounds, cells, period.is_some());
        let mut index = Self { lattice, period, starts: Vec::new(), order: Vec::new(), points: Vec::new() };
        index.sort(&wrapped);
        index
    }

    fn sort(&mut self, points: &[Vector<D>]) {
        let of: Vec<usize> = points.iter().map(|&p| self.lattice.nearest(p)).collect();
        self.starts = vec![0; self.lattice.count() + 1];
        for &c in &of {
            self.starts[c + 1] += 1;
        }
        for c in 1..self.starts.len() {
            self.starts[c] += self.starts[c - 1];
        }
        let mut next = self.starts.clone();
        self.order = vec![0; points.len()];
        self.points = vec![Vector::ZERO; points.len()];
        for (i, &c) in of.iter().enumerate() {
            let slot = next[c] as usize;
            next[c] += 1;
            self.order[slot] = i as u32;
            self.points[slot] = points[i];
        }
    }

    /// Calls `visit(i, offset)` for each point within `radius` of `p`, with the offset from `p` to it by the shortest way.
    /// Points come cell by cell, in a fixed order. On a torus a point comes once, even when the radius reaches around. Returns how many
    /// points and cells were looked at, within the radius or not: what the query cost.
    pub fn within(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(usize, Vector<D>)) -> u64 {
        let mut looked = 0;
        let most = radius * radius;
        self.lattice.rows(p, radius, |cells, _| {
            let (start, end) = (self.starts[cells.start] as usize, self.starts[cells.end] as usize);
            looked += (cells.len() + end - start) as u64;
            for (&i, &point) in self.order[start..end].iter().zip(&self.points[start..end]) {
                let offset = periodic::offset(p, point, self.period);
                if offset.norm2() <= most {
                    visit(i as usize, offset);
                }
            }
        });
        looked
    }

    /// Number of points that [`GridIndex::within`] would look at: at least those within `radius` of `p`.
    pub fn load(&self, p: Vector<D>, radius: f64) -> u64 {
        let mut looked = 0;
        self.lattice.rows(p, radius, |cells, _| looked += u64::from(self.starts[cells.end] - self.starts[cells.start]));
        looked
    }

    /// Number of points in the cell of a point, in the mean over all points: a handful where they spread evenly, as many as there are where
    /// they lie in one heap.
    pub fn crowding(&self) -> f64 {
        let squares: f64 = self.starts.windows(2).map(|w| f64::from(w[1] - w[0]).powi(2)).sum();
        squares / self.points.len().max(1) as f64
    }

    /// The cell with the most points: how many, and one of them. `None` without points.
    pub fn fullest(&self) -> Option<(usize, Vector<D>)> {
        let count = |w: &[u32]| (w[1] - w[0]) as usize;
        let fullest = self.starts.windows(2).max_by_key(|w| count(w))?;
        Some((count(fullest), *self.points.get(fullest[0] as usize)?))
    }

    /// The nearest point to `p` other than `except`, with its distance, no farther than `radius`.
    pub fn nearest(&self, p: Vector<D>, radius: f64, except: Option<usize>) -> Option<(usize, f64)> {
        self.nearest_counted(p, radius, except).0
    }

    /// As [`GridIndex::nearest`], with what the query cost.
    pub fn nearest_counted(&self, p: Vector<D>, radius: f64, except: Option<usize>) -> (Option<(usize, f64)>, u64) {
        let mut best: Option<(usize, f64)> = None;
        let looked = self.within(p, radius, |i, offset| {
            let d2 = offset.norm2();
            if Some(i) != except && best.is_none_or(|(j, b)| d2 < b || (d2 == b && i < j)) {
                best = Some((i, d2));
            }
        });
        (best.map(|(i, d2)| (i, d2.sqrt())), looked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

    fn check(domain: &Domain<2>, radius: f64) {
        let mut s = Stream::new(3, Stage::TEST, 0);
        let points: Vec<_> = (0..400).map(|_| Vector::xy(s.range(0.0, 10.0), s.range(0.0, 10.0))).collect();
        let index = GridIndex::new(&points, radius, domain);
        for _ in 0..50 {
            let p = Vector::xy(s.range(-2.0, 12.0), s.range(-2.0, 12.0));
            let mut got = Vec::new();
            index.within(p, radius, |i, _| got.push(i));
            got.sort_unstable();
            let want: Vec<_> = (0..400).filter(|&i| domain.offset(p, points[i]).norm() <= radius).collect();
            assert_eq!(got, want);
        }
    }

    #[test]
    fn heaps_are_known_and_take_few_cells() {
        let mut points = vec![Vector::xy(5.0, 5.0); 90];
        points.extend((0..10).map(|k| Vector::xy(1e9 * f64::from(k), 1e-9 * f64::from(k))));
        let index = GridIndex::new(&points, 1e-12, &Domain::Box(Bounds::around(points.iter().copied())));
        assert!(index.fullest().is_some_and(|(n, p)| n >= 90 && p[0] < 1e9));
        assert!(index.crowding() > 80.0 && index.lattice.count() <= 4 * points.len() + 16);
        assert!(index.load(points[0], 1.0) >= 90 && index.within(points[0], 1.0, |_, _| {}) >= 90);
    }

    #[test]
    fn radius_queries_agree_with_brute_force() {
        let bounds = Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(10.0, 10.0));
        for radius in [0.3, 1.7, 6.0] {
            check(&Domain::Box(bounds), radius);
            check(&Domain::Torus(bounds), radius);
        }
    }
}
