//! Named solids, and what stands for them.

use super::*;

/// A surface of rings around the y axis: radius and height of each, closed at both ends.
fn turned(rings: &[(f64, f64)], sides: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for &(r, y) in rings {
        for k in 0..sides {
            let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
            mesh.positions.push(Vector([r * c, y, r * s]));
        }
    }
    for ring in 1..rings.len() as u32 {
        for k in 0..sides {
            let (a, b) = ((ring - 1) * sides + k, (ring - 1) * sides + (k + 1) % sides);
            mesh.triangles.extend([[a, a + sides, b], [b, a + sides, b + sides]]);
        }
    }
    let top = (rings.len() as u32 - 1) * sides;
    for k in 1..sides - 1 {
        mesh.triangles.extend([[0, k, k + 1], [top, top + k + 1, top + k]]);
    }
    mesh
}

fn sphere() -> TriangleMesh {
    let angle = |k: u32| std::f64::consts::PI * (f64::from(k) / 16.0 - 0.5);
    let rings: Vec<_> = (0..=16).map(|k| (angle(k).cos().max(1e-4), angle(k).sin())).collect();
    turned(&rings, 24)
}

#[test]
fn a_sphere_is_a_ball_of_its_volume() {
    let shape = Shape::new(&sphere(), "plum", &Budget::default()).unwrap();
    assert_eq!(shape.collider(), Collider::Ball);
    assert!((0.95..1.0).contains(&shape.inradius()), "{}", shape.inradius());
    assert!((3.9..4.19).contains(&shape.volume()), "{}", shape.volume());
    assert!(shape.centre().norm() < 1e-3);
}

#[test]
fn a_cone_is_its_hull_and_has_few_corners() {
    let shape = Shape::new(&turned(&[(1.0, 0.0), (0.2, 5.0)], 200), "carrot", &Budget::default()).unwrap();
    assert_eq!(shape.collider(), Collider::Hull);
    assert!(shape.centre()[1] < 2.0, "{:?}", shape.centre());
}

#[test]
fn a_dumbbell_is_cut_into_hulls() {
    let dumbbell = turned(&[(1.0, 0.0), (1.0, 1.0), (0.2, 1.1), (0.2, 2.9), (1.0, 3.0), (1.0, 4.0)], 16);
    let shape = Shape::new(&dumbbell, "dumbbell", &Budget::default()).unwrap();
    assert!(matches!(shape.collider(), Collider::Hulls(2..)), "{:?}", shape.collider());
    assert!(shape.scaled(0.5).is_some());
}

#[test]
fn where_a_mesh_lies_and_how_large_it_is_does_not_matter() {
    let near = Shape::new(&sphere(), "plum", &Budget::default()).unwrap();
    let mut mesh = sphere();
    for p in &mut mesh.positions {
        *p = *p * 1e-3 + Vector([500.0, -200.0, 7.0]);
    }
    let far = Shape::new(&mesh, "plum", &Budget::default()).unwrap();
    assert_eq!(far.collider(), near.collider());
    assert!((far.size() / near.size() - 1e-3).abs() < 1e-6);
}

#[test]
fn a_mesh_with_hollows_is_taken_for_its_hull_where_no_work_is_left_and_that_is_told() {
    let dumbbell = turned(&[(1.0, 0.0), (1.0, 1.0), (0.2, 1.1), (0.2, 2.9), (1.0, 3.0), (1.0, 4.0)], 16);
    let budget = Budget::new(arabesque_core::Limits { work: 10, ..Default::default() });
    let shape = Shape::new(&dumbbell, "dumbbell", &budget).unwrap();
    assert_eq!(shape.collider(), Collider::Hull);
    assert!(shape.warning().unwrap().message.contains("dumbbell: physics takes the mesh for its convex hull"));
    assert!(Shape::new(&sphere(), "plum", &budget).unwrap().warning().is_none());
}

/// Boxes as one mesh: the middle and the sides of each.
fn boxes(all: &[([f64; 3], [f64; 3])]) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    for (middle, sides) in all {
        let first = mesh.positions.len() as u32;
        let corner = |k: u32| {
            let at = |a: usize| middle[a] + sides[a] * if k >> a & 1 == 1 { 0.5 } else { -0.5 };
            Vector([at(0), at(1), at(2)])
        };
        mesh.positions.extend((0..8).map(corner));
        let split = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]].map(|t| t.map(|k| first + k));
        mesh.triangles.extend(faces.into_iter().flat_map(split));
    }
    mesh
}

#[test]
fn a_table_is_its_board_and_its_legs_exactly() {
    let leg = |x: f64, z: f64| ([x, 0.5, z], [0.1, 1.0, 0.1]);
    let board = ([0.0, 1.05, 0.0], [4.0, 0.1, 1.2]);
    let table = boxes(&[board, leg(-1.9, -0.5), leg(-1.9, 0.5), leg(1.9, -0.5), leg(1.9, 0.5)]);
    let shape = Shape::new(&table, "table", &Budget::default()).unwrap();
    assert_eq!(shape.collider(), Collider::Hulls(5));
    // What is hollow stays so: it has the volume of its parts, and reaches just as far.
    assert!((shape.volume() - (0.48 + 0.04)).abs() < 1e-3, "{}", shape.volume());
    let around = shape.scaled(1.0).unwrap().compute_aabb(&Pose::IDENTITY);
    let height = f64::from(around.maxs.y - around.mins.y);
    assert!((height - 1.1).abs() < 1e-3, "{height}");
    assert!((shape.inradius() - 0.05).abs() < 1e-3);
}

#[test]
fn faces_with_corners_of_their_own_hang_together() {
    let welded = boxes(&[([0.0; 3], [1.0; 3]), ([0.0, 2.0, 0.0], [1.0; 3])]);
    let points: Vec<_> = welded.triangles.iter().flatten().map(|&k| vec3(welded.positions[k as usize])).collect();
    let triangles: Vec<_> = (0..welded.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let found = pieces(&points, &triangles);
    assert_eq!(found.iter().map(|p| (p.points.len(), p.triangles.len())).collect::<Vec<_>>(), [(8, 12), (8, 12)]);
}
