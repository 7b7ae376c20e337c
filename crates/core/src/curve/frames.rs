//! Directions carried along a curve in space.

use crate::space::Vector;

/// Vectors no longer than this have no direction.
const LEAST: f64 = 1e-12;

/// For each tangent a direction across the curve, carried along without twist from `first`: of all frames these turn least.
/// A closed curve, whose first tangent comes again at the end, spreads what is left over its length.
pub fn carried(tangents: &[Vector<3>], first: Vector<3>, closed: bool) -> Vec<Vector<3>> {
    let mut side = first;
    let mut carried = Vec::with_capacity(tangents.len());
    for &tangent in tangents {
        if let Some(t) = tangent.unit_if_longer(LEAST) {
            side = (side - t * side.dot(t)).unit_if_longer(LEAST).unwrap_or(side);
        }
        carried.push(side);
    }
    let (Some(&first), Some(&last), true) = (carried.first(), carried.last(), closed) else { return carried };
    let axis = tangents[0].unit_if_longer(LEAST).unwrap_or(Vector([1.0, 0.0, 0.0]));
    let left = last.cross(first).dot(axis).atan2(last.dot(first));
    let n = carried.len() as f64 - 1.0;
    let turned = carried.iter().zip(tangents).enumerate().map(|(k, (&d, &t))| match t.unit_if_longer(LEAST) {
        Some(t) => turned_about(d, t, left * k as f64 / n),
        None => d,
    });
    let mut turned: Vec<_> = turned.collect();
    if let Some(end) = turned.last_mut() {
        *end = first;
    }
    turned
}

/// `v`, which is square to the unit vector `axis`, turned about it.
pub fn turned_about(v: Vector<3>, axis: Vector<3>, radians: f64) -> Vector<3> {
    v * radians.cos() + axis.cross(v) * radians.sin()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn around_a_plane_curve_the_normal_of_the_plane_stays() {
        let tangents: Vec<_> =
            (0..=40).map(|k| f64::from(k) / 40.0 * TAU).map(|a| Vector([-a.sin(), a.cos(), 0.0])).collect();
        let up = Vector([0.0, 0.0, 1.0]);
        assert!(carried(&tangents, up, true).iter().all(|&d| (d - up).norm() < 1e-12));
    }

    #[test]
    fn a_closed_curve_ends_as_it_began() {
        let tangent = |k: i32| {
            let a = f64::from(k) / 200.0 * TAU;
            Vector([-a.sin(), a.cos(), 0.6 * (2.0 * a).cos()])
        };
        let tangents: Vec<_> = (0..=200).map(tangent).collect();
        let sides = carried(&tangents, Vector([0.0, 0.0, 1.0]), true);
        assert_eq!(sides[0], sides[200]);
        for (pair, t) in sides.windows(2).zip(&tangents) {
            assert!(pair[0].dot(t.unit()).abs() < 1e-9 && (pair[1] - pair[0]).norm() < 0.1);
        }
    }
}
