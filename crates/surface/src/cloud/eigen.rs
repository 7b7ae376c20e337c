//! Eigenvectors of symmetric 3 by 3 matrices, by rotations of Jacobi.

use arabesque_core::Vector;

/// Eigenvalues, the smallest first, with their directions of length 1, of the symmetric matrix with these entries: xx, xy, xz, yy, yz, zz.
pub(crate) fn eigen(entries: [f64; 6]) -> [(f64, Vector<3>); 3] {
    let [xx, xy, xz, yy, yz, zz] = entries;
    let mut m = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Each sweep squares what is left beside the diagonal.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut m, &mut v, p, q);
        }
    }
    let mut pairs = [0, 1, 2].map(|k| (m[k][k], Vector([v[0][k], v[1][k], v[2][k]])));
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

/// Makes one entry beside the diagonal zero.
fn rotate(m: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if m[p][q].abs() <= f64::MIN_POSITIVE {
        return;
    }
    let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let cos = 1.0 / t.hypot(1.0);
    let sin = t * cos;
    for row in m.iter_mut() {
        (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
    }
    for k in 0..3 {
        (m[p][k], m[q][k]) = (cos * m[p][k] - sin * m[q][k], sin * m[p][k] + cos * m[q][k]);
        (v[k][p], v[k][q]) = (cos * v[k][p] - sin * v[k][q], sin * v[k][p] + cos * v[k][q]);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn directions_are_kept_by_the_matrix(e in prop::array::uniform6(-3.0..3.0)) {
            let [xx, xy, xz, yy, yz, zz] = e;
            let pairs = eigen(e);
            for (value, u) in pairs {
                let image = Vector([xx * u[0] + xy * u[1] + xz * u[2], xy * u[0] + yy * u[1] + yz * u[2], xz * u[0] + yz * u[1] + zz * u[2]]);
                prop_assert!((image - u * value).norm() < 1e-9 && (u.norm() - 1.0).abs() < 1e-9);
            }
            prop_assert!(pairs[0].0 <= pairs[1].0 && pairs[1].0 <= pairs[2].0);
        }
    }

    #[test]
    fn a_matrix_that_is_diagonal_is_done() {
        assert_eq!(eigen([3.0, 0.0, 0.0, 1.0, 0.0, 2.0]).map(|e| e.0), [1.0, 2.0, 3.0]);
        assert_eq!(eigen([0.0; 6]).map(|e| e.0), [0.0; 3]);
    }
}
