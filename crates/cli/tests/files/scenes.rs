//! Scenes of meshes: formats of one file and of two, elements of several meshes, stacks.

use std::fs;

use serde_json::{Value, json};

use crate::common::{Folder, example};

const FILL: &str = "fill kernels.glb --box 3x3x3 --set iterations=1";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("kernels.glb", fs::read(example("scene-vegetables.glb")).unwrap());
    folder
}

#[test]
fn gltf_is_the_same_as_text_in_one_file_and_repeats_itself() {
    let folder = folder();
    folder.ok(&format!("{FILL} -o a.gltf"));
    let text = folder.text("a.gltf");
    let document: Value = serde_json::from_str(&text).unwrap();
    let uri = document["buffers"][0]["uri"].as_str().unwrap();
    assert!(uri.starts_with("data:application/octet-stream;base64,"), "{}", &uri[..40]);
    folder.ok("run a.gltf -o b.gltf");
    assert!(folder.text("b.gltf") == text);
    // A result is replaced, and is an exemplar itself.
    folder.ok("run b.gltf -o a.gltf");
    let report: Value = serde_json::from_slice(&folder.ok("inspect a.gltf --json").stdout).unwrap();
    assert_eq!(report["kind"], "scene of meshes");
    assert_eq!(report["elements"], document["nodes"].as_array().unwrap().len());
}

#[test]
fn obj_has_its_materials_beside_it_and_both_are_written_or_none() {
    let folder = folder();
    folder.ok(&format!("{FILL} -o a.obj"));
    let (obj, mtl) = (folder.text("a.obj"), folder.text("a.mtl"));
    assert!(obj.contains("\nmtllib a.mtl\n") && obj.contains("\nusemtl "));
    let used = obj.lines().find_map(|l| l.strip_prefix("usemtl ")).unwrap();
    assert!(mtl.contains(&format!("newmtl {used}\n")));
    // Our own are replaced, and those of others are not.
    folder.ok(&format!("{FILL} --seed 1 -o a.obj"));
    folder.write("b.mtl", "newmtl precious\n");
    let message = folder.fails(1, &format!("{FILL} -o b.obj"));
    assert!(message.contains("b.mtl: there is a file already"), "{message}");
    assert!(!folder.path("b.obj").exists());
    assert_eq!(folder.text("b.mtl"), "newmtl precious\n");
    folder.ok(&format!("{FILL} -o b.obj --force"));
    assert!(folder.text("b.mtl").contains("newmtl ") && folder.path("b.obj").exists());
}

/// Cubes in places, each with a smaller one as a child where there are `group`s, beside `cubes.bin`.
fn cubes(places: &[[f64; 3]], group: bool) -> String {
    let mut nodes = Vec::new();
    let mut roots = Vec::new();
    for (k, place) in places.iter().enumerate() {
        roots.push(nodes.len());
        let mut node = json!({ "name": format!("cube.{k:03}"), "mesh": 0, "translation": place });
        if group {
            node["children"] = json!([nodes.len() + 1]);
        }
        nodes.push(node);
        if group {
            nodes.push(json!({ "name": format!("lid.{k:03}"), "mesh": 0, "translation": [0.0, 0.75, 0.0], "scale": [0.5, 0.5, 0.5] }));
        }
    }
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": roots }], "nodes": nodes,
        "meshes": [{ "name": "cube", "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5] },
            { "bufferView": 1, "componentType": 5125, "count": 36, "type": "SCALAR" }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 96 }, { "buffer": 0, "byteOffset": 96, "byteLength": 144 }],
        "buffers": [{ "byteLength": 240, "uri": "cubes.bin" }],
    })
    .to_string()
}

fn bytes_of_cubes() -> Vec<u8> {
    let corners = (0..8_u8).flat_map(|k| [0, 1, 2].map(|a| if k >> a & 1 == 1 { 0.5_f32 } else { -0.5 }));
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]);
    corners.flat_map(f32::to_le_bytes).chain(indices.flat_map(u32::to_le_bytes)).collect()
}

/// Where the elements of a result are.
fn places(folder: &Folder, name: &str) -> Vec<[f64; 3]> {
    let placed: Value = serde_json::from_str(&folder.text(name)).unwrap();
    let place = |p: &Value| std::array::from_fn(|k| p["translation"][k].as_f64().unwrap());
    placed["placements"].as_array().unwrap().iter().map(place).collect()
}

#[test]
fn what_lies_on_something_lies_on_it_in_the_result() {
    let folder = Folder::new();
    let grid = (0..12_u8).map(|k| [3.0 * f64::from(k % 4) + 0.3 * f64::from(k / 4), 0.5, 3.1 * f64::from(k / 4)]);
    let mut all: Vec<[f64; 3]> = grid.collect();
    let above: Vec<[f64; 3]> = all.iter().step_by(2).map(|[x, _, z]| [x + 0.1, 1.52, z - 0.1]).collect();
    all.extend(above);
    folder.write("cubes.bin", bytes_of_cubes());
    folder.write("cubes.gltf", cubes(&all, false));
    let said = String::from_utf8(folder.ok("inspect cubes.gltf").stdout).unwrap();
    assert!(said.contains("6 stacks of 12 elements"), "{said}");
    for seed in 0..3 {
        folder.ok(&format!("fill cubes.gltf --box 16x4x12 --floor --seed {seed} -o a.json"));
        let found = places(&folder, "a.json");
        let upper: Vec<_> = found.iter().filter(|p| p[1] > 1.0).collect();
        assert!(!upper.is_empty());
        for [x, y, z] in upper {
            let below = [x - 0.1, y - 1.02, z + 0.1];
            let is_below = |p: &[f64; 3]| (0..3).all(|k| (p[k] - below[k]).abs() < 1e-3);
            assert!((below[1] - 0.5).abs() < 1e-6 && found.iter().any(is_below), "{x} {y} {z}");
        }
    }
}

#[test]
fn elements_of_several_meshes_stay_together() {
    let folder = Folder::new();
    let all: Vec<[f64; 3]> = (0..16_u8).map(|k| [2.0 * f64::from(k % 4), 0.5, 2.2 * f64::from(k / 4)]).collect();
    folder.write("cubes.bin", bytes_of_cubes());
    folder.write("cubes.gltf", cubes(&all, true));
    let said = String::from_utf8(folder.ok("inspect cubes.gltf").stdout).unwrap();
    assert!(said.contains("elements: 16") && said.contains("16 elements of several meshes"), "{said}");
    folder.ok("fill cubes.gltf --box 9x3x9 --floor -o a.gltf");
    let document: Value = serde_json::from_str(&folder.text("a.gltf")).unwrap();
    let nodes = document["nodes"].as_array().unwrap();
    let tops = document["scenes"][0]["nodes"].as_array().unwrap().len();
    assert!(tops > 4 && nodes.len() == 3 * tops);
    assert!(nodes[..tops].iter().all(|node| node["children"].as_array().unwrap().len() == 2));
    folder.ok("fill cubes.gltf --box 9x3x9 --floor -o a.glb");
    folder.ok("edit a.glb --item 1 --move 0,0,0.25 -o b.glb");
    let said: Value = serde_json::from_slice(&folder.ok("inspect b.glb --json").stdout).unwrap();
    assert_eq!(said["elements"], tops);
}
