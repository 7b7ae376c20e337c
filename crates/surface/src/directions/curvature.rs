//! Principal curvatures at the vertices: a second fundamental form is fitted to the normals of each triangle, and each vertex gets the mean of
//! those around it [Rusinkiewicz 2004].

use arabesque_core::{Budget, Result, Vector};

use super::transport::{axes, carried};
use crate::mesh::MeshIndex;

/// How a surface bends at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// The two principal curvatures, one over the radius and positive where the surface is convex, the larger first.
    pub values: [f64; 2],
    /// Their directions, of length 1, across one another and along the surface.
    pub directions: [Vector<3>; 2],
}

/// How the surface bends at each vertex of the index, whose vertices at equal places are one.
///
/// # Errors
/// As [`Budget::spend`].
pub fn curvatures(index: &MeshIndex, budget: &Budget) -> Result<Vec<Curvature>> {
    let topology = &index.topology;
    budget.spend(topology.triangles.len() as u64 * 300)?;
    let planes: Vec<_> = index.normals.iter().map(|&n| axes(n)).collect();
    let mut sums = vec![([0.0; 3], 0.0); topology.points.len()];
    for (t, corners) in topology.triangles.iter().enumerate() {
        let double_area = topology.double_area(t as u32);
        let Some(normal) = double_area.unit_if_longer(0.0) else { continue };
        let plane = axes(normal);
        let Some(form) = fitted(topology.corners(t as u32), corners.map(|v| index.normals[v as usize]), plane) else {
            continue;
        };
        for &v in corners {
            let v = v as usize;
            let [x, y] = plane.map(|axis| carried(axis, normal, index.normals[v]));
            let own = in_axes(form, [x, y], planes[v]);
            let weight = double_area.norm();
            (0..3).for_each(|k| sums[v].0[k] += own[k] * weight);
            sums[v].1 += weight;
        }
    }
    let principal = |((sum, weight), plane): (([f64; 3], f64), &[Vector<3>; 2])| {
        let [a, b, c] = sum.map(|s| if weight > 0.0 { s / weight } else { 0.0 });
        let (mean, half, cross) = (0.5 * (a + c), 0.5 * (a - c), b);
        let spread = half.hypot(cross);
        let (sin, cos) = (0.5 * cross.atan2(half)).sin_cos();
        let first = plane[0] * cos + plane[1] * sin;
        let second = plane[1] * cos - plane[0] * sin;
        Curvature { values: [mean + spread, mean - spread], directions: [first, second] }
    };
    Ok(sums.into_iter().zip(&planes).map(principal).collect())
}

/// The form `[a, b, c]`, for the matrix with rows `a b` and `b c`, that turns the edges of a triangle best into the differences of its normals, both in the axes
/// of its plane.
fn fitted(corners: [Vector<3>; 3], normals: [Vector<3>; 3], plane: [Vector<3>; 2]) -> Option<[f64; 3]> {
    // Normal equations of 6 equations: a x + b y = s and b x + c y = t for each edge (x, y) with difference (s, t).
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut right = [0.0; 3];
    for k in 0..3 {
        let (edge, turn) = (corners[(k + 1) % 3] - corners[k], normals[(k + 1) % 3] - normals[k]);
        let [x, y] = plane.map(|axis| axis.dot(edge));
        let [s, t] = plane.map(|axis| axis.dot(turn));
        xx += x * x;
        xy += x * y;
        yy += y * y;
        right = [right[0] + x * s, right[1] + y * s + x * t, right[2] + y * t];
    }
    // Cramer's rule on the symmetric matrix [xx xy 0; xy xx+yy xy; 0 xy yy].
    let sum = xx + yy;
    let whole = xx * (sum * yy - xy * xy) - xy * xy * yy;
    if whole <= 1e-12 * sum.powi(3) {
        return None;
    }
    let [p, q, r] = right;
    let a = p * (sum * yy - xy * xy) - xy * (q * yy - xy * r);
    let b = xx * (q * yy - xy * r) - p * xy * yy;
    let c = xx * (sum * r - q * xy) - xy * xy * r + p * xy * xy;
    Some([a / whole, b / whole, c / whole])
}

/// A form given in the axes `from`, in other axes of the same plane.
fn in_axes([a, b, c]: [f64; 3], from: [Vector<3>; 2], to: [Vector<3>; 2]) -> [f64; 3] {
    let at = |u: Vector<3>, v: Vector<3>| {
        let ([ux, uy], [vx, vy]) = (from.map(|axis| axis.dot(u)), from.map(|axis| axis.dot(v)));
        a * ux * vx + b * (ux * vy + uy * vx) + c * uy * vy
    };
    [at(to[0], to[0]), at(to[0], to[1]), at(to[1], to[1])]
}
