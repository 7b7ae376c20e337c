//! The plane of a texture among the axes of its file.

use arabesque_core::{Matrix, PointSet, Vector};
use arabesque_surface::thinnest_direction;

use crate::params::Plane;

/// A texture leans where it is at most so high across its own plane, as a share of its height across the axis.
const LEANS: f64 = 0.7;
/// Heights are told without so large a share of the points on both sides, which may lie anywhere.
const STRAY: f64 = 0.02;
/// Points that are enough to tell how a texture leans.
const ENOUGH: usize = 50_000;

/// How the axes of a file and those of the plane of the texture go together: the plane of all that follows is x, y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    across: usize,
    /// Turns the texture into its plane, where its own plane leans.
    turn: Option<Matrix<3>>,
}

impl Axes {
    /// The axes for a texture across `axis`: 0, 1 or 2.
    pub fn across(axis: usize) -> Self {
        Self { across: axis.min(2), turn: None }
    }

    /// The axes of a texture of these points: across the axis along which they spread least, where none is named.
    pub fn of(points: &PointSet<3>, plane: Plane) -> Self {
        let size = points.bounds().size();
        Self::across(match plane {
            Plane::Auto => [2, 1, 0].into_iter().fold(2, |best, k| if size[k] < 0.999 * size[best] { k } else { best }),
            Plane::X => 0,
            Plane::Y => 1,
            Plane::Z => 2,
        })
    }

    /// The same, with the turn that lays a texture flat which leans, as scans do: whose plane of best fit makes it much lower than the axis does.
    pub(crate) fn levelled(self, points: &[Vector<3>]) -> Self {
        let step = points.len().div_ceil(ENOUGH).max(1);
        let lying: Vec<Vector<3>> = points.iter().step_by(step).map(|&p| self.lie(p)).collect();
        let normal = thinnest_direction(&lying);
        let normal = if normal[2] < 0.0 { -normal } else { normal };
        let up = Vector([0.0, 0.0, 1.0]);
        let height = |way: Vector<3>| {
            let mut heights: Vec<f64> = lying.iter().map(|p| p.dot(way)).collect();
            heights.sort_by(f64::total_cmp);
            let stray = (STRAY * heights.len() as f64) as usize;
            heights[heights.len() - 1 - stray] - heights[stray]
        };
        // Half way round there is no shortest turn.
        if lying.is_empty() || normal[2] < 1e-3 || height(normal) >= LEANS * height(up) {
            return self;
        }
        Self { turn: Some(shortest_turn(normal, up)), ..self }
    }

    /// From the axes of the file to the plane.
    pub fn lie(self, v: Vector<3>) -> Vector<3> {
        let k = self.across;
        Vector([v[(k + 1) % 3], v[(k + 2) % 3], v[k]])
    }

    /// From the plane to the axes of the file.
    pub fn stand(self, v: Vector<3>) -> Vector<3> {
        let (mut out, k) = (Vector::ZERO, self.across);
        (out[(k + 1) % 3], out[(k + 2) % 3], out[k]) = (v[0], v[1], v[2]);
        out
    }

    /// From where the texture lies in its file to its plane.
    pub(crate) fn level(self, v: Vector<3>) -> Vector<3> {
        let lying = self.lie(v);
        self.turn.map_or(lying, |turn| turn.apply(lying))
    }

    /// From its plane back to where the texture lies in its file.
    pub(crate) fn back(self, v: Vector<3>) -> Vector<3> {
        self.stand(self.turn.map_or(v, |turn| turn.transpose().apply(v)))
    }

    /// The axis across the plane, or nearest to that.
    pub fn across_axis(self) -> usize {
        self.across
    }

    /// How far the texture leans from its axis, in degrees.
    pub fn lean(self) -> f64 {
        self.turn.map_or(0.0, |turn| turn.apply(Vector([0.0, 0.0, 1.0]))[2].clamp(-1.0, 1.0).acos().to_degrees())
    }
}

/// The rotation that takes one direction to another by the shortest way; they must not be opposite.
fn shortest_turn(from: Vector<3>, to: Vector<3>) -> Matrix<3> {
    let (axis, cos) = (from.cross(to), from.dot(to));
    let k = 1.0 / (1.0 + cos);
    let [x, y, z] = axis.0;
    Matrix([
        [cos + k * x * x, k * x * y - z, k * x * z + y],
        [k * x * y + z, cos + k * y * y, k * y * z - x],
        [k * x * z - y, k * y * z + x, cos + k * z * z],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of humps, lower than they are apart.
    fn humps() -> Vec<Vector<3>> {
        let at = |k: usize| {
            let (x, y) = ((k % 60) as f64 / 15.0, (k / 60) as f64 / 15.0);
            Vector([x, y, 0.2 * (3.0 * x).sin() * (4.0 * y).cos()])
        };
        (0..3600).map(at).collect()
    }

    /// Turned about x.
    fn leaning(points: &[Vector<3>], degrees: f64) -> Vec<Vector<3>> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        points.iter().map(|p| Vector([p[0], cos * p[1] - sin * p[2], sin * p[1] + cos * p[2]])).collect()
    }

    #[test]
    fn what_leans_is_laid_flat_and_comes_back_to_where_it_was() {
        for degrees in [8.0, -25.0, 40.0] {
            let leaning = leaning(&humps(), degrees);
            let axes = Axes::across(2).levelled(&leaning);
            assert!((axes.lean() - f64::abs(degrees)).abs() < 0.5, "{degrees}: {}", axes.lean());
            for (p, q) in leaning.iter().zip(humps()) {
                let level = axes.level(*p);
                assert!((level - q).norm() < 0.05, "{level:?} {q:?}");
                assert!((axes.back(level) - *p).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn what_lies_and_what_rises_step_by_step_is_left_as_it_is() {
        let steps: Vec<_> = humps().iter().map(|p| Vector([p[0], p[1], 0.6 * (0.6 * p[1]).fract()])).collect();
        let flat = humps().iter().map(|p| Vector([p[0], p[1], 0.0])).collect();
        for points in [humps(), leaning(&humps(), 0.5), steps, flat] {
            let axes = Axes::across(2).levelled(&points);
            assert_eq!((axes, axes.lean()), (Axes::across(2), 0.0));
        }
    }
}
