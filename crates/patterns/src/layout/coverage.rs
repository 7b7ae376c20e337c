//! Which part of the output is laid out already.

use arabesque_core::{Domain, Lattice, Vector};

/// What is known about a cell of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cell {
    /// Nothing may lie here.
    Outside,
    /// Not laid out yet.
    Open,
    /// Laid out: what is not here is not meant to be here.
    Covered,
}

/// A raster over the output.
#[derive(Clone, Debug)]
pub(crate) struct Coverage<const D: usize> {
    lattice: Lattice<D>,
    state: Vec<Cell>,
}

impl<const D: usize> Coverage<D> {
    /// Rasters the domain grown by `margin`, with cells of about `cell`.
    pub(crate) fn new(domain: &Domain<D>, margin: f64, cell: f64) -> Self {
        let torus = domain.period().is_some();
        let bounds = if torus { domain.bounds() } else { domain.bounds().grown(margin) };
        let extent = bounds.size();
        let cells: [usize; D] = std::array::from_fn(|k| ((extent[k] / cell).ceil() as usize).clamp(1, 8192));
        let lattice = Lattice::new(bounds, cells, torus);
        let is_inside = |c| domain.signed_distance(lattice.centre(c)) >= -margin - 0.5 * lattice.cell()[0];
        let state = |c| if is_inside(c) { Cell::Open } else { Cell::Outside };
        Self { state: (0..lattice.count()).map(state).collect(), lattice }
    }

    /// Centre of cell `index`.
    pub(crate) fn centre(&self, index: usize) -> Vector<D> {
        self.lattice.centre(index)
    }

    /// State of the cell at `p`.
    pub(crate) fn at(&self, p: Vector<D>) -> Cell {
        self.lattice.at(p).map_or(Cell::Outside, |index| self.state[index])
    }

    /// Calls `visit(index, offset)` for the cells whose centre lies within `radius` of `p`.
    pub(crate) fn ball(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(usize, Vector<D>)) {
        self.lattice.around(p, radius, |index, place| {
            let offset = self.lattice.centre_at(place) - p;
            if offset.norm2() <= radius * radius {
                visit(index, offset);
            }
        });
    }

    /// Numbers of open and of all usable cells within `radius` of `p`.
    pub(crate) fn open_within(&self, p: Vector<D>, radius: f64) -> (usize, usize) {
        let (mut open, mut all) = (0, 0);
        self.ball(p, radius, |index, _| {
            open += usize::from(self.state[index] == Cell::Open);
            all += usize::from(self.state[index] != Cell::Outside);
        });
        (open, all)
    }

    /// Marks open cells within `radius` of `p` as covered where `known(offset)` holds.
    pub(crate) fn cover(&mut self, p: Vector<D>, radius: f64, known: impl Fn(Vector<D>) -> bool) {
        let mut hit = Vec::new();
        self.ball(p, radius, |index, offset| {
            if self.state[index] == Cell::Open && known(offset) {
                hit.push(index);
            }
        });
        hit.into_iter().for_each(|index| self.state[index] = Cell::Covered);
    }

    /// Marks as covered what lies where `known` says so.
    pub(crate) fn close(&mut self, known: impl Fn(Vector<D>) -> bool) {
        let hit: Vec<usize> = self.open().filter(|&c| known(self.centre(c))).collect();
        hit.into_iter().for_each(|c| self.state[c] = Cell::Covered);
    }

    /// Marks as covered what lies within `reach(p)` of the places given.
    pub(crate) fn cover_around(&mut self, places: impl Iterator<Item = Vector<D>>, reach: impl Fn(Vector<D>) -> f64) {
        places.for_each(|p| self.cover(p, reach(p), |_| true));
    }

    /// Marks as covered what the drawing at `places` closes in: the cells that no ball of `reach` covers without
    /// touching the drawing. Where the ball is too large for all that is open, smaller ones are tried.
    pub(crate) fn cover_closed(&mut self, places: &[Vector<D>], reach: f64) {
        for halving in 0..4 {
            let reach = reach * 0.5_f64.powi(halving);
            let mut near = vec![false; self.state.len()];
            places.iter().for_each(|&p| self.ball(p, reach, |index, _| near[index] = true));
            if (0..near.len()).all(|c| near[c] || self.state[c] != Cell::Open) {
                continue;
            }
            let is_shut = |c: usize| {
                let mut shut = near[c];
                if shut {
                    self.ball(self.centre(c), reach, |index, _| shut &= near[index]);
                }
                shut
            };
            let shut: Vec<usize> = self.open().filter(|&c| is_shut(c)).collect();
            shut.into_iter().for_each(|c| self.state[c] = Cell::Covered);
            return;
        }
    }

    /// The open cells, in order.
    pub(crate) fn open(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.state.len()).filter(|&c| self.state[c] == Cell::Open)
    }
}
