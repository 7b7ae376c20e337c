//! Questions to meshes of known shape, and reports on what is wrong with them.

use arabesque_core::{Budget, Limits, Stage, Stream, TriangleMesh, Vector};

use super::shapes::{ball, cuboid, grid, together, torus, turned};
use crate::{MeshIndex, MeshReport};

fn index(mesh: &TriangleMesh) -> MeshIndex {
    MeshIndex::new(mesh, "a.obj", &Budget::default()).unwrap()
}

fn report(mesh: &TriangleMesh) -> MeshReport {
    MeshReport::new(&index(mesh), &Budget::default()).unwrap()
}

fn places(count: usize, reach: f64) -> Vec<Vector<3>> {
    let mut random = Stream::new(5, Stage::TEST, 0);
    (0..count).map(|_| Vector(std::array::from_fn(|_| random.range(-reach, reach)))).collect()
}

/// Distance to the surface of a torus around the z axis, positive inside.
fn from_torus(p: Vector<3>) -> f64 {
    0.4 - (p[0].hypot(p[1]) - 1.0).hypot(p[2])
}

#[test]
fn distances_to_a_torus_are_those_of_its_formula() {
    let index = index(&torus(160, 80, 1.0, 0.4));
    let places = places(400, 1.6);
    let distances = index.signed_distances(&places, &Budget::default()).unwrap();
    let closest = index.closest_all(&places, &Budget::default()).unwrap();
    for ((&p, d), near) in places.iter().zip(distances).zip(closest) {
        assert!((d - from_torus(p)).abs() < 2e-3, "{p:?}: {d}");
        assert_eq!((d, near), (index.signed_distance(p), index.closest(p)));
        assert!((index.height(&near, p) + d).abs() < 1e-12, "above is outside");
        let back = index.at(near.triangle, near.barycentric);
        assert!((back.point - near.point).norm() < 1e-12 && back.normal == near.normal);
        assert_eq!(index.closest_within(p, near.distance * 0.99), None);
        assert_eq!(index.closest_within(p, near.distance * 1.01), Some(near));
        let away = (p - near.point) * if d > 0.0 { -1.0 } else { 1.0 };
        assert!(near.distance < 1e-3 || away.cosine(near.normal) > 0.99, "{p:?}: {near:?}");
    }
}

#[test]
fn a_box_is_right_at_its_faces_edges_and_corners() {
    let (low, high) = (Vector([-1.0; 3]), Vector([1.0, 0.5, 2.0]));
    let bounds = arabesque_core::Bounds::new(low, high);
    let index = index(&cuboid(low, high));
    for p in places(500, 2.5) {
        assert!((index.signed_distance(p) - bounds.signed_distance(p)).abs() < 1e-9, "{p:?}");
        let near = index.closest(p);
        assert!((index.height(&near, p) + bounds.signed_distance(p)).abs() < 1e-9, "{p:?}");
    }
}

#[test]
fn small_holes_and_wrong_sides_do_not_change_what_is_inside() {
    let mut open = ball(24, Vector::ZERO, 1.0);
    open.triangles.drain(300..306);
    for mesh in [&open, &turned(&open)] {
        let index = index(mesh);
        for p in places(300, 1.2) {
            assert!(
                (p.norm() - 1.0).abs() < 0.1 || index.is_inside(p) == (p.norm() < 1.0),
                "{p:?}: {}",
                index.winding(p)
            );
        }
    }
}

#[test]
fn the_winding_number_of_dipoles_is_near_that_of_all_triangles() {
    let mesh = together(&torus(60, 30, 1.0, 0.4), &ball(12, Vector([0.0, 0.0, 0.9]), 0.3));
    let index = index(&mesh);
    for p in places(200, 2.0) {
        let exact = index.topology.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| index.topology.points[v as usize] - p);
            let below =
                a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() + b.dot(c) * a.norm() + c.dot(a) * b.norm();
            2.0 * a.dot(b.cross(c)).atan2(below) / (4.0 * std::f64::consts::PI)
        });
        assert!((index.winding(p) - exact.sum::<f64>()).abs() < 0.03, "{p:?}: {}", index.winding(p));
    }
}

#[test]
fn what_lies_within_a_cavity_is_outside() {
    let shell = together(&ball(16, Vector::ZERO, 1.0), &turned(&ball(16, Vector::ZERO, 0.5)));
    let index = index(&shell);
    assert!(index.is_inside(Vector([0.75, 0.0, 0.0])) && !index.is_inside(Vector([0.1, 0.0, 0.0])));
    assert!((index.signed_distance(Vector([0.0, 0.0, 0.1])) + 0.4).abs() < 0.01);
}

#[test]
fn a_sound_mesh_is_reported_as_such() {
    let of_torus = report(&torus(60, 30, 1.0, 0.4));
    assert!(of_torus.is_closed() && !of_torus.is_inverted() && of_torus.components == 1);
    assert!((of_torus.volume - 2.0 * 9.8696 * 0.16).abs() < 0.06 && (of_torus.area - 39.478 * 0.4).abs() < 0.2);
    assert!(of_torus.volume_of("a.obj").unwrap().is_empty() && of_torus.surface_of("a.obj").unwrap().is_empty());
    // Corners of their own for each triangle, as in STL.
    let mut soup = TriangleMesh::default();
    for t in &torus(60, 30, 1.0, 0.4).triangles {
        let at = soup.positions.len() as u32;
        soup.positions.extend(t.map(|v| torus(60, 30, 1.0, 0.4).positions[v as usize]));
        soup.triangles.push([at, at + 1, at + 2]);
        if at > 600 {
            break;
        }
    }
    let of_soup = report(&soup);
    assert_eq!((of_soup.components, of_soup.turned_edges.count), (1, 0));
    assert!(of_soup.open_edges.count < 140);
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let sheet = report(&grid(8, 8, [false, false], |u, v| Vector([u, v, 0.0])));
    assert_eq!(sheet.open_edges.count, 32);
    let error = sheet.volume_of("a.obj").unwrap_err().to_string();
    assert!(error.contains("a.obj: an open surface") && error.contains("32, the first at (0.0625, 0, 0)"), "{error}");
    assert!(sheet.surface_of("a.obj").unwrap().is_empty());

    let mut open = ball(24, Vector::ZERO, 1.0);
    open.triangles.drain(300..306);
    let open = report(&open).volume_of("a.obj").unwrap();
    assert!(open.len() == 1 && open[0].message.contains("open edges: 8"), "{open:?}");

    let inverted = report(&turned(&ball(8, Vector::ZERO, 1.0)));
    assert!(inverted.is_inverted() && inverted.volume_of("a.obj").unwrap()[0].message.contains("face inwards"));

    let mut twisted = ball(12, Vector::ZERO, 1.0);
    twisted.triangles[40].swap(0, 1);
    let error = report(&twisted).volume_of("a.obj").unwrap_err().to_string();
    assert!(error.contains("do not agree: 3"), "{error}");

    let mut fin = cuboid(Vector([0.0; 3]), Vector([1.0; 3]));
    fin.positions.push(Vector([2.0, 2.0, 0.5]));
    fin.triangles.push([3, 7, 8]);
    assert_eq!(report(&fin).crowded_edges.count, 1);

    let crossed = report(&together(&ball(12, Vector::ZERO, 1.0), &ball(12, Vector([1.2, 0.3, 0.1]), 1.0)));
    assert!(crossed.crossings.count > 10 && crossed.components == 2 && crossed.crossings_counted);
    assert!(crossed.volume_of("a.obj").unwrap()[0].message.contains("pass through"));

    let mut flat = cuboid(Vector([0.0; 3]), Vector([1.0; 3]));
    flat.triangles.push([0, 1, 1]);
    assert_eq!(report(&flat).flat_triangles.count, 1);
    let thin = report(&cuboid(Vector([0.0; 3]), Vector([1.0, 1.0, 0.0])));
    assert!(thin.volume_of("a.obj").unwrap_err().to_string().contains("encloses nothing"));
}

#[test]
fn dear_questions_are_counted_and_told() {
    let budget = Budget::default();
    let even = MeshIndex::new(&ball(24, Vector::ZERO, 1.0), "a.obj", &budget).unwrap();
    assert_eq!(even.dearness(), 0.0);
    let before = budget.work();
    // In the very middle everything is as near as everything else.
    for p in places(50, 1.2).into_iter().map(|p| p.unit_or_zero() * (1.0 + 0.2 * p.norm())) {
        std::hint::black_box(even.closest(p));
    }
    assert_eq!(budget.work(), before, "the loop pays for ordinary questions");
    // Thin triangles around one corner lie in one another's boxes.
    let fan = fan(4000, &budget);
    let before = budget.work();
    for p in places(50, 0.5) {
        std::hint::black_box(fan.closest(p));
    }
    let each = (budget.work() - before) as f64 / 50.0;
    assert!(each > 1000.0 && fan.dearness() > 1000.0, "{each} {}", fan.dearness());
    let error = fan.signed_distances(&vec![Vector::ZERO; 1_000_000], &Budget::default()).unwrap_err().to_string();
    let corner = "fan.obj: questions to its triangles, in million units of work: 4000 triangles meet in the corner at (0, 0, 0.4)";
    assert!(error.contains(corner) && error.contains("--limit work="), "{error}");
    // It is known before any of it is done.
    let few = Budget::default();
    assert!(fan.expect(1e6, &few).unwrap_err().to_string().contains(corner));
    assert!(few.work() < 100_000_000, "{}", few.work());
    even.expect(1e5, &few).unwrap();
}

/// Thin triangles from one corner to a circle of radius 1 below it, and back to another corner.
fn fan(count: u32, budget: &Budget) -> MeshIndex {
    let rim = |k: u32| {
        let turn = f64::from(k) / f64::from(count) * std::f64::consts::TAU;
        Vector([turn.cos(), turn.sin(), 0.0])
    };
    let positions = [0.4, -0.4].map(|z| Vector([0.0, 0.0, z])).into_iter().chain((0..count).map(rim)).collect();
    let next = |k: u32| [k + 2, (k + 1) % count + 2];
    let triangles = (0..count).flat_map(|k| [[0, next(k)[0], next(k)[1]], [1, next(k)[1], next(k)[0]]]).collect();
    MeshIndex::new(&TriangleMesh { positions, triangles, ..TriangleMesh::default() }, "fan.obj", budget).unwrap()
}

#[test]
fn the_triangles_of_a_fan_are_known_not_to_cross() {
    let budget = Budget::default();
    let fan = MeshReport::new(&fan(2000, &budget), &budget).unwrap();
    assert!(fan.crossings_counted && !fan.crossings.any() && fan.is_closed());
}

#[test]
fn what_is_no_mesh_is_refused() {
    let refused = |mesh: &TriangleMesh, limits: Limits| {
        MeshIndex::new(mesh, "a.obj", &Budget::new(limits)).map(|_| ()).unwrap_err().to_string()
    };
    let points = TriangleMesh { positions: vec![Vector::ZERO], ..TriangleMesh::default() };
    assert!(refused(&points, Limits::default()).contains("without triangles"));
    let mut far = cuboid(Vector([0.0; 3]), Vector([1.0; 3]));
    far.positions[2] = Vector([0.0, f64::NAN, 2e30]);
    assert!(refused(&far, Limits::default()).contains("vertex 3"));
    let large = ball(40, Vector::ZERO, 1.0);
    assert!(refused(&large, Limits { nodes: 1000, ..Limits::default() }).contains("--limit nodes="));
    assert!(refused(&large, Limits { memory: 1 << 20, ..Limits::default() }).contains("--limit memory="));
}
