//! Thin-plate splines in space: an affine map and a sum of distances from centres.

use arabesque_core::{Budget, Result, Vector};

/// A map of space that takes given points to given points and bends as little as it can in between.
#[derive(Clone, Debug)]
pub(crate) struct Spline {
    /// Pairs of centres, and how much each pulls: coordinate by coordinate, so that both are worked out at once.
    pulls: Vec<[[f64; 2]; 6]>,
    /// Images of the origin and of the axes, as rows: constant, x, y, z.
    affine: [Vector<3>; 4],
}

/// Work units for solving a spline through `n` pairs.
pub(crate) fn solving(n: usize) -> u64 {
    let n = n as u64 + 4;
    n * n * n / 3 + n * n * 10
}

impl Spline {
    /// The spline through pairs of points and their images. `stiffness` lets it miss them, the more the larger: affine maps are kept exactly whatever
    /// it is. `None` where the pairs do not determine it: fewer than four, or all in a plane and none of them beside it.
    pub(crate) fn new(pairs: &[(Vector<3>, Vector<3>)], stiffness: f64, budget: &Budget) -> Result<Option<Self>> {
        let n = pairs.len();
        budget.spend(solving(n))?;
        let size = n + 4;
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(size);
        for (i, (p, q)) in pairs.iter().enumerate() {
            let kernel = pairs.iter().enumerate().map(|(j, (c, _))| if i == j { stiffness } else { -(*p - *c).norm() });
            rows.push(kernel.chain([1.0, p[0], p[1], p[2]]).chain(q.0).collect());
        }
        for k in 0..4 {
            let side = |p: &Vector<3>| if k == 0 { 1.0 } else { p[k - 1] };
            rows.push(pairs.iter().map(|(p, _)| side(p)).chain([0.0; 7]).collect());
        }
        if !solve(&mut rows) {
            return Ok(None);
        }
        let answer = |i: usize| Vector([rows[i][size], rows[i][size + 1], rows[i][size + 2]]);
        // An odd one is paired with itself, and pulls but once.
        let two = |i: usize| {
            let (centres, weights) =
                ([pairs[i].0, pairs[(i + 1).min(n - 1)].0], [i, i + 1].map(|i| (i < n).then(|| answer(i))));
            std::array::from_fn(|k| {
                [0, 1].map(|j| if k < 3 { centres[j][k] } else { weights[j].map_or(0.0, |w| w[k - 3]) })
            })
        };
        Ok(Some(Self { pulls: (0..n).step_by(2).map(two).collect(), affine: std::array::from_fn(|k| answer(n + k)) }))
    }

    /// Work units of one application.
    pub(crate) fn work(&self) -> u64 {
        self.pulls.len() as u64 * 8 + 20
    }

    /// The image of `x`, and the images of small steps along the axes: the columns of the Jacobian matrix.
    pub(crate) fn apply(&self, x: Vector<3>) -> (Vector<3>, [Vector<3>; 3]) {
        let [start, ex, ey, ez] = self.affine;
        // Sums over the centres of weight times distance, and of weight times each coordinate of the direction.
        let mut sums = [[[0.0_f64; 2]; 3]; 4];
        for [cx, cy, cz, wx, wy, wz] in &self.pulls {
            for j in 0..2 {
                let d = [x[0] - cx[j], x[1] - cy[j], x[2] - cz[j]];
                let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                // At a centre itself the direction is none.
                let inverse = 1.0 / r2.max(1e-24).sqrt();
                let factors = [r2 * inverse, d[0] * inverse, d[1] * inverse, d[2] * inverse];
                for (sum, factor) in sums.iter_mut().zip(factors) {
                    sum[0][j] += wx[j] * factor;
                    sum[1][j] += wy[j] * factor;
                    sum[2][j] += wz[j] * factor;
                }
            }
        }
        let [far, dx, dy, dz] = sums.map(|sum| Vector(sum.map(|[a, b]| a + b)));
        let image = start + ex * x[0] + ey * x[1] + ez * x[2] - far;
        let columns = [ex - dx, ey - dy, ez - dz];
        (image, columns)
    }
}

/// The determinant of the matrix with these columns.
pub(crate) fn determinant([a, b, c]: [Vector<3>; 3]) -> f64 {
    a.dot(b.cross(c))
}

/// How a normal goes with the Jacobian matrix of a map: across the images of the tangents [Duranleau 2008 §5.2].
pub(crate) fn carried(normal: Vector<3>, columns: [Vector<3>; 3]) -> Vector<3> {
    let axis = if normal[0].abs() < 0.6 { Vector([1.0, 0.0, 0.0]) } else { Vector([0.0, 1.0, 0.0]) };
    let u = normal.cross(axis).unit_or_zero();
    let v = normal.cross(u);
    let image = |t: Vector<3>| columns[0] * t[0] + columns[1] * t[1] + columns[2] * t[2];
    image(u).cross(image(v)).unit_if_longer(1e-12).unwrap_or(normal)
}

/// Solves linear equations in place, whose right sides stand behind the square matrix; false where it is singular.
fn solve(rows: &mut [Vec<f64>]) -> bool {
    let n = rows.len();
    let scale = rows.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    for k in 0..n {
        let pivot = (k..n).fold(k, |best, i| if rows[i][k].abs() > rows[best][k].abs() { i } else { best });
        rows.swap(k, pivot);
        let (done, rest) = rows.split_at_mut(k + 1);
        let row = &mut done[k];
        if row[k].is_nan() || row[k].abs() <= 1e-13 * scale {
            return false;
        }
        let inverse = 1.0 / row[k];
        row[k..].iter_mut().for_each(|v| *v *= inverse);
        for other in rest {
            let factor = other[k];
            if factor != 0.0 {
                other[k..].iter_mut().zip(&row[k..]).for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    for k in (1..n).rev() {
        let (before, from) = rows.split_at_mut(k);
        for other in before {
            let factor = other[k];
            other[n..].iter_mut().zip(&from[0][n..]).for_each(|(a, b)| *a -= factor * b);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn points() -> impl Strategy<Value = Vec<Vector<3>>> {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0).prop_map(Vector), 8..40)
    }

    proptest! {
        #[test]
        fn affine_maps_are_kept_exactly(points in points(), m in prop::array::uniform12(-2.0_f64..2.0), stiffness in 0.0..1.0) {
            let map = |p: Vector<3>| Vector(std::array::from_fn(|r| m[r] + (0..3).map(|c| m[3 + 3 * r + c] * p[c]).sum::<f64>()));
            let pairs: Vec<_> = points.iter().map(|&p| (p, map(p))).collect();
            let Some(spline) = Spline::new(&pairs, stiffness, &Budget::default()).unwrap() else { return Ok(()) };
            let x = Vector([0.3, -1.7, 0.9]);
            let (image, columns) = spline.apply(x);
            prop_assert!((image - map(x)).norm() < 1e-6, "{image:?}");
            for (k, column) in columns.iter().enumerate() {
                prop_assert!((0..3).all(|r: usize| (column[r] - m[3 + 3 * r + k]).abs() < 1e-6));
            }
        }

        #[test]
        fn pairs_are_met_and_the_jacobian_is_the_slope(points in points(), shifts in points()) {
            let pairs: Vec<_> = points.iter().zip(&shifts).map(|(&p, &s)| (p, p + s * 0.1)).collect();
            let Some(spline) = Spline::new(&pairs, 0.0, &Budget::default()).unwrap() else { return Ok(()) };
            for (p, q) in &pairs {
                prop_assert!((spline.apply(*p).0 - *q).norm() < 1e-6);
            }
            let x = Vector([1.3, 0.2, -1.4]);
            let (image, columns) = spline.apply(x);
            for k in 0..3 {
                let mut step = Vector::ZERO;
                step[k] = 1e-6;
                prop_assert!(((spline.apply(x + step).0 - image) * 1e6 - columns[k]).norm() < 1e-3);
            }
        }
    }

    #[test]
    fn too_few_pairs_and_pairs_in_a_plane_determine_nothing() {
        let at = |k: usize| Vector([k as f64, (k * k) as f64, 0.0]);
        let pairs: Vec<_> = (0..6).map(|k| (at(k), at(k))).collect();
        assert!(Spline::new(&pairs, 0.0, &Budget::default()).unwrap().is_none());
        assert!(Spline::new(&pairs[..2], 0.0, &Budget::default()).unwrap().is_none());
    }

    #[test]
    fn normals_stay_across_their_surface() {
        let shear = [Vector([1.0, 0.0, 0.5]), Vector([0.0, 1.0, 0.0]), Vector([0.0, 0.0, 1.0])];
        let n = carried(Vector([0.0, 0.0, 1.0]), shear);
        assert!((n - Vector([-0.5, 0.0, 1.0]).unit()).norm() < 1e-12, "{n:?}");
        assert!((determinant(shear) - 1.0).abs() < 1e-12);
    }
}
