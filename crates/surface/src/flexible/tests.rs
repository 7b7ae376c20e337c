use arabesque_core::{Budget, Build, Matrix, Similarity, Stage, Stream, TriangleMesh, Vector, polyline_length};

use super::{Skin, Tube, balls};
use crate::mesh::MeshIndex;

/// A closed tube along a line.
fn tube(line: &[Vector<3>], radius: f64, sides: u32) -> TriangleMesh {
    let count = line.len();
    let mut mesh = TriangleMesh::default();
    let mut across = Vector([0.1, 0.9, 0.2]);
    for k in 0..count {
        let way = (line[(k + 1).min(count - 1)] - line[k.saturating_sub(1)]).unit();
        across = (across - way * across.dot(way)).unit();
        let other = way.cross(across);
        mesh.positions.extend((0..sides).map(|j| {
            let (sin, cos) = (f64::from(j) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
            line[k] + (across * cos + other * sin) * radius
        }));
    }
    for k in 0..count as u32 - 1 {
        for j in 0..sides {
            let (a, b) = (k * sides + j, k * sides + (j + 1) % sides);
            mesh.triangles.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
        }
    }
    let last = (count as u32 - 1) * sides;
    for j in 1..sides - 1 {
        mesh.triangles.extend([[0, j + 1, j], [last, last + j, last + j + 1]]);
    }
    mesh
}

/// A wave in space, `length` long more or less.
fn wave(length: f64, bends: f64) -> Vec<Vector<3>> {
    let at = |k: u32| {
        let x = f64::from(k) / 40.0;
        Vector([length * x, 0.08 * length * (bends * x * 6.0).sin(), 0.05 * length * (bends * x * 4.0).cos()])
    };
    (0..=40).map(at).collect()
}

/// The same surface with a vertex for each corner of each triangle, in another order.
fn taken_apart(mesh: &TriangleMesh) -> TriangleMesh {
    let mut order: Vec<usize> = (0..mesh.triangles.len()).collect();
    Stream::new(1, Stage::TEST, 0).shuffle(&mut order);
    let positions: Vec<_> = order.iter().flat_map(|t| mesh.corners(*t)).collect();
    let triangles = (0..order.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh { positions, triangles, ..TriangleMesh::default() }
}

fn found(mesh: &TriangleMesh) -> Option<Tube> {
    Tube::of(mesh, &Budget::default()).unwrap()
}

#[test]
fn a_tube_of_any_make_has_its_centre_line() {
    for (sides, radius) in [(4, 0.1), (6, 0.2), (16, 0.3)] {
        let line = wave(8.0, 1.0);
        let mesh = tube(&line, radius, sides);
        for mesh in [mesh.clone(), taken_apart(&mesh)] {
            let tube = found(&mesh).unwrap();
            let length = polyline_length(&line);
            assert!((tube.length() / length - 1.0).abs() < 0.02, "{sides} sides: {} of {length}", tube.length());
            assert!(tube.radius > 0.65 * radius && tube.radius < 1.01 * radius, "{} of {radius}", tube.radius);
            for p in tube.samples(20) {
                let off = line.windows(2).map(|w| distance(p, w)).fold(f64::INFINITY, f64::min);
                assert!(off < 0.15 * radius, "{sides} sides: {off} off");
            }
        }
    }
}

fn distance(p: Vector<3>, way: &[Vector<3>]) -> f64 {
    let step = way[1] - way[0];
    let t = ((p - way[0]).dot(step) / step.norm2()).clamp(0.0, 1.0);
    (way[0] + step * t - p).norm()
}

#[test]
fn round_things_rings_and_pairs_have_no_line() {
    let meridian: Vec<_> = (0..=12).map(|k| Vector([f64::from(k) - 6.0, 0.0, 0.0])).collect();
    let mut ball = tube(&meridian, 1.0, 12);
    ball.positions.iter_mut().for_each(|p| {
        let across = (36.0 - p[0] * p[0]).max(0.01).sqrt();
        *p = Vector([p[0], p[1] * across, p[2] * across]);
    });
    assert_eq!(found(&ball), None);
    assert_eq!(found(&ring()), None);
    let mut pair = tube(&wave(5.0, 1.0), 0.1, 6);
    let count = pair.positions.len() as u32;
    pair.positions.extend(pair.positions.clone().iter().map(|p| *p + Vector([0.0, 3.0, 0.0])));
    pair.triangles.extend(pair.triangles.clone().iter().map(|t| t.map(|v| v + count)));
    assert_eq!(found(&pair), None);
    assert_eq!(found(&TriangleMesh::default()), None);
}

/// A ring without ends.
fn ring() -> TriangleMesh {
    let (around, sides) = (48_u32, 8_u32);
    let turn = |k: u32, of: u32| (f64::from(k) / f64::from(of) * std::f64::consts::TAU).sin_cos();
    let mut mesh = TriangleMesh::default();
    for k in 0..around {
        let (sin, cos) = turn(k, around);
        for (s, c) in (0..sides).map(|j| turn(j, sides)) {
            mesh.positions.push(Vector([(3.0 + 0.3 * c) * cos, (3.0 + 0.3 * c) * sin, 0.3 * s]));
        }
    }
    for (k, j) in (0..around).flat_map(|k| (0..sides).map(move |j| (k, j))) {
        let at = |k: u32, j: u32| k % around * sides + j % sides;
        let (a, b, c, d) = (at(k, j), at(k + 1, j), at(k + 1, j + 1), at(k, j + 1));
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

fn motion() -> Similarity<3> {
    let (s, c) = 0.7_f64.sin_cos();
    let rotation = Matrix([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]);
    let (s, c) = 1.1_f64.sin_cos();
    let rotation = rotation.compose(&Matrix([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]));
    Similarity { rotation, scale: 1.0, translation: Vector([3.0, -2.0, 5.0]) }
}

#[test]
fn samples_that_move_as_a_whole_take_the_mesh_along_rigidly() {
    let mesh = tube(&wave(6.0, 1.0), 0.2, 6);
    let samples = found(&mesh).unwrap().samples(15);
    for build in [Build::Strand, Build::Bag, Build::Rigid] {
        let skin = Skin::new(build, &samples, &mesh.positions);
        for scale in [1.0, 2.5] {
            let motion = Similarity { scale, ..motion() };
            let to: Vec<_> = samples.iter().map(|p| motion.apply(*p)).collect();
            let (moved, turned) = skin.moved(&to, scale);
            for (p, q) in mesh.positions.iter().zip(&moved) {
                assert!((motion.apply(*p) - *q).norm() < 1e-9, "{build:?}: off by {}", (motion.apply(*p) - *q).norm());
            }
            let off = |turn: &Matrix<3>| {
                (turn.apply(Vector([1.0, 2.0, 3.0])) - motion.rotation.apply(Vector([1.0, 2.0, 3.0]))).norm()
            };
            assert!(turned.iter().all(|turn| off(turn) < 1e-9), "{build:?}");
        }
    }
}

#[test]
fn a_strand_that_is_bent_keeps_its_length_and_thickness() {
    let mesh = tube(&wave(6.0, 0.0), 0.1, 8);
    let own = found(&mesh).unwrap();
    let samples = own.samples(25);
    let step = own.length() / 24.0;
    // Around three quarters of a circle.
    let mut to = vec![Vector([0.0, 0.0, 0.0])];
    for k in 0..24 {
        let (sin, cos) = (f64::from(k) / 24.0 * 1.5 * std::f64::consts::PI).sin_cos();
        to.push(to[to.len() - 1] + Vector([cos, sin, 0.1]).unit() * step);
    }
    let (positions, _) = Skin::new(Build::Strand, &samples, &mesh.positions).moved(&to, 1.0);
    let bent = found(&TriangleMesh { positions, ..mesh.clone() }).unwrap();
    assert!((bent.length() / own.length() - 1.0).abs() < 0.02, "{} of {}", bent.length(), own.length());
    assert!((bent.radius / own.radius - 1.0).abs() < 0.05, "{} of {}", bent.radius, own.radius);
}

#[test]
fn a_bag_gives_way_and_its_edges_hardly() {
    let line: Vec<_> = (0..=12).map(|k| Vector([0.25 * f64::from(k), 0.0, 0.0])).collect();
    let mesh = tube(&line, 0.8, 12);
    let index = MeshIndex::new(&mesh, "bag", &Budget::default()).unwrap();
    let samples: Vec<_> = balls(&index, 26, &Budget::default()).unwrap().into_iter().map(|b| b.0).collect();
    assert!(samples.len() > 8, "{}", samples.len());
    // Bent about z to a curvature of 1 in 6.
    let bend =
        |p: &Vector<3>| Vector([(6.0 - p[1]) * (p[0] / 6.0).sin(), 6.0 - (6.0 - p[1]) * (p[0] / 6.0).cos(), p[2]]);
    let to: Vec<_> = samples.iter().map(bend).collect();
    let (moved, _) = Skin::new(Build::Bag, &samples, &mesh.positions).moved(&to, 1.0);
    let mut worst = 0.0_f64;
    for t in &mesh.triangles {
        for k in 0..3 {
            let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
            let (before, after) = ((mesh.positions[a] - mesh.positions[b]).norm(), (moved[a] - moved[b]).norm());
            worst = worst.max((after / before - 1.0).abs());
        }
    }
    assert!(worst < 0.25, "an edge changes by {worst}");
    let off = mesh.positions.iter().zip(&moved).map(|(p, q)| (bend(p) - *q).norm()).fold(0.0, f64::max);
    assert!(off < 0.2, "{off}");
}

#[test]
fn balls_stand_for_what_is_inside() {
    let line: Vec<_> = (0..=8).map(|k| Vector([0.5 * f64::from(k), 0.0, 0.0])).collect();
    let mesh = tube(&line, 0.7, 16);
    let index = MeshIndex::new(&mesh, "log", &Budget::default()).unwrap();
    let found = balls(&index, 12, &Budget::default()).unwrap();
    assert!((2..=12).contains(&found.len()));
    for (p, radius) in &found {
        assert!(index.is_inside(*p) && *radius > 0.2 && *radius < 1.1, "{p:?} {radius}");
    }
    let covered = |p: &Vector<3>| found.iter().any(|(q, r)| (*p - *q).norm() < 1.6 * r);
    assert!(mesh.positions.iter().all(covered));
}
