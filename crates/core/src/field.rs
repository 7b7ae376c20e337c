//! Quantities that vary over the domain.

use crate::{Bounds, Matrix, Vector};

/// Values on the nodes of a regular grid, first coordinate fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<const D: usize, T> {
    /// The box whose corners are the outermost nodes.
    pub bounds: Bounds<D>,
    /// Nodes along each coordinate, each at least 1.
    pub nodes: [usize; D],
    /// One value a node: `values.len()` is the product of `nodes`.
    pub values: Vec<T>,
}

impl<const D: usize, T: Copy> Grid<D, T> {
    /// Calls `visit(weight, value)` for the corners of the cell around `p`, which is first moved into the box. The weights sum to 1.
    pub fn interpolate(&self, p: Vector<D>, mut visit: impl FnMut(f64, T)) {
        let size = self.bounds.size();
        let mut low = [0; D];
        let mut part = [0.0; D];
        for k in 0..D {
            let cells = self.nodes[k] - 1;
            let u = ((p[k] - self.bounds.min[k]) / size[k].max(f64::MIN_POSITIVE)).clamp(0.0, 1.0) * cells as f64;
            low[k] = (u as usize).min(cells.saturating_sub(1));
            part[k] = if cells == 0 { 0.0 } else { u - low[k] as f64 };
        }
        for corner in 0..1_usize << D {
            let (mut weight, mut index, mut stride) = (1.0, 0, 1);
            for k in 0..D {
                let upper = (corner >> k) & 1;
                weight *= if upper == 1 { part[k] } else { 1.0 - part[k] };
                index += (low[k] + upper).min(self.nodes[k] - 1) * stride;
                stride *= self.nodes[k];
            }
            if weight > 0.0 {
                visit(weight, self.values[index]);
            }
        }
    }

    /// Position of node `index`.
    pub fn node(&self, index: usize) -> Vector<D> {
        let size = self.bounds.size();
        let mut rest = index;
        Vector(std::array::from_fn(|k| {
            let i = rest % self.nodes[k];
            rest /= self.nodes[k];
            let cells = (self.nodes[k] - 1).max(1) as f64;
            self.bounds.min[k] + size[k] * i as f64 / cells
        }))
    }
}

/// A positive number at every point: scale or density.
#[derive(Clone, Debug, PartialEq)]
pub enum ScalarField<const D: usize> {
    /// The same everywhere.
    Constant(f64),
    /// Multilinear between grid nodes, constant beyond the grid.
    Grid(Grid<D, f64>),
}

impl<const D: usize> ScalarField<D> {
    /// Value at `p`.
    pub fn at(&self, p: Vector<D>) -> f64 {
        match self {
            Self::Constant(v) => *v,
            Self::Grid(grid) => {
                let mut sum = 0.0;
                grid.interpolate(p, |w, v| sum += w * v);
                sum
            }
        }
    }

    /// Smallest and largest value.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Self::Constant(v) => (*v, *v),
            Self::Grid(grid) => {
                grid.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)))
            }
        }
    }
}

/// A rotation at every point: how the pattern is turned there.
#[derive(Clone, Debug, PartialEq)]
pub enum OrientationField<const D: usize> {
    /// The same everywhere.
    Constant(Matrix<D>),
    /// Blended between grid nodes and made a rotation again.
    Grid(Grid<D, Matrix<D>>),
}

impl<const D: usize> OrientationField<D> {
    /// Rotation at `p`.
    pub fn at(&self, p: Vector<D>) -> Matrix<D> {
        match self {
            Self::Constant(r) => *r,
            Self::Grid(grid) => {
                let mut sum = Matrix::zero();
                grid.interpolate(p, |w, r| {
                    for (row, add) in sum.0.iter_mut().zip(r.0) {
                        for (v, a) in row.iter_mut().zip(add) {
                            *v += w * a;
                        }
                    }
                });
                sum.nearest_rotation()
            }
        }
    }
}

/// A directed stroke that says which way the pattern flows: a polyline in output coordinates.
pub type FlowStroke = Vec<Vector<2>>;

impl OrientationField<2> {
    /// The smoothest field that follows the strokes: directions spread from them over `bounds` by relaxation of the
    /// unit vectors (harmonic in each component, made unit at the end). Along a stroke the x axis of the exemplar points the way it was drawn.
    ///
    /// `nodes` is the number of grid nodes along the longer side, at least 2. Returns `None` when no stroke has a length.
    pub fn from_strokes(strokes: &[FlowStroke], bounds: Bounds<2>, nodes: usize) -> Option<Self> {
        let grid = stroke_grid(bounds, nodes);
        let mut fixed = vec![Vector::<2>::ZERO; grid.values.len()];
        for stroke in strokes {
            splat(stroke, &grid, &mut fixed);
        }
        if fixed.iter().all(|v| v.norm2() == 0.0) {
            return None;
        }
        let direction = relax(&fixed, grid.nodes);
        let values = direction.iter().map(|v| Matrix::rotation(v[1].atan2(v[0]))).collect();
        Some(Self::Grid(Grid { bounds: grid.bounds, nodes: grid.nodes, values }))
    }
}

fn stroke_grid(bounds: Bounds<2>, nodes: usize) -> Grid<2, ()> {
    let size = bounds.size();
    let step = size[0].max(size[1]) / (nodes.max(2) - 1) as f64;
    let count = |s: f64| (s / step).round() as usize + 1;
    let nodes = [count(size[0]).max(2), count(size[1]).max(2)];
    Grid { bounds, nodes, values: vec![(); nodes[0] * nodes[1]] }
}

/// Adds the directions of a stroke to the nearest nodes, at half the node spacing.
fn splat(stroke: &[Vector<2>], grid: &Grid<2, ()>, fixed: &mut [Vector<2>]) {
    let size = grid.bounds.size();
    let step = 0.5 * (size[0] / (grid.nodes[0] - 1) as f64).min(size[1] / (grid.nodes[1] - 1) as f64);
    for pair in stroke.windows(2) {
        let along = pair[1] - pair[0];
        let length = along.norm();
        if length == 0.0 || !length.is_finite() {
            continue;
        }
        let pieces = ((length / step).ceil() as usize).clamp(1, 100_000);
        for k in 0..=pieces {
            let p = pair[0] + along * (k as f64 / pieces as f64);
            if !grid.bounds.contains(p) {
                continue;
            }
            let at = |k: usize| ((p[k] - grid.bounds.min[k]) / size[k] * (grid.nodes[k] - 1) as f64).round() as usize;
            fixed[at(1) * grid.nodes[0] + at(0)] += along * (1.0 / length);
        }
    }
}

/// Solves Laplace's equation for both components with the splatted nodes held, coarse to fine.
fn relax(fixed: &[Vector<2>], nodes: [usize; 2]) -> Vec<Vector<2>> {
    let held: Vec<bool> = fixed.iter().map(|v| v.norm2() > 0.0).collect();
    let count = held.iter().filter(|h| **h).count().max(1) as f64;
    let unit = |v: Vector<2>| v * (1.0 / v.norm().max(f64::MIN_POSITIVE));
    let mean = fixed.iter().filter(|v| v.norm2() > 0.0).fold(Vector::ZERO, |s, &v| s + unit(v)) * (1.0 / count);
    let mut field: Vec<_> = fixed.iter().map(|&v| if v.norm2() > 0.0 { unit(v) } else { mean }).collect();
    // Red-black successive over-relaxation: a few hundred sweeps settle grids of a hundred nodes a side.
    let longest = nodes[0].max(nodes[1]) as f64;
    let omega = 2.0 / (1.0 + (std::f64::consts::PI / longest).sin());
    for sweep in 0..(8.0 * longest) as usize {
        let colour = sweep % 2;
        for y in 0..nodes[1] {
            for x in ((y + colour) % 2..nodes[0]).step_by(2) {
                let k = y * nodes[0] + x;
                if !held[k] {
                    field[k] = field[k] * (1.0 - omega) + neighbour_mean(&field, nodes, x, y) * omega;
                }
            }
        }
    }
    field
}

fn neighbour_mean(field: &[Vector<2>], nodes: [usize; 2], x: usize, y: usize) -> Vector<2> {
    let at = |x: usize, y: usize| field[y * nodes[0] + x];
    let left = at(x.saturating_sub(1), y);
    let right = at((x + 1).min(nodes[0] - 1), y);
    let down = at(x, y.saturating_sub(1));
    let up = at(x, (y + 1).min(nodes[1] - 1));
    (left + right + down + up) * 0.25
}

/// The fields of one run.
#[derive(Clone, Debug)]
pub struct Fields<const D: usize> {
    /// How the pattern is turned; `None` leaves it as in the exemplar.
    pub orientation: Option<OrientationField<D>>,
    /// Size of the pattern, elements and gaps alike: 2 is twice as large as in the exemplar. Default 1.
    pub scale: ScalarField<D>,
    /// Elements per area relative to the exemplar, at unchanged element size: 0.5 is half as many. Default 1.
    pub density: ScalarField<D>,
}

impl<const D: usize> Default for Fields<D> {
    fn default() -> Self {
        Self { orientation: None, scale: ScalarField::Constant(1.0), density: ScalarField::Constant(1.0) }
    }
}

impl<const D: usize> Fields<D> {
    /// The local frame at `p`: rotation of the pattern, size of an element, and size of the gaps between elements.
    pub fn frame(&self, p: Vector<D>) -> Frame<D> {
        let element_scale = self.scale.at(p);
        Frame {
            rotation: self.orientation.as_ref().map_or_else(Matrix::identity, |o| o.at(p)),
            element_scale,
            spacing_scale: element_scale * self.density.at(p).powf(-1.0 / D as f64),
        }
    }

    /// Whether the pattern is turned, scaled and spaced as in the exemplar everywhere.
    pub fn are_neutral(&self) -> bool {
        self.orientation.is_none()
            && self.scale == ScalarField::Constant(1.0)
            && self.density == ScalarField::Constant(1.0)
    }
}

/// Rotation and scale at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<const D: usize> {
    /// From exemplar directions to output directions.
    pub rotation: Matrix<D>,
    /// Size of an element relative to the exemplar.
    pub element_scale: f64,
    /// Size of an offset between elements relative to the exemplar.
    pub spacing_scale: f64,
}

impl<const D: usize> Frame<D> {
    /// An offset of the exemplar as it appears here.
    pub fn to_output(&self, v: Vector<D>) -> Vector<D> {
        self.rotation.apply(v) * self.spacing_scale
    }

    /// An offset found here as it would appear in the exemplar [Ma 2011 §5, eq. 7].
    pub fn to_exemplar(&self, v: Vector<D>) -> Vector<D> {
        self.rotation.transpose().apply(v) * (1.0 / self.spacing_scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stroke_turns_the_whole_field_its_way() {
        let bounds = Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(100.0, 50.0));
        let stroke = vec![Vector::xy(10.0, 10.0), Vector::xy(60.0, 60.0)];
        let field = OrientationField::from_strokes(&[stroke], bounds, 33).unwrap();
        for p in [Vector::xy(1.0, 49.0), Vector::xy(99.0, 1.0)] {
            assert!((field.at(p).angle() - std::f64::consts::FRAC_PI_4).abs() < 1e-6);
        }
    }

    #[test]
    fn between_two_strokes_the_field_turns_steadily() {
        let bounds = Bounds::new(Vector::xy(0.0, 0.0), Vector::xy(100.0, 100.0));
        let right = vec![Vector::xy(0.0, 0.0), Vector::xy(100.0, 0.0)];
        let slanted = vec![Vector::xy(0.0, 99.0), Vector::xy(1.0, 100.0)];
        let field = OrientationField::from_strokes(&[right, slanted], bounds, 33).unwrap();
        let angle = |y| field.at(Vector::xy(1.0, y)).angle();
        assert!(angle(2.0) < angle(50.0) && angle(50.0) < angle(98.0));
    }

    #[test]
    fn density_widens_gaps_but_not_elements() {
        let fields = Fields::<2> { density: ScalarField::Constant(0.25), ..Fields::default() };
        let frame = fields.frame(Vector::ZERO);
        assert_eq!((frame.element_scale, frame.spacing_scale), (1.0, 2.0));
    }
}
