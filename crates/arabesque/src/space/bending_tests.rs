//! Scenes of what bends and what does not.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use arabesque_core::{Budget, Build, Similarity, TriangleMesh, Unobserved, Vector, polyline_length};
use arabesque_io::mesh::{
    gltf::{Scene, SceneMesh, SceneNode, read_scene, write_scene},
    obj,
};
use arabesque_surface::Tube;

use super::bending::bending;
use crate::{Artwork, Deform, Format, Input, OutputOptions, Recipe, Resources, Space};

const RADIUS: f64 = 0.1;

/// A tube of six sides along a line.
fn tube(line: &[Vector<3>]) -> TriangleMesh {
    let (count, sides) = (line.len(), 6_u32);
    let mut mesh = TriangleMesh::default();
    let up = Vector([0.0, 1.0, 0.0]);
    for k in 0..count {
        let way = (line[(k + 1).min(count - 1)] - line[k.saturating_sub(1)]).unit();
        let across = (up - way * up.dot(way)).unit();
        let other = way.cross(across);
        mesh.positions.extend((0..sides).map(|j| {
            let (sin, cos) = (f64::from(j) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
            line[k] + (across * cos + other * sin) * RADIUS
        }));
    }
    for (k, j) in (0..count as u32 - 1).flat_map(|k| (0..sides).map(move |j| (k, j))) {
        let (a, b) = (k * sides + j, k * sides + (j + 1) % sides);
        mesh.triangles.extend([[a, b, b + sides], [a, b + sides, a + sides]]);
    }
    let last = (count as u32 - 1) * sides;
    (1..sides - 1).for_each(|j| mesh.triangles.extend([[0, j + 1, j], [last, last + j, last + j + 1]]));
    mesh
}

/// Noodle `n`: a wave of its own, about 3 long, `swing` high.
fn noodle(n: u32, swing: f64) -> Vec<Vector<3>> {
    let phase = 1.7 * f64::from(n);
    let at = |k: u32| {
        let x = 0.2 * f64::from(k);
        Vector([x, 0.3 * swing * (2.0 * x + phase).cos(), swing * (2.0 * x + phase).sin()])
    };
    (0..16).map(at).collect()
}

/// A scene of a mesh for each node, in rows.
fn scene(name: &str, meshes: Vec<TriangleMesh>) -> Scene {
    let places = (0..meshes.len() as u32).map(|n| {
        let shift = Vector([0.9 * f64::from(n % 4), 0.5 * f64::from(n / 4 % 4), 0.5 * f64::from(n / 16)]);
        SceneNode::new(format!("{name}.{n:03}"), n as usize, Similarity::shift(shift))
    });
    let nodes = places.collect();
    Scene { meshes: meshes.into_iter().map(|m| SceneMesh::new(name, m)).collect(), nodes, ..Scene::default() }
}

fn noodles() -> Scene {
    scene("noodle", (0..48).map(|n| tube(&noodle(n, 0.2))).collect())
}

fn builds(scene: &Scene, deform: &Deform) -> Option<Vec<Build>> {
    let found = bending(("t", scene), &scene.classes(), (deform, None), &Budget::default()).unwrap();
    found.map(|found| found.builds)
}

#[test]
fn what_is_bent_in_several_ways_bends_and_what_is_straight_does_not() {
    assert_eq!(builds(&noodles(), &Deform::Auto), Some(vec![Build::Strand]));
    let sticks = scene("stick", (0..12).map(|n| tube(&noodle(n, 0.0)[..16 - n as usize % 4])).collect());
    assert_eq!(builds(&sticks, &Deform::Auto), None);
    assert_eq!(builds(&sticks, &Deform::All), Some(vec![Build::Strand]));
    assert_eq!(builds(&noodles(), &Deform::Off), None);
}

/// A cushion, bent about z.
fn cushion(curvature: f64) -> TriangleMesh {
    let line: Vec<_> = (0..9).map(|k| Vector([0.25 * f64::from(k) - 1.0, 0.0, 0.0])).collect();
    let mut mesh = tube(&line);
    for p in &mut mesh.positions {
        let (x, y, z) = (p[0], 3.0 * p[1], 12.0 * p[2]);
        let angle = x * curvature;
        *p = if curvature == 0.0 {
            Vector([x, y, z])
        } else {
            Vector([(1.0 / curvature - y) * angle.sin(), 1.0 / curvature - (1.0 / curvature - y) * angle.cos(), z])
        };
    }
    mesh
}

#[test]
fn cushions_bend_and_stones_do_not() {
    let curvature = |n: u32| 0.5 * (1.9 * f64::from(n)).sin();
    let cushions = scene("cushion", (0..12).map(|n| cushion(curvature(n))).collect());
    assert_eq!(builds(&cushions, &Deform::Auto), Some(vec![Build::Bag]));
    let stone = |n: u32| {
        let mut mesh = cushion(0.0);
        for (k, p) in (0_u32..).zip(&mut mesh.positions) {
            *p = *p * (1.0 + 0.15 * (f64::from(k * 7 + n * 13)).sin());
        }
        mesh
    };
    assert_eq!(builds(&scene("stone", (0..12).map(stone).collect()), &Deform::Auto), None);
    let copies = scene("cushion", (0..12).map(|_| cushion(0.3)).collect());
    assert_eq!(builds(&copies, &Deform::Auto), None);
    assert_eq!(builds(&copies, &Deform::Classes(vec!["cushion".into()])), Some(vec![Build::Bag]));
    let unknown = Deform::Classes(vec!["pillow".into()]);
    let error = bending(("t", &copies), &copies.classes(), (&unknown, None), &Budget::default()).unwrap_err();
    assert!(error.to_string().contains("classes of t: cushion"), "{error}");
}

fn run(name: &str, exemplar: &[u8], job: Space) -> crate::Result<Artwork> {
    let prepared = Recipe::new(Input::file(name).embedding(exemplar), job).prepare(&Resources::default())?;
    prepared.run(&prepared.request(), &mut Unobserved)
}

fn encoded(artwork: &Artwork, format: Format) -> Vec<u8> {
    artwork.encode(&OutputOptions { format: Some(format), ..OutputOptions::default() }).unwrap().bytes
}

#[test]
fn noodles_come_back_as_meshes_of_their_own_and_as_long_as_they_were() {
    let bytes = write_scene(&noodles(), None, &Budget::default()).unwrap();
    let artwork = run("noodles.glb", &bytes, Space::new("4x2x2".parse().unwrap())).unwrap();
    let made = read_scene("out.glb", &encoded(&artwork, Format::Glb), &Budget::default()).unwrap();
    assert!(made.nodes.len() > 15, "{}", made.nodes.len());
    assert_eq!((made.meshes.len(), &made.deformable), (made.nodes.len(), &vec!["noodle".to_owned()]));
    let lengths: Vec<f64> = (0..48).map(|n| polyline_length(&noodle(n, 0.2))).collect();
    let (short, long) = lengths.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), l| (a.min(*l), b.max(*l)));
    for mesh in &made.meshes {
        let line = Tube::of(&mesh.mesh, &Budget::default()).unwrap().unwrap();
        assert!(line.length() > 0.98 * short && line.length() < 1.02 * long, "{}", line.length());
    }
    // What was made is an exemplar again.
    assert_eq!(builds(&made, &Deform::Auto), Some(vec![Build::Strand]));
    let text = String::from_utf8(encoded(&artwork, Format::Json)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(json["placements"][0]["points"].as_array().unwrap().len() > 5);
}

#[test]
fn a_scene_as_text_bends_as_well_and_physics_is_refused() {
    let text = obj::write_scene(&noodles(), None, None, &Budget::default()).unwrap().obj;
    let artwork = run("noodles.obj", text.as_bytes(), Space::new("4x2x2".parse().unwrap())).unwrap();
    assert!(artwork.summary().elements > 15);
    let job = Space { physics: Some(crate::Physics::Settle), ..Space::new("4x2x2".parse().unwrap()) };
    let error = run("noodles.obj", text.as_bytes(), job).unwrap_err().to_string();
    assert!(error.contains("physics") && error.contains("--deform=off"), "{error}");
}
