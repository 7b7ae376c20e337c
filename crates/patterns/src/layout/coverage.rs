//! Which part of the output is laid out already.

use arabesque_core::{Budget, Domain, Held, Lattice, Meter, Result, Vector};

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

/// Most cells along a side, and in all: of more than that, each is larger.
const MOST_CELLS: (usize, usize) = (8192, 8192 * 8192);

/// Nanoseconds to find out whether a cell may be used, and to look at one that is known.
const CELL: (u64, u64) = (20, 2);
/// Nanoseconds to find out whether a cell lies in a shape.
const CELL_OF_SHAPE: u64 = 250;

/// Cells that are made between two checks of the budget.
const BLOCK: usize = 1 << 12;

/// A raster over the output.
#[derive(Debug)]
pub(crate) struct Coverage<const D: usize> {
    lattice: Lattice<D>,
    state: Vec<Cell>,
    _held: Held,
}

impl<const D: usize> Coverage<D> {
    /// Rasters the domain grown by `margin`, with cells of about `cell`.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(domain: &Domain<D>, margin: f64, cell: f64, budget: &Budget) -> Result<Self> {
        let torus = domain.period().is_some();
        let bounds = if torus { domain.bounds() } else { domain.bounds().grown(margin) };
        let extent = bounds.size();
        let cells: [usize; D] = std::array::from_fn(|k| ((extent[k] / cell).ceil() as usize).clamp(1, MOST_CELLS.0));
        let lattice = Lattice::at_most(bounds, cells, torus, MOST_CELLS.1);
        let is_inside = |c| domain.signed_distance(lattice.centre(c)) >= -margin - 0.5 * lattice.cell()[0];
        let state = |c| if is_inside(c) { Cell::Open } else { Cell::Outside };
        let count = lattice.count();
        let price = if matches!(domain, Domain::Region(_)) { CELL_OF_SHAPE } else { CELL.0 };
        let (mut states, held) = budget.list("cells of the output", count)?;
        for first in (0..count).step_by(BLOCK) {
            let block = first..count.min(first + BLOCK);
            budget.spend(price * block.len() as u64)?;
            states.extend(block.map(state));
        }
        Ok(Self { state: states, lattice, _held: held })
    }

    /// Centre of cell `index`.
    pub(crate) fn centre(&self, index: usize) -> Vector<D> {
        self.lattice.centre(index)
    }

    /// State of the cell at `p`.
    pub(crate) fn at(&self, p: Vector<D>) -> Cell {
        self.lattice.at(p).map_or(Cell::Outside, |index| self.state[index])
    }

    /// Calls `visit(index, offset)` for the cells whose centre lies within `radius` of `p`. Returns about how many
    /// nanoseconds it took.
    fn ball(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(usize, Vector<D>)) -> u64 {
        let mut looked = 0;
        self.lattice.around(p, radius, |index, place| {
            looked += 1;
            let offset = self.lattice.centre_at(place) - p;
            if offset.norm2() <= radius * radius {
                visit(index, offset);
            }
        });
        looked * CELL.1
    }

    /// Whether a cell within `radius` of `p` is open.
    pub(crate) fn is_open_within(&self, p: Vector<D>, radius: f64, meter: &mut Meter<'_>) -> Result<bool> {
        let mut open = false;
        let price = self.ball(p, radius, |index, _| open |= self.state[index] == Cell::Open);
        meter.spend(price)?;
        Ok(open)
    }

    /// Marks open cells within `radius` of `p` as covered where `known(offset)` holds.
    pub(crate) fn cover(
        &mut self,
        p: Vector<D>,
        radius: f64,
        known: impl Fn(Vector<D>) -> bool,
        meter: &mut Meter<'_>,
    ) -> Result<()> {
        let mut hit = Vec::new();
        let price = self.ball(p, radius, |index, offset| {
            if self.state[index] == Cell::Open && known(offset) {
                hit.push(index);
            }
        });
        hit.into_iter().for_each(|index| self.state[index] = Cell::Covered);
        meter.spend(price)
    }

    /// Marks as covered what lies where `known` says so.
    pub(crate) fn close(&mut self, known: impl Fn(Vector<D>) -> bool, meter: &mut Meter<'_>) -> Result<()> {
        for c in 0..self.state.len() {
            meter.spend(if self.state[c] == Cell::Open { CELL.0 } else { 1 })?;
            if self.state[c] == Cell::Open && known(self.centre(c)) {
                self.state[c] = Cell::Covered;
            }
        }
        Ok(())
    }

    /// Marks as covered what lies within `reach(p)` of the places given.
    pub(crate) fn cover_around(
        &mut self,
        mut places: impl Iterator<Item = Vector<D>>,
        reach: impl Fn(Vector<D>) -> f64,
        meter: &mut Meter<'_>,
    ) -> Result<()> {
        places.try_for_each(|p| self.cover(p, reach(p), |_| true, meter))
    }

    /// Marks as covered what the drawing at `places` closes in: the cells that no ball of `reach` covers without
    /// touching the drawing. Where the ball is too large for all that is open, smaller ones are tried.
    pub(crate) fn cover_closed(&mut self, places: &[Vector<D>], reach: f64, meter: &mut Meter<'_>) -> Result<()> {
        for halving in 0..4 {
            let reach = reach * 0.5_f64.powi(halving);
            let mut near = vec![false; self.state.len()];
            meter.spend(CELL.1 * near.len() as u64)?;
            for &p in places {
                meter.spend(self.ball(p, reach, |index, _| near[index] = true))?;
            }
            if (0..near.len()).all(|c| near[c] || self.state[c] != Cell::Open) {
                continue;
            }
            let mut shut = Vec::new();
            for c in self.open().filter(|&c| near[c]) {
                let mut is_shut = true;
                meter.spend(self.ball(self.centre(c), reach, |index, _| is_shut &= near[index]))?;
                if is_shut {
                    shut.push(c);
                }
            }
            shut.into_iter().for_each(|c| self.state[c] = Cell::Covered);
            return Ok(());
        }
        Ok(())
    }

    /// The open cells, in order.
    pub(crate) fn open(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.state.len()).filter(|&c| self.state[c] == Cell::Open)
    }
}
