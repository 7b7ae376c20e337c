//! A uniform grid of points that can grow.

use crate::{index::Lattice, region::Domain, space::Vector};

/// Point numbers in the cells of a uniform grid over a box; on a torus the cells divide the period. Where all points are known
/// beforehand, [`crate::GridIndex`] is smaller and faster.
#[derive(Clone, Debug)]
pub struct Buckets<const D: usize> {
    lattice: Lattice<D>,
    lists: Vec<Vec<u32>>,
}

/// Most cells along a coordinate, and along all together: bounds memory where the domain is large and the cells are small.
const MOST_CELLS: (usize, usize) = (4096, 1 << 22);

impl<const D: usize> Buckets<D> {
    /// An empty grid over the domain grown by `margin`, with cells of about `cell`.
    pub fn new(domain: &Domain<D>, margin: f64, cell: f64) -> Self {
        let is_periodic = domain.period().is_some();
        let bounds = if is_periodic { domain.bounds() } else { domain.bounds().grown(margin) };
        let counts = bounds.size().0.map(|side| ((side / cell) as usize).clamp(1, MOST_CELLS.0));
        let lattice = Lattice::at_most(bounds, counts, is_periodic, MOST_CELLS.1);
        Self { lists: vec![Vec::new(); lattice.count()], lattice }
    }

    /// Adds point `i` at `p`.
    pub fn insert(&mut self, i: u32, p: Vector<D>) {
        let cell = self.lattice.at(p).unwrap_or_else(|| self.lattice.nearest(p));
        self.lists[cell].push(i);
    }

    /// Calls `visit(i)` for every point in the cells that the box around a ball touches, in a fixed order: at least the points in the ball.
    /// Returns what the query cost: the number of these points and of the cells.
    pub fn near(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(u32)) -> u64 {
        let mut looked = 0;
        self.lattice.around(p, radius, |cell, _| {
            looked += 1 + self.lists[cell].len() as u64;
            self.lists[cell].iter().for_each(|&i| visit(i));
        });
        looked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        random::{Stage, Stream},
        space::Bounds,
    };

    #[test]
    fn no_point_in_the_ball_is_missed_and_none_comes_twice() {
        let bounds = Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(10.0, 6.0));
        let mut random = Stream::new(4, Stage::TEST, 0);
        for domain in [Domain::Box(bounds), Domain::Torus(bounds)] {
            let mut buckets = Buckets::new(&domain, 1.0, 0.7);
            let mut points: Vec<Vector<2>> = Vec::new();
            for i in 0..300 {
                // A few lie beyond the margin.
                points.push(domain.wrap(Vector::xy(random.range(-2.0, 12.0), random.range(-2.0, 8.0))));
                buckets.insert(i, points[i as usize]);
                let (p, radius) = (points[random.below(points.len())], random.range(0.1, 4.0));
                let mut met = Vec::new();
                buckets.near(p, radius, |i| met.push(i as usize));
                assert!((0..points.len()).all(|i| domain.offset(p, points[i]).norm() > radius || met.contains(&i)));
                met.sort_unstable();
                assert!(met.windows(2).all(|w| w[0] != w[1]));
            }
        }
    }
}
