//! One triangle: its nearest point, the angle it fills, and whether two of them cross.

use arabesque_core::Vector;

type Corners = [Vector<3>; 3];

/// Barycentric coordinates of the point of the triangle that is nearest to `p`: each at least 0, 1 together. By the regions of its corners
/// and edges [Ericson 2005 §5.1.5]; a triangle without area is taken as its longest edge.
pub(crate) fn nearest(corners: &Corners, p: Vector<3>) -> [f64; 3] {
    let [a, b, c] = *corners;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    if ab.cross(ac).norm2() <= 1e-24 * ab.norm2().max(ac.norm2()).powi(2) {
        return nearest_of_line(corners, p);
    }
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let whole = va + vb + vc;
    [va / whole, vb / whole, vc / whole]
}

/// The nearest point of a triangle without area: that of its longest edge, on which all of it lies.
fn nearest_of_line(corners: &Corners, p: Vector<3>) -> [f64; 3] {
    let length2 = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm2();
    let k = (1..3).fold(0, |best, k| if length2(k) > length2(best) { k } else { best });
    let edge = corners[(k + 1) % 3] - corners[k];
    let t = ((p - corners[k]).dot(edge) / length2(k).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let mut weights = [0.0; 3];
    weights[k] = 1.0 - t;
    weights[(k + 1) % 3] = t;
    weights
}

/// The point with these barycentric coordinates.
pub(crate) fn at(corners: &Corners, weights: [f64; 3]) -> Vector<3> {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// Interior angle at corner `k`, in radians; 0 where an edge has no length.
pub(crate) fn angle(corners: &Corners, k: usize) -> f64 {
    let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
    u.cross(v).norm().atan2(u.dot(v)).abs()
}

/// Signed solid angle of the triangle seen from `p`, positive from within [Oosterom 1983].
pub(crate) fn solid_angle(corners: &Corners, p: Vector<3>) -> f64 {
    let [a, b, c] = corners.map(|v| v - p);
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let numerator = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * numerator.atan2(denominator)
}

/// Whether two triangles cross, told by edges of one that pass through the other. Triangles in one plane do not count.
pub(crate) fn cross(a: &Corners, b: &Corners) -> bool {
    (0..3).any(|k| pierces(a[k], a[(k + 1) % 3], b) || pierces(b[k], b[(k + 1) % 3], a))
}

/// Whether the segment from `p` to `q` passes through the inside of the triangle.
fn pierces(p: Vector<3>, q: Vector<3>, corners: &Corners) -> bool {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let (from, to) = (normal.dot(p - a), normal.dot(q - a));
    // What touches within rounding does not cross.
    let least = 1e-9 * normal.norm() * (normal.norm().sqrt() + (q - p).norm());
    if from.abs() <= least || to.abs() <= least || (from > 0.0) == (to > 0.0) {
        return false;
    }
    let d = q - p;
    let side = |u: Vector<3>, v: Vector<3>| d.dot((u - p).cross(v - p));
    let sides = [side(a, b), side(b, c), side(c, a)];
    let small = 1e-9 * d.norm() * normal.norm();
    sides.iter().all(|&s| s > small) || sides.iter().all(|&s| s < -small)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn corners(v: [f64; 9]) -> Corners {
        std::array::from_fn(|k| Vector([v[3 * k], v[3 * k + 1], v[3 * k + 2]]))
    }

    proptest! {
        #[test]
        fn no_point_of_the_triangle_is_nearer(v in prop::array::uniform9(-1.0..1.0), q in prop::array::uniform3(-2.0..2.0), flat: bool) {
            let mut triangle = corners(v);
            if flat {
                triangle[2] = triangle[0] + (triangle[1] - triangle[0]) * v[8];
            }
            let p = Vector(q);
            let weights = nearest(&triangle, p);
            prop_assert!(weights.iter().all(|w| *w >= -1e-9) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let d = (at(&triangle, weights) - p).norm();
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let other = [f64::from(i) / 20.0, f64::from(j) / 20.0, f64::from(20 - i - j) / 20.0];
                    prop_assert!((at(&triangle, other) - p).norm() >= d - 1e-9);
                }
            }
        }

        #[test]
        fn the_faces_of_a_tetrahedron_fill_a_sphere_from_within_and_nothing_from_outside(v in prop::array::uniform3(0.02..0.3)) {
            let c = [Vector([0.0; 3]), Vector([1.0, 0.0, 0.0]), Vector([0.0, 1.0, 0.0]), Vector([0.0, 0.0, 1.0])];
            let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(|k: usize| c[k]));
            let whole = |p| faces.iter().map(|f| solid_angle(f, p)).sum::<f64>();
            prop_assert!((whole(Vector(v)) - 4.0 * std::f64::consts::PI).abs() < 1e-9);
            prop_assert!(whole(Vector(v) + Vector([1.0, 1.0, 0.0])).abs() < 1e-9);
        }
    }

    #[test]
    fn triangles_that_cross_do_and_those_that_touch_do_not() {
        let floor = corners([0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
        let wall = |z: f64| corners([0.5, 0.5, z, 0.6, 0.5, z + 1.0, 0.5, 0.7, z + 1.0]);
        assert!(cross(&floor, &wall(-0.5)));
        assert!(!cross(&floor, &wall(0.0)) && !cross(&floor, &wall(0.5)));
        assert!(!cross(&floor, &floor));
    }
}
