//! How far some points are from a plane.

use arabesque_core::Vector;

use crate::cloud::eigen;

/// Surface variation of points [Pauly 2002]: the share of the smallest eigenvalue of their covariance.
pub(super) fn variation(points: &[Vector<3>]) -> f64 {
    let [least, middle, most] = eigen(covariance(points.iter().copied()).1).map(|e| e.0.max(0.0));
    let sum = least + middle + most;
    if sum > 0.0 { least / sum } else { 0.0 }
}

/// The direction along which points spread least, of length 1: across their plane, where they lie near one.
pub fn thinnest_direction(points: &[Vector<3>]) -> Vector<3> {
    eigen(covariance(points.iter().copied()).1)[0].1
}

/// Mean and covariance, as xx, xy, xz, yy, yz, zz.
pub(super) fn covariance(points: impl Iterator<Item = Vector<3>> + Clone) -> (Vector<3>, [f64; 6]) {
    let (count, sum) = points.clone().fold((0.0, Vector::ZERO), |(n, sum), p| (n + 1.0, sum + p));
    let mean = sum * (1.0 / f64::max(count, 1.0));
    let mut m = [0.0; 6];
    for d in points.map(|p| p - mean) {
        let [x, y, z] = d.0;
        m = [m[0] + x * x, m[1] + x * y, m[2] + x * z, m[3] + y * y, m[4] + y * z, m[5] + z * z];
    }
    (mean, m)
}
