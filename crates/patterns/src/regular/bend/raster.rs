//! The raster on which fields are followed, and what they ask for in its cells.

use arabesque_core::{Bounds, Budget, Fields, Matrix, NormalEquations, Prediction, Pull, Result, Vector};

/// Cells along the longer side.
const CELLS: (f64, f64) = (40.0, 96.0);

/// Cells of the lattice are divided into so many of the raster, where that is not too many.
const FINER: f64 = 3.0;

/// Work for each cell.
const CELL: u64 = 400;

/// Steps and accuracy in which a field is solved for.
pub(crate) const SOLVE: (f64, usize) = (1e-6, 1500);

/// How firmly an unknown that nothing else holds is held.
pub(crate) const HELD: f64 = 1e-9;

/// Square cells over a part of the page.
#[derive(Clone, Debug)]
pub(crate) struct Raster {
    pub(crate) corner: Vector<2>,
    pub(crate) step: f64,
    pub(crate) cells: [usize; 2],
}

impl Raster {
    /// A raster over a box; `unit`: the shorter vector of the lattice in the output, where it is smallest.
    pub(crate) fn over(bounds: &Bounds<2>, unit: f64) -> Self {
        let size = bounds.size();
        let longest = size[0].max(size[1]);
        let step = longest / (FINER * longest / unit).clamp(CELLS.0, CELLS.1).ceil();
        Self { corner: bounds.min, step, cells: [0, 1].map(|k| ((size[k] / step - 1e-9).ceil() as usize).max(1)) }
    }

    /// Number of cells.
    pub(crate) fn count(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// The nodes at the corners of a cell, one after the other around it.
    pub(crate) fn corners(&self, cell: usize) -> [usize; 4] {
        let wide = self.cells[0] + 1;
        let first = cell / self.cells[0] * wide + cell % self.cells[0];
        [first, first + 1, first + wide + 1, first + wide]
    }

    /// Where a node lies.
    pub(crate) fn node(&self, node: usize) -> Vector<2> {
        let wide = self.cells[0] + 1;
        self.corner + Vector::xy((node % wide) as f64, (node / wide) as f64) * self.step
    }

    /// The middle of a cell.
    pub(crate) fn centre(&self, cell: usize) -> Vector<2> {
        self.node(self.corners(cell)[0]) + Vector::splat(0.5 * self.step)
    }

    /// The cell beside another: to the right, below, to the left, above.
    pub(crate) fn beside(&self, cell: usize, way: usize) -> Option<usize> {
        let (x, y) = (cell % self.cells[0], cell / self.cells[0]);
        match way {
            0 => (x + 1 < self.cells[0]).then(|| cell + 1),
            1 => (y + 1 < self.cells[1]).then(|| cell + self.cells[0]),
            2 => (x > 0).then(|| cell - 1),
            _ => (y > 0).then(|| cell - self.cells[0]),
        }
    }
}

/// What the fields ask for in each cell of a raster.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    /// By how much the pattern is turned, in radians.
    turn: Vec<f64>,
    /// By how much distances grow.
    pub(crate) growth: Vec<f64>,
    /// How much more, as a logarithm, distances would have to grow for a map to follow the turns without stretching, up to
    /// a constant.
    pub(crate) misfit: Vec<f64>,
}

impl Wanted {
    /// Reads the fields.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(raster: &Raster, fields: &Fields<2>, budget: &Budget) -> Result<Self> {
        budget.spend(CELL * raster.count() as u64)?;
        let frames = (0..raster.count()).map(|cell| fields.frame(raster.centre(cell)));
        let (turn, growth) = frames.map(|f| (f.rotation.angle(), f.spacing_scale)).unzip();
        let mut wanted = Self { turn, growth, misfit: Vec::new() };
        wanted.misfit = wanted.misfit(raster, budget)?;
        Ok(wanted)
    }

    /// From the output to the exemplar, as it is wanted in a cell.
    pub(crate) fn inward(&self, cell: usize) -> Matrix<2> {
        let turned = Matrix::rotation(-self.turn[cell]);
        Matrix(turned.0.map(|row| row.map(|entry| entry / self.growth[cell])))
    }

    /// The way back.
    pub(crate) fn outward(&self, cell: usize) -> Matrix<2> {
        let turned = Matrix::rotation(self.turn[cell]);
        Matrix(turned.0.map(|row| row.map(|entry| entry * self.growth[cell])))
    }

    /// A turn that changes across a direction needs a growth that changes along it: turn and logarithm of the growth of a map
    /// that keeps angles are the two parts of one function of a complex number.
    fn misfit(&self, raster: &Raster, budget: &Budget) -> Result<Vec<f64>> {
        let change = |a: usize, b: usize| {
            let turn = self.turn[b] - self.turn[a];
            turn.sin().atan2(turn.cos())
        };
        let slope = |cell: usize, axis: usize| {
            let (after, before) = (raster.beside(cell, axis), raster.beside(cell, axis + 2));
            match (before, after) {
                (Some(b), Some(a)) => 0.5 * (change(b, cell) + change(cell, a)),
                (None, Some(a)) => change(cell, a),
                (Some(b), None) => change(b, cell),
                (None, None) => 0.0,
            }
        };
        let mut predictions = Vec::with_capacity(2 * raster.count());
        for cell in 0..raster.count() {
            for axis in 0..2 {
                let Some(next) = raster.beside(cell, axis) else { continue };
                let across = 0.5 * (slope(cell, 1 - axis) + slope(next, 1 - axis));
                let grows = if axis == 0 { across } else { -across };
                let offset = Vector([grows]);
                predictions.push(Prediction { from: cell as u32, to: next as u32, offset, weight: 1.0 });
            }
        }
        let pulls = vec![Pull { target: Vector([0.0]), weight: HELD }; raster.count()];
        let equations = NormalEquations::<1>::new(&predictions, &pulls, vec![false; pulls.len()]);
        let grown = equations.solve(SOLVE.0, SOLVE.1, budget)?;
        Ok(grown.iter().zip(&self.growth).map(|(g, s)| g[0] - s.ln()).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Grid, OrientationField, ScalarField};

    use super::*;

    fn bounds() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(100.0, 60.0))
    }

    #[test]
    fn rings_around_a_place_ask_for_growth_with_the_distance_from_it() {
        let raster = Raster::over(&bounds(), 5.0);
        let hub = Vector::xy(-60.0, 30.0);
        let mut field = Grid { bounds: bounds(), nodes: [101, 61], values: vec![Matrix::identity(); 101 * 61] };
        for k in 0..field.values.len() {
            let out = field.node(k) - hub;
            field.values[k] = Matrix::rotation(out[0].atan2(-out[1]));
        }
        let fields = Fields { orientation: Some(OrientationField::Grid(field)), ..Fields::default() };
        let wanted = Wanted::new(&raster, &fields, &Budget::default()).unwrap();
        let (near, far) = (0..raster.count()).fold((0, 0), |(a, b), c| {
            let from = |c: usize| (raster.centre(c) - hub).norm();
            (if from(c) < from(a) { c } else { a }, if from(c) > from(b) { c } else { b })
        });
        let expected = ((raster.centre(far) - hub).norm() / (raster.centre(near) - hub).norm()).ln();
        let found = wanted.misfit[far] - wanted.misfit[near];
        assert!((found - expected).abs() < 0.05, "{found} for {expected}");
    }

    #[test]
    fn a_scale_that_grows_asks_for_less() {
        let raster = Raster::over(&bounds(), 5.0);
        let values = vec![1.0, 2.0, 1.0, 2.0];
        let scale = ScalarField::Grid(Grid { bounds: bounds(), nodes: [2, 2], values });
        let wanted = Wanted::new(&raster, &Fields { scale, ..Fields::default() }, &Budget::default()).unwrap();
        let ends = wanted.misfit[0] - wanted.misfit[raster.cells[0] - 1];
        assert!((ends - 2.0_f64.ln()).abs() < 0.02, "{ends}");
    }
}
