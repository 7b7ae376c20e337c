//! Surfaces of points whose true surface is known.

use arabesque_core::{Budget, PointSet, Stage, StopReason, Stream, TriangleMesh, Unobserved, Vector};
use proptest::prelude::*;

use super::{
    manifold::{assert_closed, assert_manifold},
    shapes::{ball, cuboid, grid, together, torus},
};
use crate::{MeshIndex, MeshReport, Normals, Reconstruction, SurfaceParams, reconstruct, scatter};

/// Evenly spread points of a mesh, with its normals.
fn points_of(mesh: &TriangleMesh, spacing: f64) -> PointSet<3> {
    let index = MeshIndex::new(mesh, "a.obj", &Budget::default()).unwrap();
    let found = scatter(&index, spacing, 1, &Budget::default()).unwrap();
    let mut points = PointSet::at(found.iter().map(|p| p.point).collect());
    // Normals of the triangles: edges stay sharp.
    let normal = |t: usize| {
        let [a, b, c] = index.corners(t);
        (b - a).cross(c - a).unit()
    };
    points.normals = Some(found.iter().map(|p| normal(p.triangle)).collect());
    points
}

fn made_with(points: &PointSet<3>, params: &SurfaceParams) -> Reconstruction {
    let made = reconstruct(points, params, None, &Budget::default(), &mut Unobserved).unwrap();
    assert!(made.mesh.check("made").is_ok() && made.stopped == StopReason::Finished);
    let mesh = &made.mesh;
    assert!((0..mesh.triangles.len()).all(|t| mesh.double_area(t).norm() > 0.0), "a triangle without area");
    made
}

fn made(points: &PointSet<3>) -> TriangleMesh {
    let made = made_with(points, &SurfaceParams::default());
    assert!(made.warnings.is_empty(), "{:?}", made.warnings);
    made.mesh
}

fn report(mesh: &TriangleMesh) -> MeshReport {
    MeshReport::new(&MeshIndex::new(mesh, "made", &Budget::default()).unwrap(), &Budget::default()).unwrap()
}

/// Mean distance of points to a mesh, as a share of their diagonal.
fn mean_distance(points: &PointSet<3>, mesh: &TriangleMesh) -> f64 {
    let index = MeshIndex::new(mesh, "made", &Budget::default()).unwrap();
    let closest = index.closest_all(&points.positions, &Budget::default()).unwrap();
    closest.iter().map(|c| c.distance).sum::<f64>() / points.len() as f64 / points.bounds().size().norm()
}

#[test]
fn a_ball_is_closed_and_round() {
    let points = points_of(&ball(40, Vector::ZERO, 1.0), 0.08);
    let mesh = made(&points);
    assert_closed(&mesh.triangles, mesh.positions.len());
    assert!(mesh.positions.iter().all(|p| (p.norm() - 1.0).abs() < 0.01));
    let normals = mesh.normals.as_ref().unwrap();
    assert!(mesh.positions.iter().zip(normals).all(|(p, n)| p.cosine(*n) > 0.98));
    let report = report(&mesh);
    assert!((report.volume - 4.18879).abs() < 0.06 && report.components == 1);
    // About six triangles for each point.
    assert!((4.0..9.0).contains(&(mesh.triangles.len() as f64 / points.len() as f64)));
}

#[test]
fn a_torus_has_its_hole() {
    let points = points_of(&torus(120, 60, 1.0, 0.3), 0.06);
    let mesh = made(&points);
    assert_closed(&mesh.triangles, mesh.positions.len());
    assert_eq!(mesh.positions.len() as i64 - mesh.triangles.len() as i64 / 2, 0, "Euler number of a torus");
    assert!(mean_distance(&points, &mesh) < 0.001);
}

#[test]
fn balls_that_nearly_touch_stay_apart() {
    for gap in [0.01, 0.05, 0.2] {
        let far = 2.0 + gap;
        let both = together(&ball(40, Vector::ZERO, 1.0), &ball(40, Vector([far, 0.0, 0.0]), 1.0));
        let mesh = made(&points_of(&both, 0.1));
        assert_closed(&mesh.triangles, mesh.positions.len());
        assert_eq!(report(&mesh).components, 2, "a gap of {gap}");
        let off = |p: &Vector<3>| (p.norm() - 1.0).abs().min(((*p - Vector([far, 0.0, 0.0])).norm() - 1.0).abs());
        assert!(mesh.positions.iter().all(|p| off(p) < 0.03), "no bridge across a gap of {gap}");
    }
}

#[test]
fn thin_plates_keep_both_sides() {
    let mesh = made(&points_of(&cuboid(Vector::ZERO, Vector([1.0, 1.0, 0.06])), 0.04));
    assert_closed(&mesh.triangles, mesh.positions.len());
    let report = report(&mesh);
    assert!((report.volume / 0.06 - 1.0).abs() < 0.1 && report.components == 1, "{report:?}");
}

#[test]
fn edges_of_a_box_stay_sharp() {
    let mesh = made(&points_of(&cuboid(Vector::ZERO, Vector([1.0, 0.8, 0.6])), 0.05));
    assert_closed(&mesh.triangles, mesh.positions.len());
    let index = MeshIndex::new(&mesh, "made", &Budget::default()).unwrap();
    let corner = index.closest(Vector::ZERO).distance;
    let edge = index.closest(Vector([0.5, 0.0, 0.0])).distance;
    assert!(edge < 0.012 && corner < 0.02, "{edge} {corner}");
}

#[test]
fn an_open_sheet_ends_near_its_outermost_points() {
    let wave = |u: f64, v: f64| Vector([u, v, 0.05 * (6.0 * u).sin()]);
    let points = points_of(&grid(40, 40, [false; 2], wave), 0.04);
    let mesh = made(&points);
    assert!(assert_manifold(&mesh.triangles, mesh.positions.len()) > 50);
    let report = report(&mesh);
    assert_eq!(report.components, 1, "no crumbs");
    let beyond = |p: &Vector<3>| (0..2).map(|k| (-p[k]).max(p[k] - 1.0)).fold(0.0, f64::max);
    let farthest = mesh.positions.iter().map(beyond).fold(0.0, f64::max);
    assert!(farthest < 0.06, "{farthest}");
    let index = MeshIndex::new(&mesh, "made", &Budget::default()).unwrap();
    assert!(points.positions.iter().all(|&p| index.closest(p).distance < 0.01), "all points are on it");
    assert!((report.area / 1.07 - 1.0).abs() < 0.1, "{}", report.area);
    // One outline: as many rim edges as rim vertices, and the Euler number of a disc.
    let edges = (3 * mesh.triangles.len() + report.open_edges.count) / 2;
    assert_eq!(mesh.positions.len() as i64 - edges as i64 + mesh.triangles.len() as i64, 1, "no holes");
}

#[test]
fn groups_and_elements_are_parts_with_names() {
    let second = ball(24, Vector([1.5, 0.0, 0.0]), 1.0);
    let mut points = points_of(&together(&ball(24, Vector::ZERO, 1.0), &second), 0.15);
    let normals = points.normals.clone().unwrap();
    let is_first = |(p, n): (&Vector<3>, &Vector<3>)| p.cosine(*n) > 0.99 && (p.norm() - 1.0).abs() < 0.02;
    let groups: Vec<i32> =
        points.positions.iter().zip(&normals).map(|pair| if is_first(pair) { 3 } else { 7 }).collect();
    points.groups = Some(groups.clone());
    let mesh = made(&points);
    assert_closed(&mesh.triangles, mesh.positions.len());
    let names: Vec<_> = mesh.parts.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["group 3", "group 7"]);
    assert_eq!((mesh.parts[0].triangles.start, mesh.parts[1].triangles.end), (0, mesh.triangles.len()));
    points.elements = Some(groups.iter().map(|&g| if g == 7 { 0 } else { -1 }).collect());
    let names: Vec<_> = made(&points).parts.into_iter().map(|p| p.name).collect();
    assert_eq!(names, ["group 3", "element 0"]);
    let mut one = SurfaceParams::default();
    one.set("parts", "one").unwrap();
    let joined = made_with(&points, &one).mesh;
    assert!(joined.parts.is_empty());
}

#[test]
fn colours_go_with_the_surface() {
    let mut points = points_of(&ball(24, Vector::ZERO, 1.0), 0.1);
    points.colours =
        Some(points.positions.iter().map(|p| if p[2] > 0.0 { [1.0, 0.0, 0.2] } else { [0.0, 1.0, 0.2] }).collect());
    let mesh = made(&points);
    for (p, c) in mesh.positions.iter().zip(mesh.colours.as_ref().unwrap()) {
        assert!(
            (c[2] - 0.2).abs() < 1e-3 && (p[2] < 0.25 || c[0] > 0.95) && (p[2] > -0.25 || c[1] > 0.95),
            "{p:?} {c:?}"
        );
    }
}

#[test]
fn what_is_outside_of_the_trimming_mesh_is_cut_off() {
    let points = points_of(&ball(24, Vector::ZERO, 1.0), 0.1);
    let bounds = (Vector([-2.0, -2.0, -0.3]), Vector([2.0, 2.0, 0.5]));
    let trim = MeshIndex::new(&cuboid(bounds.0, bounds.1), "trim", &Budget::default()).unwrap();
    let made =
        reconstruct(&points, &SurfaceParams::default(), Some(&trim), &Budget::default(), &mut Unobserved).unwrap();
    let report = report(&made.mesh);
    assert_closed(&made.mesh.triangles, made.mesh.positions.len());
    let (low, high) = (report.bounds.min[2], report.bounds.max[2]);
    assert!((low + 0.3).abs() < 0.01 && (high - 0.5).abs() < 0.01, "{:?}", report.bounds);
    // A slice of a ball: pi (z - z^3 / 3) from -0.3 to 0.5.
    let slice = |z: f64| std::f64::consts::PI * (z - z * z * z / 3.0);
    assert!((report.volume - (slice(0.5) - slice(-0.3))).abs() < 0.04, "{}", report.volume);
    let far = MeshIndex::new(&cuboid(Vector([5.0; 3]), Vector([6.0; 3])), "trim", &Budget::default()).unwrap();
    let error = reconstruct(&points, &SurfaceParams::default(), Some(&far), &Budget::default(), &mut Unobserved);
    assert!(error.unwrap_err().to_string().contains("trims it"));
}

fn trimmed(points: &PointSet<3>, trim: &TriangleMesh) -> TriangleMesh {
    let trim = MeshIndex::new(trim, "trim", &Budget::default()).unwrap();
    let params = SurfaceParams::default();
    let made = reconstruct(points, &params, Some(&trim), &Budget::default(), &mut Unobserved).unwrap();
    assert!((0..made.mesh.triangles.len()).all(|t| made.mesh.double_area(t).norm() > 0.0));
    made.mesh
}

#[test]
fn closed_surfaces_that_are_trimmed_have_lids() {
    // A ring cut by a ball in two places, and once more by a ball turned inside out.
    let ring = points_of(&torus(60, 30, 1.0, 0.3), 0.06);
    let mut side = ball(24, Vector([1.0, 0.0, 0.0]), 0.9);
    for round in 0..2 {
        let mesh = trimmed(&ring, &side);
        assert_closed(&mesh.triangles, mesh.positions.len());
        let report = report(&mesh);
        assert!(report.components == 1 && report.volume > 0.3 && report.volume < 0.75, "{round}: {}", report.volume);
        assert!(mesh.positions.iter().all(|p| (*p - Vector([1.0, 0.0, 0.0])).norm() < 0.91));
        let normals = mesh.normals.as_ref().unwrap();
        let lid = |p: &Vector<3>| {
            (*p - Vector([1.0, 0.0, 0.0])).norm() > 0.885 && ((p[0].hypot(p[1]) - 1.0).hypot(p[2])) < 0.2
        };
        let outwards = |k: usize| normals[k].cosine(mesh.positions[k] - Vector([1.0, 0.0, 0.0])) > 0.9;
        let lids: Vec<usize> = (0..normals.len()).filter(|&k| lid(&mesh.positions[k])).collect();
        assert!(lids.len() > 30 && lids.iter().all(|&k| outwards(k)), "{}", lids.len());
        side.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
}

#[test]
fn trimmed_metaballs_are_closed_and_keep_their_colours() {
    let row = (0..40).map(|k| Vector([f64::from(k) * 0.05, 0.0, 0.0])).collect();
    let colours = Some(vec![[0.9, 0.5, 0.2]; 40]);
    let points = PointSet { radii: Some(vec![0.2; 40]), colours, ..PointSet::at(row) };
    let mesh = trimmed(&points, &cuboid(Vector([0.5, -1.0, -1.0]), Vector([1.2, 1.0, 0.1])));
    assert_closed(&mesh.triangles, mesh.positions.len());
    let bounds = mesh.bounds();
    assert!(
        (bounds.min[0] - 0.5).abs() < 0.02 && (bounds.max[0] - 1.2).abs() < 0.02 && bounds.max[2] < 0.11,
        "{bounds:?}"
    );
    assert!(mesh.colours.unwrap().iter().all(|c| (c[0] - 0.9).abs() < 0.02 && (c[2] - 0.2).abs() < 0.02));
}

#[test]
fn an_open_sheet_that_is_trimmed_stays_open() {
    let sheet = points_of(&grid(20, 20, [false, false], |a, b| Vector([a, b, 0.05 * (a * 9.0).sin()])), 0.04);
    let mesh = trimmed(&sheet, &cuboid(Vector([0.2, 0.3, -1.0]), Vector([0.8, 0.6, 1.0])));
    assert!(assert_manifold(&mesh.triangles, mesh.positions.len()) > 20);
    let bounds = mesh.bounds();
    assert!((bounds.min[0] - 0.2).abs() < 0.01 && (bounds.max[1] - 0.6).abs() < 0.01, "{bounds:?}");
}

#[test]
fn metaballs_keep_their_radii() {
    let row: Vec<_> = (0..30).map(|k| Vector([f64::from(k) * 0.05, 0.0, 0.0])).collect();
    let mut points = PointSet::at(row);
    points.positions.push(Vector([3.0, 0.0, 0.0]));
    points.radii = Some([vec![0.1; 30], vec![0.2]].concat());
    let mesh = made(&points);
    assert_closed(&mesh.triangles, mesh.positions.len());
    assert_eq!(report(&mesh).components, 2);
    for p in &mesh.positions {
        let from_axis = p[1].hypot(p[2]);
        if (0.3..1.1).contains(&p[0]) {
            assert!((from_axis / 0.1 - 1.0).abs() < 0.1, "a dense row is a rod of its radius: {p:?}");
        } else if p[0] > 2.0 {
            assert!(((*p - Vector([3.0, 0.0, 0.0])).norm() - 0.2).abs() < 0.005, "{p:?}");
        }
    }
}

#[test]
fn scans_without_normals_get_them() {
    let mut points = points_of(&together(&torus(120, 60, 1.0, 0.3), &ball(30, Vector([3.0, 0.0, 0.0]), 0.7)), 0.07);
    let true_normals = points.normals.take().unwrap();
    let found = made_with(&points, &SurfaceParams::default());
    assert_closed(&found.mesh.triangles, found.mesh.positions.len());
    assert!(report(&found.mesh).volume > 2.5, "both face outwards");
    assert!(found.warnings[0].message.contains("were estimated") && found.warnings[1].message.contains("2 pieces"));
    // A quarter of the normals turned round: they are turned back.
    let mut random = Stream::new(1, Stage::TEST, 0);
    points.normals = Some(true_normals.iter().map(|n| if random.unit() < 0.25 { -*n } else { *n }).collect());
    let found = made_with(&points, &SurfaceParams::default());
    assert_closed(&found.mesh.triangles, found.mesh.positions.len());
    assert!(
        report(&found.mesh).volume > 2.5 && found.warnings[0].message.contains("contradicted"),
        "{:?}",
        found.warnings
    );
    // Some without a direction.
    points.normals = Some(
        true_normals
            .iter()
            .enumerate()
            .map(|(k, n)| match k % 50 {
                0 => Vector::ZERO,
                1 => *n * f64::NAN,
                _ => *n * 3.0,
            })
            .collect(),
    );
    let found = made_with(&points, &SurfaceParams { normals: Normals::Given, ..SurfaceParams::default() });
    assert!(
        found.warnings.len() == 1 && found.warnings[0].message.contains("without a direction"),
        "{:?}",
        found.warnings
    );
    assert_closed(&found.mesh.triangles, found.mesh.positions.len());
}

#[test]
fn noise_is_smoothed_and_outliers_are_told() {
    let mut points = points_of(&ball(40, Vector::ZERO, 1.0), 0.08);
    let mut random = Stream::new(9, Stage::TEST, 0);
    points.positions.iter_mut().for_each(|p| *p = *p * (1.0 + random.range(-0.01, 0.01)));
    points.positions.push(Vector([4.0, 0.0, 0.0]));
    points.normals = None;
    let found = made_with(&points, &SurfaceParams::default());
    assert!(found.mesh.positions.iter().all(|p| (p.norm() - 1.0).abs() < 0.02));
    assert!(
        found.warnings.iter().any(|w| w.message.contains("1 point was far from the others")),
        "{:?}",
        found.warnings
    );
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let points = points_of(&together(&torus(60, 30, 1.0, 0.3), &ball(20, Vector([1.0, 0.0, 0.62]), 0.3)), 0.06);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made_with(&points, &SurfaceParams::default()).mesh)
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    #[test]
    fn a_surface_goes_with_its_points(angle in 0.0..6.0_f64, shift in prop::array::uniform3(-5.0..5.0_f64), scale in 0.01..50.0_f64) {
        let points = points_of(&together(&cuboid(Vector::ZERO, Vector([1.0, 0.8, 0.6])), &ball(16, Vector([2.0, 0.0, 0.0]), 0.5)), 0.09);
        let (sin, cos) = angle.sin_cos();
        let turn = |v: Vector<3>| Vector([cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]]);
        let mut moved = points.clone();
        moved.positions.iter_mut().for_each(|p| *p = turn(*p) * scale + Vector(shift));
        moved.normals.iter_mut().flatten().for_each(|n| *n = turn(*n));
        let (here, there) = (made(&points), made(&moved));
        assert_closed(&there.triangles, there.positions.len());
        let index = MeshIndex::new(&there, "made", &Budget::default()).unwrap();
        let off = here.positions.iter().map(|p| index.closest(turn(*p) * scale + Vector(shift)).distance);
        let mean = off.sum::<f64>() / here.positions.len() as f64 / scale;
        prop_assert!(mean < 0.004, "{mean}");
    }
}
