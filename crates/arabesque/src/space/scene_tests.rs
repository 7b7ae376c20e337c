//! Scenes of cubes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use arabesque_core::{Budget, PointSet, Similarity, TriangleMesh, Unobserved, Vector};
use arabesque_io::mesh::gltf::{Scene, SceneMesh, SceneNode, read_scene, write_scene};

use crate::{Artwork, Fill, Format, Input, Method, OutputOptions, Recipe, Resources, Space};

fn cube(at: Vector<3>) -> TriangleMesh {
    let corner = |k: u32| Vector([0, 1, 2].map(|a| f64::from(k >> a & 1) - 0.5)) + at;
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    TriangleMesh { positions: (0..8).map(corner).collect(), triangles, ..TriangleMesh::default() }
}

fn place(k: u32) -> Vector<3> {
    Vector([k % 4, k / 4 % 3, k / 12].map(|n| 1.3 * f64::from(n) + 0.6)) + Vector::splat(0.03 * f64::from(k % 3))
}

fn encoded(scene: &Scene) -> Vec<u8> {
    write_scene(scene, None, &Budget::default()).unwrap()
}

fn cubes(count: u32) -> Scene {
    let node = |k: u32| SceneNode {
        name: format!("cube.{k:03}"),
        mesh: 0,
        transform: Similarity::shift(place(k)),
        ..SceneNode::default()
    };
    let meshes = vec![SceneMesh::new("cube", cube(Vector::ZERO))];
    Scene { meshes, nodes: (0..count).map(node).collect(), ..Scene::of_points(PointSet::default()) }
}

fn run(exemplar: &[u8], job: Space) -> crate::Result<Artwork> {
    let recipe = Recipe::new(Input::file("cubes.glb").embedding(exemplar), job);
    let prepared = recipe.prepare(&Resources::default())?;
    prepared.run(&prepared.request(), &mut Unobserved)
}

fn scene(artwork: &Artwork) -> Scene {
    let output = OutputOptions { format: Some(Format::Glb), ..OutputOptions::default() };
    read_scene("out.glb", &artwork.encode(&output).unwrap().bytes, &Budget::default()).unwrap()
}

#[test]
fn nodes_that_differ_in_number_are_one_class_and_share_their_mesh() {
    let made = scene(&run(&encoded(&cubes(48)), Space::new("7x4x6".parse().unwrap())).unwrap());
    assert_eq!((made.meshes.len(), made.classes().names), (1, vec!["cube".to_owned()]));
    // 48 in about 5 x 3.7 x 5.
    assert!((60..115).contains(&made.nodes.len()), "{}", made.nodes.len());
}

#[test]
fn a_mesh_that_is_a_whole_scene_is_split() {
    let mut joined = TriangleMesh::default();
    for k in 0..48 {
        let first = joined.positions.len() as u32;
        let one = cube(place(k));
        joined.positions.extend(one.positions);
        joined.triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let made = scene(&run(&encoded(&Scene::of_mesh("heap", &joined)), Space::new("6x4x6".parse().unwrap())).unwrap());
    assert!(made.nodes.len() > 40 && made.meshes.len() == 1, "{} {}", made.nodes.len(), made.meshes.len());
}

#[test]
fn kept_elements_stay_where_they_are_and_others_are_refused() {
    let all = encoded(&cubes(48));
    let some = Scene { nodes: cubes(48).nodes[..5].to_vec(), ..cubes(48) };
    let keep = Some(Input::file("some.glb").embedding(&encoded(&some)));
    let made = scene(&run(&all, Space { keep, ..Space::new("6x4x6".parse().unwrap()) }).unwrap());
    for node in &some.nodes {
        let nearest = made.nodes.iter().map(|n| (n.transform.translation - node.transform.translation).norm());
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-6, "{}", node.name);
    }
    let other = Scene { meshes: vec![SceneMesh::new("cube", cube(Vector::splat(0.1)))], ..some };
    let keep = Some(Input::file("other.glb").embedding(&encoded(&other)));
    let refused = run(&all, Space { keep, ..Space::new("6x4x6".parse().unwrap()) }).unwrap_err();
    assert!(refused.to_string().contains("none of the exemplar"), "{refused}");
}

#[test]
fn a_scene_is_no_drawing() {
    let job = Fill { method: Method::Elements, size: Some("5x5".parse().unwrap()), ..Fill::default() };
    let recipe = Recipe::new(Input::file("cubes.glb").embedding(&encoded(&cubes(12))), job);
    let refused = recipe.prepare(&Resources::default()).unwrap_err();
    assert!(refused.to_string().contains("a scene in space"), "{refused}");
}
