use arabesque_core::{Budget, Error, Limits, Matrix, MeshPart, PointSet, Similarity, TriangleMesh, Vector};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{Scene, SceneMesh, SceneNode, container::container, read_scene, recipe_of, write_scene};
use crate::geometry::Cloud;

/// One triangle: three corners as floats, then the numbers 0, 1, 2 as bytes.
fn triangle() -> Vec<u8> {
    let corners = [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    corners.iter().flatten().flat_map(|c| c.to_le_bytes()).chain([0, 1, 2, 0]).collect()
}

/// A file of that triangle with other `nodes`; `more` replaces further entries of the document.
fn file(nodes: Value, more: Value) -> Vec<u8> {
    let mut document = json!({
        "asset": { "version": "2.0" },
        "nodes": nodes,
        "meshes": [{ "name": "sail", "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 3 },
        ],
        "buffers": [{ "byteLength": 40 }],
    });
    for (key, value) in more.as_object().unwrap() {
        document[key] = value.clone();
    }
    container(&document, &triangle(), "").unwrap()
}

fn read(nodes: Value, more: Value) -> arabesque_core::Result<Scene> {
    read_scene("a.glb", &file(nodes, more), &Budget::default())
}

fn corner(scene: &Scene, node: usize, vertex: usize) -> Vector<3> {
    let node = &scene.nodes[node];
    node.transform.apply(scene.meshes[node.mesh].mesh.positions[vertex])
}

#[test]
fn nodes_that_share_a_mesh_share_it_here() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        { "name": "left", "mesh": 0, "translation": [1, 0, 0] },
        { "name": "group", "children": [0, 2], "scale": [2, 2, 2] },
        { "mesh": 0, "rotation": [0, 0, half, half] },
    ]);
    let scene = read(nodes, json!({})).unwrap();
    assert_eq!((scene.meshes.len(), scene.nodes.len()), (1, 2));
    assert_eq!((scene.nodes[0].name.as_str(), scene.nodes[1].name.as_str()), ("left", "sail"));
    assert_eq!(corner(&scene, 0, 1), Vector([6.0, 0.0, 0.0]));
    assert!((corner(&scene, 1, 1) - Vector([0.0, 4.0, 0.0])).norm() < 1e-12);
    assert_eq!(scene.triangles(), 2);
}

#[test]
fn stretched_and_mirrored_meshes_are_meshes_of_their_own() {
    let nodes = json!([
        { "mesh": 0 },
        { "mesh": 0, "scale": [1, 3, 1] },
        { "mesh": 0, "scale": [1, 3, 1], "translation": [0, 0, 5] },
        { "mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1] },
    ]);
    let scene = read(nodes, json!({})).unwrap();
    assert_eq!(scene.nodes.iter().map(|n| n.mesh).collect::<Vec<_>>(), [0, 1, 1, 2]);
    let close = |a: Vector<3>, b: [f64; 3]| assert!((a - Vector(b)).norm() < 1e-9, "{a:?} for {b:?}");
    close(corner(&scene, 2, 2), [0.0, 3.0, 5.0]);
    close(corner(&scene, 3, 1), [5.0, 0.0, 0.0]);
    // What is mirrored goes on facing outwards.
    close(scene.meshes[2].mesh.double_area(0), [0.0, 0.0, 2.0]);
    assert!(scene.warnings[0].message.contains("2 nodes stretch what they show along one direction, and 1 mirror it"));
}

#[test]
fn instances_of_the_extension_are_places() {
    let nodes = json!([{ "mesh": 0, "translation": [0, 0, 1],
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0 } } } }]);
    let scene = read(nodes, json!({ "extensionsRequired": ["EXT_mesh_gpu_instancing"] })).unwrap();
    assert_eq!((scene.meshes.len(), scene.nodes.len()), (1, 3));
    assert_eq!(corner(&scene, 1, 2), Vector([2.0, 1.0, 1.0]));
}

#[test]
fn one_mesh_is_made_of_all_nodes() {
    let nodes = json!([{ "name": "a", "mesh": 0 }, { "name": "b", "mesh": 0, "translation": [0, 1, 0] }]);
    let geometry = read(nodes, json!({})).unwrap().into_geometry("a.glb");
    // The corner where the two touch is one vertex.
    assert_eq!((geometry.points.len(), geometry.triangles.clone()), (5, vec![[0, 1, 2], [2, 3, 4]]));
    let part = |name: &str, triangles| MeshPart { name: name.into(), triangles };
    assert_eq!(geometry.parts, [part("a", 0..1), part("b", 1..2)]);
}

#[test]
fn strips_fans_and_materials_are_understood() {
    let meshes =
        |mode: u32| json!([{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": mode, "material": 0 }] }]);
    let materials = json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0.214, 1] } }]);
    for mode in [4, 5, 6] {
        let scene = read(json!([{ "mesh": 0 }]), json!({ "meshes": meshes(mode), "materials": materials })).unwrap();
        assert_eq!(scene.meshes[0].mesh.triangles, [[0, 1, 2]]);
        let colour = scene.meshes[0].mesh.colours.as_ref().unwrap()[0];
        assert!(colour[0] == 1.0 && (colour[2] - 0.5).abs() < 1e-3, "{colour:?}");
    }
    let textured =
        json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "baseColorFactor": [1, 1, 1, 1] } }]);
    let more = json!({ "meshes": meshes(4), "materials": textured, "textures": [{}] });
    let scene = read(json!([{ "mesh": 0 }]), more).unwrap();
    assert!(scene.meshes[0].mesh.colours.is_none() && scene.warnings.is_empty());
    let told = scene.into_geometry("a.glb").warnings;
    assert!(told[0].message.contains("pictures on 1 materials are passed over"), "{told:?}");
    let lines = read(json!([{ "mesh": 0 }]), json!({ "meshes": meshes(1) })).unwrap_err().to_string();
    assert!(lines.contains("no mesh and no points"), "{lines}");
}

#[test]
fn broken_files_say_where_and_what() {
    let meshes = |primitive: Value| json!({ "meshes": [{ "primitives": [primitive] }] });
    let mesh = json!([{ "mesh": 0 }]);
    for (nodes, more, expected) in [
        (json!([{ "mesh": 4 }]), json!({}), "node 0: its mesh 4 does not exist"),
        (json!([{ "children": [1] }, { "children": [0] }]), json!({ "scenes": [{ "nodes": [0] }] }), "below itself"),
        (json!([{ "children": [7] }]), json!({}), "node 7: it does not exist; there are 1"),
        (json!([{ "mesh": 0, "scale": [1e200, 1e200, 1e200] }]), json!({}), "a vertex at"),
        (json!([{ "mesh": 0, "matrix": [1, 2] }]), json!({}), "its JSON: invalid length"),
        (json!({ "mesh": 0 }), json!({}), "its JSON: invalid type: map"),
        (mesh.clone(), meshes(json!({ "attributes": {} })), "mesh 0: a primitive without POSITION"),
        (mesh.clone(), meshes(json!({ "attributes": { "POSITION": 9 } })), "accessor 9: there are 2"),
        (mesh.clone(), meshes(json!({ "attributes": { "POSITION": 1 } })), "its type is SCALAR, expected 3"),
        (
            mesh.clone(),
            json!({ "buffers": [{ "uri": "a.bin" }] }),
            "buffer 0: a.bin: a file beside one whose folder is not known",
        ),
        (mesh.clone(), json!({ "extensionsRequired": ["KHR_draco_mesh_compression"] }), "KHR_draco_mesh_compression"),
        (json!([]), json!({}), "no mesh and no points in its scene"),
    ] {
        let message = read(nodes, more).unwrap_err().to_string();
        assert!(message.contains(expected) && message.len() < 400, "{expected}: {message}");
    }
    let far = json!([{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
        { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR", "normalized": false }]);
    let mut bytes = file(mesh, json!({ "accessors": far }));
    let last = bytes.len() - 2;
    bytes[last] = 3;
    let message = read_scene("a.glb", &bytes, &Budget::default()).unwrap_err().to_string();
    assert!(message.contains("mesh 0: vertex 3 where there are 3"), "{message}");
}

#[test]
fn files_that_are_cut_off_are_refused() {
    let whole = file(json!([{ "mesh": 0 }]), json!({}));
    for end in 0..whole.len() {
        assert!(matches!(read_scene("a", &whole[..end], &Budget::default()), Err(Error::Input { .. })), "{end}");
    }
    let mut other = whole.clone();
    other[4] = 1;
    assert!(read_scene("a", &other, &Budget::default()).unwrap_err().to_string().contains("version 1"));
}

#[test]
fn limits_hold_for_what_few_bytes_stand_for() {
    let nodes: Vec<Value> = (0..100).map(|_| json!({ "mesh": 0 })).collect();
    let bytes = file(Value::Array(nodes), json!({}));
    for limits in [
        Limits { nodes: 200, ..Limits::default() },
        Limits { work: 0, ..Limits::default() },
        Limits { memory: 1000, ..Limits::default() },
    ] {
        let read = read_scene("a", &bytes, &Budget::new(limits));
        assert!(matches!(read, Err(Error::Limit { .. })), "{limits:?}");
    }
    let chain: Vec<Value> = (0..50).map(|k| json!({ "children": [k + 1] })).chain([json!({ "mesh": 0 })]).collect();
    let bytes = file(Value::Array(chain), json!({}));
    let shallow = Budget::new(Limits { depth: 20, ..Limits::default() });
    assert!(read_scene("a", &bytes, &shallow).unwrap_err().to_string().contains("depth of nodes"));
    assert!(read_scene("a", &bytes, &Budget::default()).is_ok());
}

#[test]
fn parts_are_nodes_with_the_vertices_they_need() {
    let positions = (0..6).map(|k| Vector([f64::from(k), f64::from(k * k), 0.0])).collect();
    let mesh = TriangleMesh {
        positions,
        triangles: vec![[0, 1, 2], [3, 4, 5], [5, 4, 1]],
        parts: vec![MeshPart { name: "b".into(), triangles: 1..2 }],
        ..TriangleMesh::default()
    };
    let scene = Scene::of_mesh("whole", &mesh);
    let names: Vec<_> = scene.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["whole", "b", "whole"]);
    assert_eq!(scene.meshes[1].mesh.positions, mesh.positions[3..]);
    assert_eq!(scene.meshes[2].mesh.triangles, [[0, 1, 2]]);
}

fn eighths() -> impl Strategy<Value = Vector<3>> {
    prop::array::uniform3((-800..800_i32).prop_map(|v| f64::from(v) / 8.0)).prop_map(Vector)
}

proptest! {
    #[test]
    fn places_come_back(angles in prop::array::uniform3(-3.2..3.2_f64), scale in 0.01..50.0_f64, to in eighths()) {
        let plane = |axis: usize, angle: f64| {
            let mut m = Matrix::<3>::identity();
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            (m.0[a][a], m.0[a][b], m.0[b][a], m.0[b][b]) = (angle.cos(), -angle.sin(), angle.sin(), angle.cos());
            m
        };
        let rotation = plane(0, angles[0]).compose(&plane(1, angles[1])).compose(&plane(2, angles[2]));
        let transform = Similarity { rotation, scale, translation: to };
        let mut scene = read(json!([{ "mesh": 0 }]), json!({})).unwrap();
        scene.nodes = vec![SceneNode::new("sail", 0, transform)];
        let bytes = write_scene(&scene, Some("seed = 1\n"), &Budget::default()).unwrap();
        prop_assert_eq!(recipe_of(&bytes), Some("seed = 1\n".to_owned()));
        let back = read_scene("a.glb", &bytes, &Budget::default()).unwrap();
        for vertex in 0..3 {
            let off = (corner(&back, 0, vertex) - corner(&scene, 0, vertex)).norm();
            prop_assert!(off < 1e-6 * (1.0 + scale), "{}", off);
        }
    }

    #[test]
    fn points_and_meshes_come_back(
        list in prop::collection::vec((eighths(), any::<[u8; 3]>(), -9..9_i32), 3..20),
        has: [bool; 6],
    ) {
        let colours: Vec<[f64; 3]> = list.iter().map(|p| p.1.map(|c| f64::from(c) / 255.0)).collect();
        let normal = |k: i32| Vector(std::array::from_fn(|axis| f64::from(u8::from(k.rem_euclid(3) as usize == axis))));
        let points = PointSet::<3> {
            positions: list.iter().map(|p| p.0).collect(),
            normals: has[0].then(|| list.iter().map(|p| normal(p.2)).collect()),
            colours: has[1].then(|| colours.clone()),
            radii: has[2].then(|| list.iter().map(|p| f64::from(p.2 + 10) / 8.0).collect()),
            groups: has[3].then(|| list.iter().map(|p| p.2).collect()),
            elements: has[4].then(|| list.iter().map(|p| p.2).collect()),
            classes: has[5].then(|| list.iter().map(|p| p.2 + 1).collect()),
        };
        let mesh = TriangleMesh {
            positions: points.positions.clone(),
            triangles: vec![[0, 1, 2], [2, 1, list.len() as u32 - 1]].into_iter().filter(|t| t[0] != t[2]).collect(),
            normals: points.normals.clone(),
            colours: points.colours.clone(),
            parts: Vec::new(),
        };
        let scene = Scene {
            points,
            meshes: vec![SceneMesh::new("m", mesh)],
            nodes: vec![SceneNode::new("n", 0, Similarity::identity())],
            ..Scene::default()
        };
        let mut back = read_scene("a", &write_scene(&scene, None, &Budget::default()).unwrap(), &Budget::default()).unwrap();
        let near = |a: &Option<Vec<[f64; 3]>>, b: &Option<Vec<[f64; 3]>>| {
            let pairs = a.iter().flatten().flatten().zip(b.iter().flatten().flatten());
            a.as_ref().map(Vec::len) == b.as_ref().map(Vec::len) && pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-4)
        };
        prop_assert!(near(&back.points.colours, &scene.points.colours));
        back.points.colours.clone_from(&scene.points.colours);
        back.meshes[0].mesh.colours.clone_from(&scene.meshes[0].mesh.colours);
        // What a file says of how things look beyond that is nothing but a material that is plain.
        prop_assert_eq!(std::mem::take(&mut back.looks).materials.len(), 1);
        back.meshes[0].primitives.clear();
        prop_assert_eq!(back.clone(), scene);
        prop_assert!(matches!(back.into_geometry("a").points, Cloud::Space(_)));
    }
}
