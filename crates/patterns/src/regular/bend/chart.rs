//! A chart: a part of the page with a map to the exemplar.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Matrix, NormalEquations, Prediction, Pull, Result, Vector};

use crate::regular::bend::raster::{HELD, Raster, SOLVE, Wanted};

/// Work for each cell.
const CELL: u64 = 1500;

/// Steps from cell to cell, and of the search in a cell, with which a place is found.
const WALK: usize = 24;
const NEWTON: usize = 12;

/// What lies beyond the border of a cell by less than this share of it lies in it.
const SLACK: f64 = 1e-6;

/// Stripes may be stretched along themselves this much more than across.
const ALONG: f64 = 8.0;

/// A part of the page with a map to the exemplar, given at the nodes of a raster and bilinear between them.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    raster: Raster,
    pub(crate) cells: Vec<usize>,
    /// The number of each cell of the raster among its own; none for those of others.
    number: Vec<Option<u32>>,
    /// The images of the corners of its cells.
    quads: Vec<[Vector<2>; 4]>,
    /// Its nodes in rising order, and where each lies in the exemplar.
    nodes: Vec<usize>,
    images: Vec<Vector<2>>,
    /// The middles of its cells, in the exemplar.
    index: GridIndex<2>,
    /// How far a place can be from the middle of its cell, where cells are smallest and where they are largest.
    reach: (f64, f64),
}

/// A place on the page where something of the exemplar comes to lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) at: Vector<2>,
    /// From a step in the exemplar to one on the page, and back.
    pub(crate) outward: Matrix<2>,
    pub(crate) inward: Matrix<2>,
}

impl Spot {
    /// How the exemplar is turned here, and the factor by which lengths grow in the mean.
    pub(crate) fn frame(&self) -> (Matrix<2>, f64) {
        (self.outward.nearest_rotation(), determinant(&self.outward).abs().sqrt())
    }
}

pub(crate) fn determinant(m: &Matrix<2>) -> f64 {
    m.0[0][0] * m.0[1][1] - m.0[0][1] * m.0[1][0]
}

/// The inverse; zero where there is none.
fn inverse(m: &Matrix<2>) -> Matrix<2> {
    let measure = determinant(m);
    let [[a, b], [c, d]] = m.0;
    if measure == 0.0 || !measure.is_finite() {
        return Matrix::zero();
    }
    Matrix([[d / measure, -b / measure], [-c / measure, a / measure]])
}

impl Chart {
    /// The map that follows the fields best in some cells, in rising order.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(raster: &Raster, wanted: &Wanted, cells: Vec<usize>, budget: &Budget) -> Result<Self> {
        budget.spend(CELL * cells.len() as u64)?;
        let mut nodes: Vec<usize> = cells.iter().flat_map(|&cell| raster.corners(cell)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |node: usize| nodes.binary_search(&node).unwrap_or(0) as u32;
        let mut predictions = Vec::with_capacity(4 * cells.len());
        for &cell in &cells {
            let corners = raster.corners(cell);
            let inward = wanted.inward(cell);
            for k in 0..4 {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                let offset = inward.apply(raster.node(b) - raster.node(a));
                // Errors count by what they are on the page.
                let weight = wanted.growth[cell].powi(2);
                predictions.push(Prediction { from: number(a), to: number(b), offset, weight });
            }
        }
        let pulls = vec![Pull { target: Vector::ZERO, weight: HELD }; nodes.len()];
        let equations = NormalEquations::<2>::new(&predictions, &pulls, vec![false; nodes.len()]);
        let images = equations.solve(SOLVE.0, SOLVE.1, budget)?;
        let mut number = vec![None; raster.count()];
        cells.iter().zip(0..).for_each(|(&cell, k)| number[cell] = Some(k));
        let empty = GridIndex::new(&[], 1.0, &Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(1.0))));
        let (raster, quads) = (raster.clone(), Vec::new());
        let mut chart = Self { raster, cells, number, quads, nodes, images, index: empty, reach: (1.0, 1.0) };
        chart.settle();
        Ok(chart)
    }

    /// Moves all images.
    pub(crate) fn move_by(&mut self, by: Vector<2>) {
        self.images.iter_mut().for_each(|image| *image += by);
        self.settle();
    }

    fn settle(&mut self) {
        let corner = |node| self.image(node).unwrap_or(Vector::ZERO);
        self.quads = self.cells.iter().map(|&cell| self.raster.corners(cell).map(corner)).collect();
        let middle = |[a, b, c, d]: &[Vector<2>; 4]| (*a + *b + *c + *d) * 0.25;
        let middles: Vec<Vector<2>> = self.quads.iter().map(middle).collect();
        let half = |[a, b, c, d]: &[Vector<2>; 4]| 0.75 * (*c - *a).norm().max((*d - *b).norm());
        let halves = self.quads.iter().map(half);
        let (low, high) = halves.fold((f64::INFINITY, f64::MIN_POSITIVE), |(l, h), v| (l.min(v), h.max(v)));
        self.reach = (low.max(0.02 * high), high);
        let extent = Bounds::around(middles.iter().copied()).grown(high);
        self.index = GridIndex::new(&middles, self.reach.0, &Domain::Box(extent));
    }

    /// The image of a node, where it is one of the chart.
    pub(crate) fn image(&self, node: usize) -> Option<Vector<2>> {
        Some(self.images[self.nodes.binary_search(&node).ok()?])
    }

    /// Its nodes.
    pub(crate) fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Where a node lies on the page.
    #[cfg(test)]
    pub(crate) fn raster_node(&self, node: usize) -> Vector<2> {
        self.raster.node(node)
    }

    /// Box around what it covers of the exemplar.
    pub(crate) fn extent(&self) -> Bounds<2> {
        Bounds::around(self.images.iter().copied())
    }

    /// The map's change at a place in a cell, by its coordinates there.
    fn inward(&self, [a, b, c, d]: &[Vector<2>; 4], at: Vector<2>) -> Matrix<2> {
        let along = (*b - *a) * (1.0 - at[1]) + (*c - *d) * at[1];
        let across = (*d - *a) * (1.0 - at[0]) + (*c - *b) * at[0];
        let (x, y) = (along * (1.0 / self.raster.step), across * (1.0 / self.raster.step));
        Matrix([[x[0], y[0]], [x[1], y[1]]])
    }

    /// The change in the middle of a cell, as a share of what is wanted there: how much it is stretched or turned away.
    /// Of stripes, `across` is the direction in the exemplar in which they repeat.
    pub(crate) fn stretch(&self, wanted: &Wanted, cell: usize, across: Option<Vector<2>>) -> f64 {
        let Some(number) = self.number[cell] else { return f64::INFINITY };
        let is = self.inward(&self.quads[number as usize], Vector::splat(0.5));
        let m = is.compose(&wanted.outward(cell));
        let measure = determinant(&m);
        if !(measure > 0.0 && measure.is_finite()) {
            return f64::INFINITY;
        }
        let longer = |factor: f64| factor.max(1.0 / factor) - 1.0;
        if let Some(n) = across {
            let (row, along) = (m.transpose().apply(n), m.transpose().apply(Vector::xy(-n[1], n[0])));
            let off = longer(row.norm()).max(row.angle_to(n).abs());
            return off.max(longer(measure / row.norm()) / ALONG).max(longer(along.norm()) / ALONG);
        }
        let squares: f64 = m.0.iter().flatten().map(|v| v * v).sum();
        // Sum and difference of the factors along the two axes of the stretch.
        let (sum, difference) = ((squares + 2.0 * measure).sqrt(), (squares - 2.0 * measure).max(0.0).sqrt());
        let (large, small) = (0.5 * (sum + difference), 0.5 * (sum - difference));
        let turned = (m.0[1][0] - m.0[0][1]).atan2(m.0[0][0] + m.0[1][1]);
        longer(large).max(longer(small)).max(turned.abs())
    }

    /// Where something at a place of the exemplar comes to lie; `None` outside of the chart.
    pub(crate) fn find(&self, image: Vector<2>) -> Option<Spot> {
        self.look(image, SLACK)
    }

    /// The same on the border of the chart, and a little beyond it.
    pub(crate) fn find_near(&self, image: Vector<2>) -> Option<Spot> {
        self.look(image, 1.0)
    }

    /// The same up to a distance beyond the border, in the exemplar.
    pub(crate) fn find_beyond(&self, image: Vector<2>, distance: f64) -> Option<Spot> {
        self.look(image, (distance / self.reach.0).min(WALK as f64))
    }

    /// `beyond`: how far beyond the border it may be, in cells of the raster.
    fn look(&self, image: Vector<2>, beyond: f64) -> Option<Spot> {
        let (small, large) = (self.reach.0, self.reach.1 * (1.0 + beyond));
        let mut reach = small;
        let mut number = loop {
            if let Some((nearest, _)) = self.index.nearest(image, reach, None) {
                break nearest;
            }
            if reach >= large {
                return None;
            }
            reach = (2.0 * reach).min(large);
        };
        for _ in 0..WALK {
            let (cell, corners) = (self.cells[number], &self.quads[number]);
            let at = self.coordinates(corners, image)?;
            let over = [at[0] - 1.0, at[1] - 1.0, -at[0], -at[1]];
            let way = (0..4).max_by(|&i, &j| over[i].total_cmp(&over[j]))?;
            let beside = self.raster.beside(cell, way).and_then(|next| self.number[next]);
            match beside.filter(|_| over[way] > SLACK) {
                Some(next) => number = next as usize,
                None if over[way] > beyond => return None,
                None => {
                    let inward = self.inward(corners, at);
                    let place = self.raster.node(self.raster.corners(cell)[0]) + at * self.raster.step;
                    return Some(Spot { at: place, outward: inverse(&inward), inward });
                }
            }
        }
        None
    }

    /// The coordinates in a cell of what has this image.
    fn coordinates(&self, corners: &[Vector<2>; 4], image: Vector<2>) -> Option<Vector<2>> {
        let [a, b, c, d] = *corners;
        let mut at = Vector::splat(0.5);
        for _ in 0..NEWTON {
            let (x, y) = (at[0], at[1]);
            let is = (a * (1.0 - x) + b * x) * (1.0 - y) + (d * (1.0 - x) + c * x) * y;
            let step = inverse(&self.inward(corners, at)).apply(image - is) * (1.0 / self.raster.step);
            at += step;
            if !at.is_finite() || at.norm() > 1e3 {
                return None;
            }
            if step.norm() < 1e-12 {
                break;
            }
        }
        Some(at)
    }

    /// The border of what it covers of the exemplar, as rings.
    pub(crate) fn border(&self) -> Vec<Vec<Vector<2>>> {
        let mut next: std::collections::BTreeMap<usize, Vec<usize>> = std::collections::BTreeMap::new();
        for &cell in &self.cells {
            let corners = self.raster.corners(cell);
            // The side to the right of a cell lies between its second and third corner, and so on.
            for (way, side) in [(3, 0), (0, 1), (1, 2), (2, 3)] {
                if self.raster.beside(cell, way).is_none_or(|c| self.number[c].is_none()) {
                    next.entry(corners[side]).or_default().push(corners[(side + 1) % 4]);
                }
            }
        }
        let mut rings = Vec::new();
        while let Some((&start, _)) = next.iter().find(|(_, to)| !to.is_empty()) {
            let (mut ring, mut node) = (Vec::new(), start);
            while let Some(to) = next.get_mut(&node).and_then(Vec::pop) {
                ring.extend(self.image(node));
                node = to;
            }
            next.retain(|_, to| !to.is_empty());
            rings.push(ring);
        }
        rings
    }
}
