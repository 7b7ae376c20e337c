//! The plane of a texture among the axes of its file.

use arabesque_core::{PointSet, Vector};

use crate::params::Plane;

/// How the axes of a file and those of the plane of the texture go together: the plane of all that follows is x, y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes(usize);

impl Axes {
    /// The axes for a texture across `axis`: 0, 1 or 2.
    pub fn across(axis: usize) -> Self {
        Self(axis.min(2))
    }

    /// The axes of a texture of these points: across the axis along which they spread least, where none is named.
    pub fn of(points: &PointSet<3>, plane: Plane) -> Self {
        let size = points.bounds().size();
        Self(match plane {
            Plane::Auto => [2, 1, 0].into_iter().fold(2, |best, k| if size[k] < 0.999 * size[best] { k } else { best }),
            Plane::X => 0,
            Plane::Y => 1,
            Plane::Z => 2,
        })
    }

    /// From the file to the plane.
    pub fn lie(self, v: Vector<3>) -> Vector<3> {
        let k = self.0;
        Vector([v[(k + 1) % 3], v[(k + 2) % 3], v[k]])
    }

    /// From the plane to the file.
    pub fn stand(self, v: Vector<3>) -> Vector<3> {
        let mut out = Vector::ZERO;
        (out[(self.0 + 1) % 3], out[(self.0 + 2) % 3], out[self.0]) = (v[0], v[1], v[2]);
        out
    }

    /// The axis across the plane.
    pub fn across_axis(self) -> usize {
        self.0
    }
}
