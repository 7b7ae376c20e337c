//! Nodes of a glTF file that belong together, read, written and changed.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use arabesque_core::{Budget, Similarity, TriangleMesh, Vector};
use arabesque_io::{
    mesh::{
        gltf::{
            GlbElements, GltfOptions, Scene, SceneMesh, SceneNode, as_text, read_scene, recipe_of, write_scene_with,
        },
        obj,
    },
    placed::{Changes, Paint, PlacedFile, Replaced},
};
use serde_json::{Value, json};

/// A tetrahedron of this size.
fn wedge(size: f64) -> TriangleMesh {
    TriangleMesh {
        positions: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|p| Vector(p) * size)
            .to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        ..TriangleMesh::default()
    }
}

/// A file with these meshes, as text, and with these nodes, of which `roots` are shown.
fn file(sizes: &[f64], nodes: &Value, roots: &[usize]) -> Vec<u8> {
    let mesh = |(k, size): (usize, &f64)| {
        // Other triangles make other shapes of the same corners.
        let mut mesh = wedge(*size);
        mesh.positions[3][0] += 0.1 * k as f64;
        SceneMesh::new(format!("mesh{k}"), mesh)
    };
    let scene = Scene {
        meshes: sizes.iter().enumerate().map(mesh).collect(),
        nodes: (0..sizes.len()).map(|k| SceneNode::new("n", k, Similarity::identity())).collect(),
        ..Scene::default()
    };
    let glb = write_scene_with(&scene, &GltfOptions::default(), &Budget::default()).unwrap();
    let mut document: Value = serde_json::from_slice(&as_text(&glb, &Budget::default()).unwrap()).unwrap();
    document["nodes"] = nodes.clone();
    document["scenes"][0]["nodes"] = json!(roots);
    serde_json::to_vec(&document).unwrap()
}

fn read(bytes: &[u8]) -> Scene {
    read_scene("t.gltf", bytes, &Budget::default()).unwrap()
}

/// `count` trees below a root and a collection: the crown beside the trunk, or as its child.
fn trees(count: usize, crown_below: bool, named: bool) -> Vec<u8> {
    let mut nodes = vec![json!({ "name": "root", "children": [1] }), Value::Null];
    let mut tops = Vec::new();
    for k in 0..count {
        let at = nodes.len();
        let name = |what: &str| if named { format!("{what}.{k:03}") } else { format!("Object_{}", at + what.len()) };
        let place = json!([10.0 * k as f64, 0.0, 3.0]);
        tops.push(at);
        let crown = json!({ "name": name("crown"), "mesh": 1, "translation": [0.0, 1.0, 0.0] });
        if crown_below {
            nodes.push(json!({ "name": name("tree"), "mesh": 0, "translation": place, "children": [at + 1] }));
            nodes.push(crown);
        } else {
            let children = [at + 1, at + 2];
            nodes.push(json!({ "name": name("tree"), "translation": place, "scale": [2, 2, 2], "children": children }));
            nodes.push(json!({ "name": name("trunk"), "mesh": 0 }));
            nodes.push(crown);
        }
    }
    nodes[1] = json!({ "name": "Collection", "children": tops });
    file(&[1.0, 0.8], &json!(nodes), &[0])
}

#[test]
fn groups_that_come_again_are_elements_of_several_meshes() {
    for (crown_below, named) in [(false, true), (true, true), (false, false), (true, false)] {
        let scene = read(&trees(4, crown_below, named));
        assert_eq!(scene.nodes.len(), 4, "{crown_below} {named}");
        let shown: Vec<_> = scene.nodes.iter().map(|n| n.mesh).collect();
        assert!(shown.iter().all(|mesh| *mesh == shown[0]), "copies share a mesh");
        let mesh = &scene.meshes[shown[0]];
        assert_eq!((mesh.parts.len(), mesh.mesh.positions.len(), mesh.mesh.triangles.len()), (2, 8, 8));
        let scale = if crown_below { 1.0 } else { 2.0 };
        let top = scene.nodes[2].transform.apply(mesh.mesh.positions[4]);
        assert!((top - Vector([20.0, scale, 3.0])).norm() < 1e-6, "{top:?}");
        let class = &scene.classes().names;
        assert_eq!(class, &[if named { "tree" } else { "Object" }]);
    }
}

#[test]
fn collections_and_rows_are_no_elements() {
    let item = |mesh: usize, x: f64| json!({ "name": "thing", "mesh": mesh, "translation": [x, 0.0, 0.0] });
    let below = |from: usize, count: usize| (from..from + count).collect::<Vec<_>>();
    // Two collections of the same things in other places.
    let mut nodes = vec![json!({ "name": "Collection 1", "children": below(2, 4) })];
    nodes.push(json!({ "name": "Collection 2", "children": below(6, 4) }));
    nodes.extend((0..8).map(|k| item(k % 2, f64::from(k as u32).powi(2))));
    assert_eq!(read(&file(&[1.0, 0.8], &json!(nodes), &[0, 1])).nodes.len(), 8);
    // Two rows of many bricks that nearly touch.
    let mut nodes = vec![json!({ "name": "row.001", "children": below(2, 9) })];
    nodes.push(json!({ "name": "row.002", "children": below(11, 9), "translation": [0.0, 1.0, 0.0] }));
    nodes.extend((0..18).map(|k| item(0, 1.02 * f64::from(k % 9))));
    assert_eq!(read(&file(&[1.0], &json!(nodes), &[0, 1])).nodes.len(), 18);
    // Two collections of trees: the trees are the elements.
    let mut nodes = vec![json!({ "children": [2, 5, 8] }), json!({ "children": [11, 14, 17] })];
    for k in 0..6 {
        let at = nodes.len();
        nodes.push(json!({ "name": "tree", "children": [at + 1, at + 2], "translation": [9.0 * f64::from(k % 3), f64::from(k / 3), 0.0] }));
        nodes.extend([item(0, 0.0), item(1, 0.5)]);
    }
    assert_eq!(read(&file(&[1.0, 0.8], &json!(nodes), &[0, 1])).nodes.len(), 6);
}

#[test]
fn names_alike_and_what_the_file_says_make_elements_too() {
    // Each with meshes of its own, which hang together.
    let mut nodes = Vec::new();
    for k in 0..3 {
        let at = nodes.len();
        nodes.push(json!({ "name": format!("man.{k}"), "children": [at + 1, at + 2], "translation": [9.0 * f64::from(k), 0.0, 0.0] }));
        nodes.push(json!({ "name": format!("body.{k}"), "mesh": 2 * k }));
        nodes.push(json!({ "name": format!("head.{k}"), "mesh": 2 * k + 1, "translation": [0.0, 0.9, 0.0] }));
    }
    let sizes = [1.0, 0.5, 1.1, 0.6, 1.2, 0.4];
    let scene = read(&file(&sizes, &json!(nodes), &[0, 3, 6]));
    assert_eq!((scene.nodes.len(), scene.classes().names), (3, vec!["man".to_owned()]));
    let said = json!([{ "name": "one", "children": [1, 2], "extras": { "element": true, "class": "gem" } },
        { "mesh": 0 }, { "mesh": 1, "translation": [50.0, 0.0, 0.0] }]);
    let scene = read(&file(&[1.0, 2.0], &said, &[0]));
    assert_eq!((scene.nodes.len(), scene.nodes[0].class.as_deref()), (1, Some("gem")));
}

fn glb(scene: &Scene, instancing: bool) -> Vec<u8> {
    let options = GltfOptions { recipe: Some("seed = 1\n"), instancing };
    write_scene_with(scene, &options, &Budget::default()).unwrap()
}

#[test]
fn they_are_written_as_nodes_with_children_and_come_back() {
    let scene = read(&trees(3, false, true));
    let bytes = glb(&scene, false);
    let back = read(&bytes);
    assert_eq!(back.nodes.len(), 3);
    assert_eq!(back.meshes[back.nodes[0].mesh].parts.len(), 2);
    let near = |k: usize, v: usize| {
        let at = |s: &Scene| s.nodes[k].transform.apply(s.meshes[s.nodes[k].mesh].mesh.positions[v]);
        (at(&scene) - at(&back)).norm() < 1e-5
    };
    assert!((0..24).all(|n| near(n / 8, n % 8)));
    // One alone is one still, and as one mesh with instances.
    let one = Scene { nodes: scene.nodes[..1].to_vec(), ..scene.clone() };
    assert_eq!(read(&glb(&one, false)).nodes.len(), 1);
    let together = read(&glb(&scene, true));
    assert_eq!((together.nodes.len(), together.meshes.len()), (3, 1));
    assert!(together.meshes[0].parts.is_empty() && together.meshes[0].mesh.triangles.len() == 8);
    let text = obj::write_scene(&scene, None, None, &Budget::default()).unwrap().obj;
    assert_eq!(text.lines().filter(|line| line.starts_with("o ")).count(), 3);
    // The same as text, in one file.
    let text = as_text(&bytes, &Budget::default()).unwrap();
    assert_eq!((read(&text), recipe_of(&text)), (back, Some("seed = 1\n".into())));
}

#[test]
fn they_are_moved_painted_removed_and_copied_as_one() {
    let bytes = glb(&read(&trees(3, false, true)), false);
    let open = |bytes: &[u8]| GlbElements::open("r.glb", bytes, &Budget::default()).unwrap();
    let apply = |bytes: &[u8], changes: &Changes<3>| open(bytes).rewritten(changes, None, &Budget::default()).unwrap();
    assert_eq!(open(&bytes).layout().items.len(), 3);
    assert_eq!(apply(&bytes, &Changes::default()), bytes);
    let motion = Similarity::shift(Vector([0.0, 0.0, 7.0]));
    let replaced = |base, motion: Similarity<3>, paint: &[Paint]| Replaced { base, motion, paint: paint.to_vec() };
    let there = apply(&bytes, &Changes { replaced: [(1, replaced(1, motion, &[]))].into(), ..Changes::default() });
    assert!((read(&there).nodes[1].transform.translation - Vector([10.0, 0.0, 10.0])).norm() < 1e-6);
    let back = replaced(1, motion.inverse(), &[]);
    assert_eq!(apply(&there, &Changes { replaced: [(1, back)].into(), ..Changes::default() }), bytes);
    let red = Paint { property: "fill".into(), value: "#ff0000".into() };
    let changes = Changes {
        replaced: [(2, replaced(2, Similarity::identity(), &[red]))].into(),
        removed: [0].into(),
        inserted: vec![(3, replaced(1, motion, &[]))],
    };
    let scene = read(&apply(&bytes, &changes));
    assert_eq!(scene.nodes.len(), 3);
    let parts = |k: usize| &scene.meshes[scene.nodes[k].mesh].parts;
    assert!((0..3).all(|k| parts(k).len() == 2));
    let colour = |k: usize, part: usize| scene.meshes[parts(k)[part].mesh].mesh.colours.as_ref().map(|list| list[0]);
    assert_eq!([colour(1, 0), colour(1, 1)], [Some([1.0, 0.0, 0.0]); 2]);
    assert_ne!(colour(0, 0), colour(1, 0));
    assert!((scene.nodes[2].transform.translation - Vector([10.0, 0.0, 10.0])).norm() < 1e-6);
}
