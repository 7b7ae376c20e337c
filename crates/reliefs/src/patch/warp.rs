//! A spline told at the nodes of a grid, where a patch has many more points than the grid has nodes.
//!
//! In between, shifts are mixed by quadratic B-splines: affine maps are kept exactly, and the Jacobian matrix is continuous.

use arabesque_core::{Bounds, Budget, Result, Vector};
use rayon::prelude::*;

use crate::patch::spline::Spline;

/// Nodes along the side of a patch, and along as much of its height.
const NODES: [f64; 3] = [12.0, 12.0, 8.0];
/// A grid pays where there are so many times as many points as nodes.
const PAYS: usize = 2;

/// How a patch is bent.
pub(super) struct Warp<'a> {
    spline: &'a Spline,
    nodes: Option<Nodes>,
}

/// Shifts at the nodes of a grid.
struct Nodes {
    origin: Vector<3>,
    step: Vector<3>,
    counts: [usize; 3],
    shifts: Vec<Vector<3>>,
}

impl<'a> Warp<'a> {
    /// The warp of a spline for these points of a patch of `side`.
    pub(super) fn new(spline: &'a Spline, points: &[Vector<3>], side: f64, budget: &Budget) -> Result<Self> {
        budget.spend(points.len() as u64 * 10)?;
        let exact = Self { spline, nodes: None };
        if points.is_empty() {
            return Ok(exact);
        }
        let bounds = Bounds::around(points.iter().copied());
        let step = Vector(NODES.map(|n| side / n));
        let origin = bounds.min - step;
        let counts: [usize; 3] =
            std::array::from_fn(|k| ((bounds.size()[k] / step[k]).round() as usize).saturating_add(3));
        if counts.iter().try_fold(1_usize, |all, n| all.checked_mul(*n)).is_none_or(|all| all / 2 > points.len()) {
            budget.spend(spline.work() * points.len() as u64)?;
            return Ok(exact);
        }
        let mut nodes = Nodes { origin, step, counts, shifts: Vec::new() };
        // Columns beside no point are not asked.
        let mut is_asked = vec![false; counts[0] * counts[1]];
        for p in points {
            let [(x, _), (y, _), _] = nodes.under(*p);
            (y - 1..=y + 1).for_each(|y| is_asked[y * counts[0] + x - 1..][..3].fill(true));
        }
        let asked = is_asked.iter().filter(|asked| **asked).count() * counts[2];
        if asked * PAYS > points.len() {
            budget.spend(spline.work() * points.len() as u64)?;
            return Ok(exact);
        }
        budget.spend(spline.work() * asked as u64 + points.len() as u64 * 150)?;
        let column = |k: usize| -> Vec<Vector<3>> {
            let of = |z: usize| {
                let at = [k % counts[0], k / counts[0], z];
                let p = origin + Vector(std::array::from_fn(|k| at[k] as f64 * step[k]));
                spline.apply(p).0 - p
            };
            if is_asked[k] { (0..counts[2]).map(of).collect() } else { vec![Vector::ZERO; counts[2]] }
        };
        nodes.shifts = (0..counts[0] * counts[1]).into_par_iter().with_min_len(32).flat_map_iter(column).collect();
        Ok(Self { spline, nodes: Some(nodes) })
    }

    /// The image of `x`, and the columns of the Jacobian matrix. Of a grid, `x` is one of the points that it was made for.
    pub(super) fn apply(&self, x: Vector<3>) -> (Vector<3>, [Vector<3>; 3]) {
        self.nodes.as_ref().map_or_else(|| self.spline.apply(x), |nodes| nodes.apply(x))
    }
}

impl Nodes {
    /// For each axis the nearest node that has one on both sides, and how far from it a place is, in steps.
    fn under(&self, p: Vector<3>) -> [(usize, f64); 3] {
        std::array::from_fn(|k| {
            let t = (p[k] - self.origin[k]) / self.step[k];
            let node = ((t + 0.5) as usize).clamp(1, self.counts[k] - 2);
            (node, (t - node as f64).clamp(-0.5, 0.5))
        })
    }

    fn apply(&self, x: Vector<3>) -> (Vector<3>, [Vector<3>; 3]) {
        let under = self.under(x);
        let weights = under.map(|(_, u)| [0.5 * (0.5 - u) * (0.5 - u), 0.75 - u * u, 0.5 * (0.5 + u) * (0.5 + u)]);
        let slopes = under.map(|(_, u)| [u - 0.5, -2.0 * u, 0.5 + u]);
        let [(i, _), (j, _), (k, _)] = under;
        let mut image = x;
        let mut columns = [Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0]), Vector([0.0, 0.0, 1.0])];
        let per = [0, 1, 2].map(|axis| 1.0 / self.step[axis]);
        for b in 0..3 {
            for a in 0..3 {
                let start = ((j + b - 1) * self.counts[0] + i + a - 1) * self.counts[2] + k - 1;
                let (mut shift, mut rise) = (Vector::ZERO, Vector::ZERO);
                for (c, s) in self.shifts[start..start + 3].iter().enumerate() {
                    shift += *s * weights[2][c];
                    rise += *s * slopes[2][c];
                }
                image += shift * (weights[0][a] * weights[1][b]);
                columns[0] += shift * (slopes[0][a] * weights[1][b] * per[0]);
                columns[1] += shift * (weights[0][a] * slopes[1][b] * per[1]);
                columns[2] += rise * (weights[0][a] * weights[1][b] * per[2]);
            }
        }
        (image, columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<Vector<3>> {
        let at = |k: usize| [k % 60, k / 60 % 60, k / 3600].map(|v| v as f64 / 60.0);
        (0..36_000).map(|k| Vector(at(k))).collect()
    }

    fn warp_of(map: impl Fn(Vector<3>) -> Vector<3>, stiffness: f64) -> Spline {
        let some: Vec<_> = (0..60)
            .map(|k| Vector([(k * 7 % 31) as f64 / 31.0, (k * 11 % 29) as f64 / 29.0, (k % 5) as f64 / 20.0]))
            .collect();
        let pairs: Vec<_> = some.iter().map(|&p| (p, map(p))).collect();
        Spline::new(&pairs, stiffness, &Budget::default()).unwrap().unwrap()
    }

    #[test]
    fn affine_maps_are_kept_exactly_by_the_grid_too() {
        let map = |p: Vector<3>| Vector([0.1 + 1.1 * p[0] - 0.2 * p[1], p[1] + 0.3 * p[2], 0.9 * p[2] - 0.1 * p[0]]);
        let (spline, points) = (warp_of(map, 0.0), points());
        let warp = Warp::new(&spline, &points, 1.0, &Budget::default()).unwrap();
        assert!(warp.nodes.is_some());
        for &p in points.iter().step_by(97) {
            let (image, columns) = warp.apply(p);
            assert!((image - map(p)).norm() < 1e-9, "{p:?}");
            assert!(
                (columns[0] - Vector([1.1, 0.0, -0.1])).norm() < 1e-9
                    && (columns[2] - Vector([0.0, 0.3, 0.9])).norm() < 1e-9
            );
        }
    }

    #[test]
    fn the_grid_is_close_to_the_spline_and_its_jacobian_is_its_slope() {
        let map = |p: Vector<3>| p + Vector([0.03 * (4.0 * p[1]).sin(), 0.02 * (3.0 * p[0]).cos(), 0.02 * p[0] * p[1]]);
        let (spline, points) = (warp_of(map, 1.0), points());
        let warp = Warp::new(&spline, &points, 1.0, &Budget::default()).unwrap();
        for &p in points.iter().step_by(131).filter(|p| p[2] > 0.01 && p[0] > 0.01 && p[1] > 0.01) {
            let (image, columns) = warp.apply(p);
            let (own, _) = spline.apply(p);
            assert!((image - own).norm() < 1e-3, "{p:?}: {image:?} {own:?}");
            for (k, column) in columns.iter().enumerate() {
                let mut step = Vector::ZERO;
                step[k] = 1e-6;
                assert!(((image - warp.apply(p - step).0) * 1e6 - *column).norm() < 1e-3);
            }
        }
        assert!(Warp::new(&spline, &points[..50], 1.0, &Budget::default()).unwrap().nodes.is_none());
    }
}
