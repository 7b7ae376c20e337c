//! Handedness and directions: a right-handed rope stays right-handed, and a pattern runs where its field leads.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::{f64::consts::TAU, sync::Arc};

use arabesque_core::{
    Bounds, Budget, Domain, Fields, Matrix, OrientationField, PointSet, ScalarField, TriangleMesh, Unobserved, Vector,
};
use arabesque_structures::{Flat, Prepared, Shell, StructureParams, StructureRequest, Territory, Thread, Tube};
use arabesque_surface::{Bend, DirectionField, Directions, MeshIndex};

const RADIUS: f64 = 0.06;

/// Points along a screw about x, 1 long, with outward normals; right-handed where `hand` is 1.
fn screw(hand: f64) -> PointSet<3> {
    let at = |k: u32| (f64::from(k) + 0.5) / 120.0;
    let out = |x: f64| {
        let (sin, cos) = (hand * 5.0 * TAU * x).sin_cos();
        Vector([0.0, cos, sin])
    };
    let positions = (0..120).map(|k| Vector([at(k), 0.0, 0.0]) + out(at(k)) * RADIUS).collect();
    PointSet { normals: Some((0..120).map(|k| out(at(k))).collect()), ..PointSet::at(positions) }
}

fn made<const D: usize>(exemplar: PointSet<D>, territory: Arc<dyn Territory<D>>) -> PointSet<D> {
    // What the start shows of hand and direction is not lost later on, and a few rounds tell that.
    let params = StructureParams { rounds: 1, steps: 2, ..StructureParams::default() };
    let prepared = Prepared::new(Arc::new(exemplar), &params, &Budget::default()).unwrap();
    prepared.run(&StructureRequest::new(territory), &mut Unobserved).unwrap().points
}

/// Mean sense in which neighbours of a strand turn about an axis, given where each point has it: 1 is right-handed, -1 left-handed. Pairs
/// that lie along the axis, or across it, say nothing.
fn hand(points: &[Vector<3>], near: f64, axis: impl Fn(Vector<3>) -> (Vector<3>, Vector<3>)) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, &p) in points.iter().enumerate() {
        for &q in &points[..i] {
            let d = q - p;
            if d.norm() < near {
                let (centre, tangent) = axis((p + q) * 0.5);
                let out = ((p + q) * 0.5 - centre).unit_or_zero();
                let turn = d.dot(tangent) * d.dot(tangent.cross(out)) / d.norm2();
                if turn.abs() > 0.05 {
                    (sum, count) = (sum + turn.signum(), count + 1.0);
                }
            }
        }
    }
    assert!(count > 100.0, "{count} pairs");
    sum / count
}

/// Distance of neighbours in the screw, and a little.
fn near() -> f64 {
    let points = screw(1.0).positions;
    1.3 * (points[1] - points[0]).norm()
}

/// The nearest point of a polyline and the way it runs there.
fn on_line(corners: &[Vector<3>], p: Vector<3>) -> (Vector<3>, Vector<3>) {
    let foot = |w: &[Vector<3>]| {
        let d = w[1] - w[0];
        let t = ((p - w[0]).dot(d) / d.norm2()).clamp(0.0, 1.0);
        (w[0] + d * t, d.unit())
    };
    let all = corners.windows(2).map(foot);
    all.min_by(|a, b| (a.0 - p).norm2().total_cmp(&(b.0 - p).norm2())).unwrap()
}

fn curve(count: u32, at: impl Fn(f64) -> Vector<3>) -> Vec<Vector<3>> {
    (0..=count).map(|k| at(f64::from(k) / f64::from(count))).collect()
}

#[test]
fn a_screw_keeps_its_hand_along_curves() {
    let curves = [
        ("line", curve(1, |t| Vector([2.0 * t, 0.3 * t, 0.0]))),
        ("wave", curve(80, |t| Vector([2.0 * t, 0.2 * (TAU * t).sin(), 0.15 * (TAU * t).cos()]))),
        ("ring", curve(120, |t| Vector([0.5 * (TAU * t).cos(), 0.5 * (TAU * t).sin(), 0.0]))),
    ];
    for (name, corners) in curves {
        for sense in [1.0, -1.0] {
            let tube = Tube::new(vec![Thread::new(corners.clone())], RADIUS).unwrap();
            let found = made(screw(sense), Arc::new(tube));
            let measured = hand(&found.positions, near(), |p| on_line(&corners, p));
            assert!(measured * sense > 0.9, "{name}: {measured} for {sense}");
            // Normals still lead away from the curve.
            let normals = found.normals.unwrap();
            let out = |(p, n): (&Vector<3>, &Vector<3>)| n.dot((*p - on_line(&corners, *p).0).unit_or_zero());
            let least = found.positions.iter().zip(&normals).map(out).sum::<f64>() / normals.len() as f64;
            assert!(least > 0.9, "{name}: {least}");
        }
    }
}

/// Four screws side by side, along x.
fn mat(sense: f64) -> PointSet<3> {
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for row in 0..4 {
        let one = screw(sense);
        // Neighbours in the row start elsewhere in their turn.
        let shift = Vector([0.0, 0.12 + 0.22 * f64::from(row), 0.0]);
        positions.extend(one.positions.iter().map(|&p| p + shift));
        normals.extend(one.normals.unwrap());
    }
    PointSet { normals: Some(normals), ..PointSet::at(positions) }
}

#[test]
fn screws_in_a_sheet_keep_their_hand_and_turn_with_it() {
    let bounds = Bounds::new(Vector([0.0, 0.0, -RADIUS]), Vector([0.9, 0.9, RADIUS]));
    for (sense, quarter) in [(1.0, false), (-1.0, false), (1.0, true)] {
        let turned = Matrix([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let orientation = quarter.then_some(OrientationField::Constant(turned));
        let fields = Fields { orientation, ..Fields::default() };
        let found = made(mat(sense), Arc::new(Flat::new(Domain::Box(bounds), fields)));
        // Each row has its axis where the mean of the points near it is, across: told by the normals.
        let along = if quarter { Vector([0.0, 1.0, 0.0]) } else { Vector([1.0, 0.0, 0.0]) };
        let normals = found.normals.as_ref().unwrap();
        let (mut sum, mut count) = (0.0, 0.0);
        for (i, &p) in found.positions.iter().enumerate() {
            for (k, &q) in found.positions[..i].iter().enumerate() {
                let d = q - p;
                if d.norm() < near() && normals[i].dot(normals[k]) > 0.5 {
                    let turn = d.dot(along) * d.dot(along.cross((normals[i] + normals[k]).unit_or_zero())) / d.norm2();
                    if turn.abs() > 0.05 {
                        (sum, count) = (sum + turn.signum(), count + 1.0);
                    }
                }
            }
        }
        assert!(count > 80.0 && sum / count * sense > 0.85, "{sense} {quarter}: {} of {count}", sum / count);
    }
}

#[test]
fn a_saw_in_the_plane_rises_slowly_all_along_a_ring() {
    // Up for four fifths of a period, then down.
    let height = |x: f64| {
        let t = (x * 6.0).rem_euclid(1.0);
        0.08 * if t < 0.8 { t / 0.8 } else { (1.0 - t) / 0.2 }
    };
    let positions = (0..150).map(|k| f64::from(k) / 150.0).map(|x| Vector::xy(x, height(x) - 0.04)).collect();
    let ring = (0..=180).map(|k| f64::from(k) / 180.0 * TAU).map(|a| Vector::xy(a.cos(), a.sin()) * 0.5).collect();
    let tube = Tube::new(vec![Thread::new(ring)], 0.1).unwrap();
    let found = made(PointSet::at(positions), Arc::new(tube)).positions;
    let mut order: Vec<(f64, f64)> = found.iter().map(|p| (p[1].atan2(p[0]), 0.5 - p.norm())).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The pattern's up is the left of the curve: inside of the ring. A mirrored saw rises for a fifth alone.
    let rises = order.windows(2).filter(|w| w[1].1 > w[0].1).count();
    assert!(rises * 10 > order.len() * 6, "{rises} of {}", order.len());
}

/// Ripples on a sheet: it rises and falls along x, with normals.
fn ripples() -> PointSet<3> {
    let at = |k: u32| (f64::from(k % 18) + 0.5) / 18.0;
    let place = |k: u32| {
        let (x, y) = (at(k), at(k / 18));
        Vector([x, y, 0.03 * (3.0 * TAU * x).sin()])
    };
    let slope = |k: u32| 0.03 * 3.0 * TAU * (3.0 * TAU * at(k)).cos();
    let normals = (0..324).map(|k| Vector([-slope(k), 0.0, 1.0]).unit()).collect();
    PointSet { normals: Some(normals), ..PointSet::at((0..324).map(place).collect()) }
}

/// A grid over the unit square, mapped to space, closed where `wraps` says so.
fn mesh(count: u32, wraps: [bool; 2], place: impl Fn(f64, f64) -> Vector<3>) -> TriangleMesh {
    let side = [count + u32::from(!wraps[0]), count + u32::from(!wraps[1])];
    let number = |i: u32, j: u32| (j % side[1]) * side[0] + i % side[0];
    let share = |k: u32| f64::from(k) / f64::from(count);
    let positions = (0..side[0] * side[1]).map(|k| place(share(k % side[0]), share(k / side[0]))).collect();
    let quads = (0..count * count).map(|k| (k % count, k / count));
    let corners = quads.map(|(i, j)| [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
    let mut mesh = TriangleMesh { positions, ..TriangleMesh::default() };
    mesh.triangles = corners.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).norm()
    };
    mesh.triangles = mesh.triangles.iter().copied().filter(|t| area(t) > 1e-9).collect();
    mesh
}

/// How much more the normals of ripples lean along where the field leads than across, as a share from 0 to 1; `counts` leaves places out.
fn follows(mesh: &TriangleMesh, directions: &Directions, turn: f64, counts: impl Fn(Vector<3>) -> bool) -> f64 {
    let budget = Budget::default();
    let index = Arc::new(MeshIndex::new(mesh, "base", &budget).unwrap());
    let field = Arc::new(DirectionField::new(&index, directions, &budget).unwrap());
    let shell = Shell::new(Arc::clone(&index), Arc::clone(&field), ScalarField::Constant(0.8)).turned(turn);
    let found = made(ripples(), Arc::new(shell));
    let normals = found.normals.unwrap();
    let (mut along, mut all) = (0.0, 0.0);
    for (&p, n) in found.positions.iter().zip(&normals).filter(|(p, _)| counts(**p)) {
        let closest = index.closest(p);
        let frame = field.frame(&index, &closest);
        along += n.dot(frame.tangent).powi(2);
        all += n.dot(frame.tangent).powi(2) + n.dot(frame.bitangent()).powi(2);
    }
    assert!(all > 10.0, "{all}");
    along / all
}

#[test]
fn ripples_run_where_the_field_of_a_plane_leads() {
    let plane = mesh(12, [false, false], |u, v| Vector([1.1 * u, 1.1 * v, 0.0]));
    for way in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]] {
        let share = follows(&plane, &Directions::Constant(Vector(way)), 0.0, |_| true);
        assert!(share > 0.9, "{way:?}: {share}");
    }
    let turned = follows(&plane, &Directions::Constant(Vector([1.0, 0.0, 0.0])), 0.25 * TAU, |_| true);
    assert!(turned < 0.1, "{turned}");
}

#[test]
fn ripples_run_where_the_field_of_a_ring_and_a_ball_leads() {
    let ring = mesh(40, [true, true], |u, v| {
        let (sin, cos) = (TAU * u).sin_cos();
        let (up, out) = (TAU * v).sin_cos();
        Vector([(0.6 + 0.25 * out) * cos, (0.6 + 0.25 * out) * sin, 0.25 * up])
    });
    for bend in [Bend::Least, Bend::Most] {
        let share = follows(&ring, &Directions::Curvature(bend), 0.0, |_| true);
        assert!(share > 0.75, "{bend:?}: {share}");
    }
    let ball = mesh(32, [true, false], |u, v| {
        let (sin, cos) = (TAU * u).sin_cos();
        let (up, out) = (0.5 * TAU * (v - 0.5)).sin_cos();
        Vector([out * cos, out * sin, up]) * 0.45
    });
    // Where the field is singular, at the poles, there is no direction.
    let share = follows(&ball, &Directions::Constant(Vector([0.0, 0.0, 1.0])), 0.0, |p| p[2].abs() < 0.3);
    assert!(share > 0.75, "{share}");
}
