//! Directions at the corners of triangles: smooth over gentle bends, sharp at edges.

use arabesque_core::{Budget, Result, TriangleMesh, Vector};

/// Work of one triangle, and of one look from a corner at a triangle beside it.
const PER_TRIANGLE: u64 = 80;
const PER_LOOK: u64 = 10;
/// Triangles whose directions have at least this cosine belong to one smooth surface: up to 40 degrees.
const SMOOTH: f64 = 0.766;
/// Triangles at one vertex up to which each is compared with each.
const FEW: usize = 40;

/// The direction at each corner of each triangle.
pub(super) fn corner_normals(mesh: &TriangleMesh, budget: &Budget) -> Result<Vec<[Vector<3>; 3]>> {
    let count = mesh.triangles.len();
    budget.spend(PER_TRIANGLE.saturating_mul(count as u64))?;
    if let Some(normals) = mesh.normals.as_ref().filter(|n| n.len() == mesh.positions.len()) {
        return Ok(mesh.triangles.iter().map(|t| t.map(|v| normals[v as usize])).collect());
    }
    let areas: Vec<Vector<3>> = (0..count).map(|t| mesh.double_area(t)).collect();
    let units: Vec<Vector<3>> = areas.iter().map(|a| a.unit_or_zero()).collect();
    let at = triangles_at(mesh);
    let mut meter = budget.meter();
    let mut found = Vec::with_capacity(count);
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let mut normals = [units[t]; 3];
        for (normal, &vertex) in normals.iter_mut().zip(corners) {
            let around = &at.items[at.starts[vertex as usize] as usize..at.starts[vertex as usize + 1] as usize];
            let looked = if around.len() <= FEW { around } else { &[t as u32][..] };
            meter.spend(PER_LOOK * looked.len() as u64)?;
            let alike = looked.iter().filter(|&&o| units[o as usize].dot(units[t]) > SMOOTH);
            let sum = alike.fold(Vector::ZERO, |sum, &o| sum + areas[o as usize]);
            *normal = sum.unit_if_longer(0.0).unwrap_or(units[t]);
        }
        found.push(normals);
    }
    Ok(found)
}

/// The triangles at each vertex: those of vertex `v` are `items[starts[v]..starts[v + 1]]`.
struct Around {
    starts: Vec<u32>,
    items: Vec<u32>,
}

fn triangles_at(mesh: &TriangleMesh) -> Around {
    let mut starts = vec![0_u32; mesh.positions.len() + 2];
    for &v in mesh.triangles.iter().flatten() {
        starts[v as usize + 2] += 1;
    }
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut items = vec![0; 3 * mesh.triangles.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        for &v in corners {
            // What was the start of the vertex after it grows to be its end.
            let next = &mut starts[v as usize + 1];
            items[*next as usize] = t as u32;
            *next += 1;
        }
    }
    Around { starts, items }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that share an edge along y, bent by an angle.
    fn bent(degrees: f64) -> TriangleMesh {
        let (sin, cos) = degrees.to_radians().sin_cos();
        TriangleMesh {
            positions: vec![
                Vector([0.0; 3]),
                Vector([0.0, 1.0, 0.0]),
                Vector([-1.0, 0.0, 0.0]),
                Vector([cos, 0.0, -sin]),
            ],
            triangles: vec![[0, 1, 2], [1, 0, 3]],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn gentle_bends_are_smooth_and_edges_sharp() {
        let normals = |degrees| corner_normals(&bent(degrees), &Budget::default()).unwrap();
        let smooth = normals(30.0);
        assert!((smooth[0][0] - smooth[1][1]).norm() < 1e-12);
        assert!((smooth[0][0][0] - (15.0_f64).to_radians().sin()).abs() < 1e-12);
        assert!((smooth[0][2] - Vector([0.0, 0.0, 1.0])).norm() < 1e-12);
        let sharp = normals(60.0);
        assert!((sharp[0][0] - Vector([0.0, 0.0, 1.0])).norm() < 1e-12);
    }

    #[test]
    fn normals_that_are_given_count() {
        let given = Vector([0.0, 0.6, 0.8]);
        let mesh = TriangleMesh { normals: Some(vec![given; 4]), ..bent(30.0) };
        assert_eq!(corner_normals(&mesh, &Budget::default()).unwrap()[1], [given; 3]);
    }

    #[test]
    fn many_triangles_at_one_vertex_take_little() {
        let rim = 20_000_u32;
        let positions = (0..=rim).map(|k| Vector([f64::from(k), f64::from(k * k), 0.0])).collect();
        let triangles = (1..rim).map(|k| [0, k, k + 1]).collect();
        let budget = Budget::default();
        corner_normals(&TriangleMesh { positions, triangles, ..TriangleMesh::default() }, &budget).unwrap();
        assert!(budget.work() < 5_000_000, "{}", budget.work());
    }
}
