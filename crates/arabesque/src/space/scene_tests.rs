//! Scenes of cubes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use arabesque_core::{Budget, PointSet, Similarity, TriangleMesh, Unobserved, Vector};
use arabesque_io::mesh::gltf::{Scene, SceneMesh, SceneNode, read_scene, write_scene};

use crate::{
    Artwork, Constraint, FieldFile, FieldSource, Fill, Format, Input, Method, OutputOptions, Recipe, Resources, Space,
    Unit, Up,
};

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

fn bytes(artwork: &Artwork, output: OutputOptions) -> Vec<u8> {
    artwork.encode(&output).unwrap().bytes
}

fn as_format(artwork: &Artwork, format: Format) -> String {
    String::from_utf8(bytes(artwork, OutputOptions { format: Some(format), ..OutputOptions::default() })).unwrap()
}

/// A block as an OBJ file, from one corner to the other.
fn block(from: [f64; 3], to: [f64; 3]) -> String {
    let corner = |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { to[a] } else { from[a] });
    let corners = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let quads = [[1, 5, 7, 3], [2, 4, 8, 6], [1, 2, 6, 5], [3, 7, 8, 4], [1, 3, 4, 2], [5, 6, 8, 7]];
    let faces = quads.iter().map(|q| format!("f {} {} {} {}\n", q[0], q[1], q[2], q[3]));
    corners.chain(faces).collect()
}

fn file(name: &str, text: &str) -> Input {
    Input::file(name).embedding(text.as_bytes())
}

fn centres(artwork: &Artwork) -> Vec<Vector<3>> {
    scene(artwork).nodes.iter().map(|node| node.transform.translation).collect()
}

#[test]
fn a_tube_follows_its_curve() {
    let curve = "v 0 0 0\nv 6 0 0\nv 6 0 9\nl 1 2 3\n";
    let job = Space { tube: Some(1.6), ..Space::along(file("curve.obj", curve)) };
    let made = centres(&run(&encoded(&cubes(48)), job).unwrap());
    assert!(made.len() > 20, "{}", made.len());
    for p in &made {
        let [x, y, z] = p.0;
        let to_first = (x - x.clamp(0.0, 6.0)).hypot(y).hypot(z);
        let to_second = (x - 6.0).hypot(y).hypot(z - z.clamp(0.0, 9.0));
        assert!(to_first.min(to_second) < 1.61, "{p:?}");
    }
}

#[test]
fn what_is_avoided_stays_empty() {
    let job = Space {
        avoid: vec![file("hole.obj", &block([2.0, 1.0, 2.0], [5.0, 4.0, 5.0]))],
        ..Space::new("7x5x7".parse().unwrap())
    };
    let made = centres(&run(&encoded(&cubes(48)), job).unwrap());
    assert!(made.len() > 20, "{}", made.len());
    for p in &made {
        // Corners of a cube stick out by half of its side.
        let beside =
            (0..3).map(|k| (p[k] - [2.0, 1.0, 2.0][k]).min([5.0, 4.0, 5.0][k] - p[k])).fold(f64::MAX, f64::min);
        assert!(beside < -0.3, "{p:?}");
    }
}

#[test]
fn tables_say_how_dense_it_is_and_strokes_which_way_it_goes() {
    let table = "0,2,3,1\n8,2,3,0.2\n";
    let density = Some(FieldSource::File(FieldFile { range: None, file: file("density.csv", table) }));
    let made = centres(&run(&encoded(&cubes(48)), Space { density, ..Space::new("8x4x6".parse().unwrap()) }).unwrap());
    let left = made.iter().filter(|p| p[0] < 4.0).count();
    assert!(2 * left > 3 * (made.len() - left), "{left} of {}", made.len());
    let stroke = "v 0 0 0\nv 0 0 9\nl 1 2\n";
    let orient = Some(FieldSource::File(FieldFile { range: None, file: file("way.obj", stroke) }));
    let made = scene(&run(&encoded(&cubes(48)), Space { orient, ..Space::new("6x4x6".parse().unwrap()) }).unwrap());
    let turned = |node: &SceneNode| node.transform.rotation.apply(Vector([1.0, 0.0, 0.0]))[2] > 0.9;
    assert!(made.nodes.iter().all(turned));
}

#[test]
fn rules_say_what_stands_on_the_floor_and_z_may_be_up() {
    // Cubes that stand in z.
    let standing = Scene { nodes: cubes(12).nodes, ..cubes(48) };
    let with = |constrain: &[(&str, Constraint)]| Space {
        up: Up::Z,
        unit: Unit::Centimetre,
        constrain: constrain.iter().map(|(class, rule)| ((*class).to_owned(), *rule)).collect(),
        ..Space::new("6x6x4".parse().unwrap())
    };
    let unknown = run(&encoded(&standing), with(&[("cone", Constraint::Floor)])).unwrap_err().to_string();
    assert!(unknown.contains("a class of the exemplar: cube"), "{unknown}");
    let artwork = run(&encoded(&standing), with(&[("cube", Constraint::Floor)])).unwrap();
    let heights: Vec<f64> =
        as_format(&artwork, Format::Csv).lines().filter_map(|line| line.split(',').nth(2)?.parse().ok()).collect();
    assert!(!heights.is_empty() && heights.iter().all(|z| (0.4..0.7).contains(z)), "{heights:?}");
    // GLB has y up and metres.
    assert!(centres(&artwork).iter().all(|p| (0.004..0.007).contains(&p[1])));
    assert!(as_format(&artwork, Format::Usda).contains("upAxis = \"Z\""));
}

#[test]
fn scenes_come_in_and_go_out_in_many_formats() {
    let artwork = run(&encoded(&cubes(48)), Space::new("6x4x6".parse().unwrap())).unwrap();
    let count = scene(&artwork).nodes.len();
    let obj = as_format(&artwork, Format::Obj);
    assert_eq!(obj.lines().filter(|line| line.starts_with("o cube.")).count(), count);
    let usda = as_format(&artwork, Format::Usda);
    assert!(usda.starts_with("#usda 1.0") && usda.contains("PointInstancer"));
    let json: serde_json::Value = serde_json::from_str(&as_format(&artwork, Format::Json)).unwrap();
    assert_eq!(json["placements"].as_array().unwrap().len(), count);
    let centres = OutputOptions { format: Some(Format::Ply), centres: true, ..OutputOptions::default() };
    let ply = String::from_utf8(bytes(&artwork, centres)).unwrap();
    assert!(ply.contains(&format!("element vertex {count}")));
    let instanced = OutputOptions { format: Some(Format::Glb), instancing: true, ..OutputOptions::default() };
    let glb = bytes(&artwork, instanced);
    assert!(String::from_utf8_lossy(&glb).contains("EXT_mesh_gpu_instancing"));
    assert_eq!(read_scene("i.glb", &glb, &Budget::default()).unwrap().nodes.len(), count);
    for (name, text) in [("a.usda", &usda), ("a.obj", &obj)] {
        let again = crate::recipe_in(name, text.as_bytes()).unwrap();
        assert!(matches!(again.job, crate::Job::Space(_)), "{name}");
    }
    // What was written as OBJ is an exemplar again.
    let recipe = Recipe::new(file("out.obj", &obj), Space::new("5x3x5".parse().unwrap()));
    let prepared = recipe.prepare(&Resources::default()).unwrap();
    let made = prepared.run(&prepared.request(), &mut Unobserved).unwrap();
    assert!(made.summary().elements > 20, "{}", made.summary().elements);
}

/// Cubes in a loose heap of four layers.
fn heap() -> Scene {
    let mut scene = cubes(64);
    for (k, node) in (0_u32..).zip(&mut scene.nodes) {
        let off = |n: u32| f64::from((k * 37 + n * 11) % 7) * 0.04 - 0.12;
        let layer = k / 16;
        let height = 0.5 + 1.1 * f64::from(layer) + if layer == 0 { 0.0 } else { 0.3 * off(1).abs() };
        let [x, z] = [k % 4, k / 4 % 4].map(|n| 1.25 * f64::from(n) + 0.3 * f64::from(layer % 2));
        node.transform = Similarity::shift(Vector([x + off(0), height, z + off(2)]));
    }
    scene
}

#[test]
fn a_heap_stands_on_the_floor_and_nothing_lies_below_it() {
    for seed in 0..3 {
        let job = Space { floor: true, ..Space::new("8x4.4x8".parse().unwrap()) };
        let recipe = Recipe { seed, ..Recipe::new(Input::file("heap.glb").embedding(&encoded(&heap())), job) };
        let prepared = recipe.prepare(&Resources::default()).unwrap();
        let made = scene(&prepared.run(&prepared.request(), &mut Unobserved).unwrap());
        let lowest: Vec<f64> = made.nodes.iter().map(|node| node.transform.translation[1] - 0.5).collect();
        let standing = lowest.iter().filter(|low| low.abs() < 0.01).count();
        // 16 stand on some 4.9 x 4.9 in the exemplar.
        assert!(standing >= 26, "{standing} of {}", lowest.len());
        assert!(lowest.iter().all(|low| *low > -0.05), "{lowest:?}");
    }
}
