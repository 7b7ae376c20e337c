//! How the lattice of an exemplar lies in the output.

use arabesque_core::{
    Bounds, Budget, Domain, Exemplar, Fields, Matrix, OrientationField, Request, Result, ScalarField, Shape, Vector,
};

use crate::repeat::{
    Extent, Repeat,
    lattice::{Lattice, Node},
};

/// A tile that takes more stretching than this is not made from the lattice.
pub(crate) const MOST_STRETCH: f64 = 0.08;

/// Cells this near to a box, in terms of their own size, may show in it: places that were rounded or drawn by hand lie
/// just outside of their cell.
const NEAR: f64 = 0.1;

/// Work for each cell that is asked about.
const ASK: f64 = 20.0;

/// The lattice in the output.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Its vectors in the exemplar; where stripes are free to choose them, others than were found.
    pub(crate) source: Lattice,
    /// The same vectors in the output.
    pub(crate) lattice: Lattice,
    /// From exemplar coordinates to the output: `linear`, then `shift`.
    linear: Matrix<2>,
    shift: Vector<2>,
    /// How elements are turned and scaled.
    pub(crate) rotation: Matrix<2>,
    pub(crate) element_scale: f64,
    /// The nodes of a tile.
    pub(crate) tiling: Option<Tiling>,
    /// Largest relative change of a length that fitting it into a tile took.
    pub(crate) stretch: f64,
}

/// Where strokes and areas are drawn.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) request: &'a Request<2>,
    /// What is in the way.
    pub(crate) obstacles: Option<&'a Shape>,
}

/// Why a request cannot be served by a lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unfit {
    /// Fields bend it.
    Fields,
    /// A tile does not suit it, not even stretched as far as allowed.
    Tile,
}

/// The one frame of fields that are the same everywhere: rotation, scale of elements, scale of distances.
pub(crate) fn constant(fields: &Fields<2>) -> Option<(Matrix<2>, f64, f64)> {
    let turn = match &fields.orientation {
        None => Matrix::identity(),
        Some(OrientationField::Constant(turn)) => *turn,
        Some(OrientationField::Grid(_) | OrientationField::Of(_)) => return None,
    };
    let ScalarField::Constant(scale) = fields.scale else { return None };
    let ScalarField::Constant(density) = fields.density else { return None };
    Some((turn, scale, scale * density.powf(-0.5)))
}

impl Grid {
    /// The lattice for a request.
    pub(crate) fn new(
        repeat: &Repeat,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
    ) -> std::result::Result<Self, Unfit> {
        let Some((rotation, element_scale, spacing)) = constant(&request.fields) else { return Err(Unfit::Fields) };
        let straight = |v: Vector<2>| rotation.apply(v) * spacing;
        let mut grid = Self {
            source: repeat.lattice,
            lattice: repeat.lattice.map(straight),
            linear: Matrix(rotation.0.map(|row| row.map(|entry| entry * spacing))),
            shift: Vector::ZERO,
            rotation,
            element_scale,
            tiling: None,
            stretch: 0.0,
        };
        if let Domain::Torus(tile) = &request.domain {
            let fit =
                repeat.fit(tile.size(), &straight).filter(|fit| fit.stretch <= MOST_STRETCH).ok_or(Unfit::Tile)?;
            if matches!(repeat.extent, Extent::Stripes(_)) {
                grid.source = grid.pulled_back(&fit.lattice);
            }
            grid.lattice = fit.lattice;
            grid.linear = linear(&grid.source, &grid.lattice);
            (grid.tiling, grid.stretch) = (Some(Tiling::new(fit.sides)), fit.stretch);
        }
        let turned = rotation != Matrix::identity();
        grid.shift = match &request.domain {
            // What lies at the corner of the frame lies at the corner of the page.
            Domain::Box(page) | Domain::Torus(page) if !turned => page.min - grid.linear.apply(exemplar.window.min),
            Domain::Region(_) if !turned && spacing == 1.0 => Vector::ZERO,
            domain => domain.bounds().centre() - grid.linear.apply(exemplar.window.centre()),
        };
        Ok(grid)
    }

    /// The lattice as it lies in the exemplar.
    pub(crate) fn flat(repeat: &Repeat) -> Self {
        Self {
            source: repeat.lattice,
            lattice: repeat.lattice,
            linear: Matrix::identity(),
            shift: Vector::ZERO,
            rotation: Matrix::identity(),
            element_scale: 1.0,
            tiling: None,
            stretch: 0.0,
        }
    }

    /// The vectors in the exemplar that become those of `lattice`.
    fn pulled_back(&self, lattice: &Lattice) -> Lattice {
        let [[a, b], [c, d]] = self.linear.0;
        let measure = a * d - b * c;
        lattice.map(|v| Vector::xy(d * v[0] - b * v[1], a * v[1] - c * v[0]) * (1.0 / measure))
    }

    /// Moves the whole pattern.
    pub(crate) fn move_by(&mut self, by: Vector<2>) {
        self.shift += by;
    }

    /// From the exemplar to the output: what is applied first, and the shift after it.
    pub(crate) fn map(&self) -> (Matrix<2>, Vector<2>) {
        (self.linear, self.shift)
    }

    /// Where a place of the exemplar lies in the output, `node` of the lattice on.
    pub(crate) fn place(&self, p: Vector<2>, node: Node) -> Vector<2> {
        self.vector(p) + self.shift + self.lattice.at(node)
    }

    /// A vector of the exemplar in the output.
    pub(crate) fn vector(&self, v: Vector<2>) -> Vector<2> {
        self.linear.apply(v)
    }

    /// The node of the tile that is the same as this one; without a tile, the node itself.
    pub(crate) fn wrap(&self, node: Node) -> Node {
        self.tiling.map_or(node, |tiling| tiling.wrap(node))
    }

    /// The nodes of a tile, or all of which the cell may reach into a box. `corner`: of the cell at the origin, in the
    /// exemplar.
    ///
    /// # Errors
    /// When there are more than may be asked about.
    pub(crate) fn nodes(&self, corner: Vector<2>, bounds: &Bounds<2>, budget: &Budget) -> Result<Vec<Node>> {
        if let Some(tiling) = &self.tiling {
            return Ok(tiling.nodes());
        }
        self.nodes_around(corner, bounds, budget)
    }

    /// All nodes of which the cell may reach into a box, on a torus the same ones of the tile again and again.
    ///
    /// # Errors
    /// When there are more than may be asked about.
    pub(crate) fn nodes_around(&self, corner: Vector<2>, bounds: &Bounds<2>, budget: &Budget) -> Result<Vec<Node>> {
        let [rows, columns] = self.lattice.nodes_in(self.place(corner, [0, 0]), bounds);
        let [a, b] = self.lattice.vectors;
        let near = |node: &Node| {
            let corner = self.place(corner, *node);
            let cell = Bounds::around([corner, corner + a, corner + b, corner + a + b]);
            cell.grown(NEAR * (a.norm() + b.norm())).intersects(bounds)
        };
        let count = (rows.end() - rows.start() + 3) as f64 * (columns.end() - columns.start() + 3) as f64;
        budget.spend((ASK * count) as u64)?;
        budget.within_expected("cells of the repeat", count, ("output-elements", budget.limits().output_elements))?;
        let rows = rows.start() - 1..=rows.end() + 1;
        let all = (columns.start() - 1..=columns.end() + 1).flat_map(|j| rows.clone().map(move |i| [i, j]));
        Ok(all.filter(near).collect())
    }

    /// What of the exemplar's plane a domain covers along each of two axes of length 1.
    pub(crate) fn ranges(&self, domain: &Domain<2>, axes: [Vector<2>; 2]) -> [[f64; 2]; 2] {
        let bounds = domain.bounds();
        let corners = [
            bounds.min,
            Vector::xy(bounds.max[0], bounds.min[1]),
            bounds.max,
            Vector::xy(bounds.min[0], bounds.max[1]),
        ];
        let zero = self.place(Vector::ZERO, [0, 0]);
        let scale2 = self.scale().powi(2);
        axes.map(|axis| {
            let there = self.vector(axis);
            let all = corners.map(|corner| (corner - zero).dot(there) / scale2);
            [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
        })
    }

    /// Mean factor by which lengths grow.
    pub(crate) fn scale(&self) -> f64 {
        let [[a, b], [c, d]] = self.linear.0;
        (a * d - b * c).abs().sqrt()
    }
}

/// The linear map that takes the vectors of one lattice to those of the other.
fn linear(from: &Lattice, to: &Lattice) -> Matrix<2> {
    let columns = [Vector::xy(1.0, 0.0), Vector::xy(0.0, 1.0)].map(|axis| to.vector(from.coordinates(axis)));
    Matrix([[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]])
}

/// The nodes of a tile: those that differ by its sides are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tiling {
    /// The sides in Hermite normal form: they span the same nodes as these two.
    first: Node,
    second: i64,
}

impl Tiling {
    /// The tiling by two sides, which are independent.
    fn new([mut u, mut v]: [Node; 2]) -> Self {
        while v[0] != 0 {
            let steps = u[0].div_euclid(v[0]);
            (u, v) = (v, [u[0] - steps * v[0], u[1] - steps * v[1]]);
        }
        let first = if u[0] < 0 { u.map(|n| -n) } else { u };
        Self { first, second: v[1].abs() }
    }

    /// One of each.
    pub(crate) fn nodes(&self) -> Vec<Node> {
        (0..self.first[0]).flat_map(|i| (0..self.second).map(move |j| [i, j])).collect()
    }

    /// The one in [`Tiling::nodes`] that is the same as a node.
    pub(crate) fn wrap(&self, node: Node) -> Node {
        let turns = node[0].div_euclid(self.first[0]);
        let around = [node[0] - turns * self.first[0], node[1] - turns * self.first[1]];
        [around[0], around[1].rem_euclid(self.second)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_of_a_tile_has_one_representative() {
        for sides in [[[3, 0], [0, 4]], [[2, 1], [-1, 3]], [[4, -2], [2, 3]], [[0, 5], [3, 0]], [[-6, 0], [3, 2]]] {
            let [[a, b], [c, d]] = sides;
            let measure = a * d - b * c;
            let tiling = Tiling::new(sides);
            let nodes = tiling.nodes();
            assert_eq!(nodes.len() as i64, measure.abs(), "{sides:?}");
            let differ_by_sides = |p: Node, q: Node| {
                let (x, y) = (p[0] - q[0], p[1] - q[1]);
                (x * d - y * c) % measure == 0 && (a * y - b * x) % measure == 0
            };
            for (k, &p) in nodes.iter().enumerate() {
                assert!(nodes[k + 1..].iter().all(|&q| !differ_by_sides(p, q)), "{sides:?}: {p:?}");
            }
            for node in [[7, -3], [-11, 5], [0, 0], [100, 99]] {
                let same = tiling.wrap(node);
                assert!(nodes.contains(&same) && differ_by_sides(node, same), "{sides:?}: {node:?}");
            }
        }
    }
}
