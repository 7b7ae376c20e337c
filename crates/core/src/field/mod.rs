//! Quantities that vary over the domain.

mod grid;
mod strokes;

pub use grid::Grid;
pub use strokes::FlowStroke;

use std::sync::Arc;

use crate::space::{Matrix, Vector};

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

/// Rotations that somebody works out for any place.
pub trait Rotations<const D: usize>: Send + Sync + std::fmt::Debug {
    /// The rotation at `p`: the same each time.
    fn at(&self, p: Vector<D>) -> Matrix<D>;
}

/// A rotation at every point: how the pattern is turned there.
#[derive(Clone, Debug)]
pub enum OrientationField<const D: usize> {
    /// The same everywhere.
    Constant(Matrix<D>),
    /// Blended between grid nodes and made a rotation again.
    Grid(Grid<D, Matrix<D>>),
    /// As somebody else says: along a surface, say.
    Of(Arc<dyn Rotations<D>>),
}

impl<const D: usize> OrientationField<D> {
    /// Rotation at `p`.
    pub fn at(&self, p: Vector<D>) -> Matrix<D> {
        match self {
            Self::Constant(r) => *r,
            Self::Of(rotations) => rotations.at(p),
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
        let density = self.density.at(p);
        let sparser = if density == 1.0 { 1.0 } else { density.powf(-1.0 / D as f64) };
        Frame {
            rotation: self.orientation.as_ref().map_or_else(Matrix::identity, |o| o.at(p)),
            element_scale,
            spacing_scale: element_scale * sparser,
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
    fn density_widens_gaps_but_not_elements() {
        let fields = Fields::<2> { density: ScalarField::Constant(0.25), ..Fields::default() };
        let frame = fields.frame(Vector::ZERO);
        assert_eq!((frame.element_scale, frame.spacing_scale), (1.0, 2.0));
    }
}
