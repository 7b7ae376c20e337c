//! What is written as GLB, as others read it: the crate `gltf`, and the validator of Khronos where node and its package are there.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{collections::BTreeMap, process::Command, sync::Arc};

use arabesque_core::{Bounds, Budget, Matrix, Similarity, TriangleMesh, Vector};
use arabesque_io::mesh::{
    gltf::{GltfOptions, Scene, SceneMesh, SceneNode, read_scene, read_scene_beside, write_scene_with},
    scene::{Alpha, Attributes, Looks, Material, Picture, Primitive, Sampler, Slot, Texture, TextureUse},
};

/// A picture of one pixel.
const PIXEL: [u8; 67] = [
    137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0, 58, 126, 155,
    85, 0, 0, 0, 10, 73, 68, 65, 84, 120, 156, 99, 104, 0, 0, 0, 130, 0, 129, 119, 205, 114, 182, 0, 0, 0, 0, 73, 69,
    78, 68, 174, 66, 96, 130,
];

fn material() -> Material {
    let mut material = Material {
        name: "wax".into(),
        base_colour: [0.5, 0.25, 0.125, 0.5],
        roughness: 0.25,
        alpha: Alpha::Mask(0.25),
        double_sided: true,
        emissive: [0.0, 0.5, 0.0],
        ..Material::default()
    };
    let transform = serde_json::json!({ "offset": [0.5, 0.0], "scale": [2.0, 2.0] });
    material.textures[Slot::BaseColour as usize] =
        Some(TextureUse { transform: Some(transform), ..TextureUse::default() });
    material.textures[Slot::Normal as usize] =
        Some(TextureUse { texture: 1, uv: 1, strength: Some(0.5), transform: None });
    material
        .extensions
        .insert("KHR_materials_emissive_strength".into(), serde_json::json!({ "emissiveStrength": 2.0 }));
    material
}

/// Tetrahedra with textures, in two classes.
fn scene() -> Scene {
    let corners = [[1.0, 0.0, 0.0], [-0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.0, 0.0, 1.0]].map(Vector);
    let up = Vector([0.0, 0.0, 1.0]);
    let mesh = TriangleMesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        normals: Some(vec![up; 4]),
        ..TriangleMesh::default()
    };
    let uv = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let attributes = Arc::new(Attributes {
        uv: [uv.clone(), uv],
        tangents: vec![[1.0, 0.0, 0.0, -1.0]; 4],
        colours: vec![[1.0, 0.5, 0.25, 1.0]; 4],
    });
    let run =
        |triangles, material| Primitive { triangles, vertices: 0..4, material, attributes: Arc::clone(&attributes) };
    let shape = SceneMesh { primitives: vec![run(0..1, Some(1)), run(1..4, None)], ..SceneMesh::new("gem", mesh) };
    let turned = Matrix([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let node = |k: u64| SceneNode {
        class: Some(if k < 4 { "gem" } else { "stone" }.into()),
        id: Some(k),
        source: Some(0),
        ..SceneNode::new(
            format!("gem.{k:03}"),
            0,
            Similarity { rotation: turned, scale: 1.0 + k as f64, translation: Vector([k as f64, 0.0, 2.0]) },
        )
    };
    let texture = |name: &str, wrap| Texture {
        name: name.into(),
        picture: Some(0),
        sampler: Sampler { enlarging: Some(9729), wrap_s: wrap, ..Sampler::default() },
        other: None,
    };
    Scene {
        meshes: vec![shape],
        nodes: (0..7).map(node).collect(),
        looks: Looks {
            materials: vec![Material::default(), material()],
            textures: vec![texture("a", None), texture("b", Some(33071)), texture("unused", None)],
            pictures: vec![Picture { name: "pixel".into(), mime: "image/png".into(), bytes: PIXEL.to_vec().into() }],
        },
        frame: Some(Bounds::new(Vector::ZERO, Vector([7.0, 1.0, 3.0]))),
        deformable: vec!["stone".into()],
        ..Scene::default()
    }
}

fn written(instancing: bool) -> Vec<u8> {
    let options = GltfOptions { recipe: Some("seed = 1\n"), instancing };
    write_scene_with(&scene(), &options, &Budget::default()).unwrap()
}

#[test]
fn everything_comes_back() {
    let back = read_scene("a.glb", &written(false), &Budget::default()).unwrap();
    let scene = scene();
    assert_eq!((back.frame, &back.deformable), (scene.frame, &scene.deformable));
    assert!(back.warnings.is_empty(), "{:?}", back.warnings);
    for (a, b) in back.nodes.iter().zip(&scene.nodes) {
        assert_eq!((&a.name, &a.class, a.id, a.source), (&b.name, &b.class, b.id, b.source));
        let p = Vector([1.0, 2.0, 3.0]);
        assert!((a.transform.apply(p) - b.transform.apply(p)).norm() < 1e-6);
    }
    // The first material in use is the first; the plain one takes the place of none; a texture that nothing uses is gone.
    assert_eq!(back.looks.materials[0], material());
    assert_eq!((back.looks.textures.len(), back.looks.pictures.len()), (2, 1));
    assert_eq!(&*back.looks.pictures[0].bytes, &PIXEL);
    let shape = &back.meshes[0];
    assert_eq!(shape.primitives.iter().map(|p| p.material).collect::<Vec<_>>(), [Some(0), Some(1)]);
    assert_eq!(shape.primitives[0].attributes, scene.meshes[0].primitives[0].attributes);
    // Vertices of two materials are two runs, since they differ in their colours.
    assert_eq!(shape.mesh.triangles, [[0, 2, 1], [4, 5, 7], [5, 6, 7], [6, 4, 7]]);
    let again = write_scene_with(&back, &GltfOptions::default(), &Budget::default()).unwrap();
    assert_eq!(read_scene("a.glb", &again, &Budget::default()).unwrap().looks, back.looks);
}

#[test]
fn another_reader_finds_one_mesh_in_all_its_places() {
    let file = gltf::Gltf::from_slice(&written(false)).unwrap();
    assert_eq!((file.nodes().len(), file.meshes().len(), file.images().len()), (7, 1, 1));
    assert!(file.nodes().all(|node| node.mesh().unwrap().index() == 0));
    let blob = file.blob.as_deref().unwrap();
    let mesh = file.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(blob));
    assert_eq!(reader.read_positions().unwrap().count(), 4);
    assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), [0, 2, 1]);
    assert_eq!(reader.read_tex_coords(1).unwrap().into_f32().nth(3), Some([1.0, 1.0]));
    assert_eq!(primitive.material().alpha_mode(), gltf::material::AlphaMode::Mask);
}

#[test]
fn instances_are_lists_of_places_by_class() {
    let bytes = written(true);
    let back = read_scene("a.glb", &bytes, &Budget::default()).unwrap();
    assert_eq!((back.meshes.len(), back.nodes.len()), (1, 7));
    assert_eq!(back.classes().names, ["gem", "stone"]);
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"]"));
    assert!(gltf::Gltf::from_slice(&bytes).is_err(), "the reader does not know the extension");
}

#[test]
fn text_with_its_data_beside_it_is_read_from_there_alone() {
    let document = r#"{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "wood%20a.png"}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "data/a.bin", "byteLength": 36}]}"#;
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|c| c.to_le_bytes()).collect();
    let mut files = BTreeMap::from([
        ("data/a.bin".to_owned(), Arc::<[u8]>::from(bytes)),
        ("wood a.png".to_owned(), Arc::from(PIXEL.as_slice())),
    ]);
    let read = |text: &str, files: &BTreeMap<String, Arc<[u8]>>| {
        read_scene_beside("a.gltf", text.as_bytes(), files, &Budget::default())
    };
    let scene = read(document, &files).unwrap();
    assert_eq!((scene.triangles(), scene.looks.pictures[0].mime.as_str()), (1, "image/png"));
    files.remove("wood a.png");
    let scene = read(document, &files).unwrap();
    assert!(scene.warnings[0].message.contains("1 pictures are left out"), "{:?}", scene.warnings);
    let outside = document.replace("data/a.bin", "../a.bin");
    assert!(read(&outside, &files).unwrap_err().to_string().contains("outside of the folder"));
    let huge = document.replace("data/a.bin", &format!("data:;base64,{}", "A".repeat(4000)));
    let small = Budget::new(arabesque_core::Limits { file_bytes: 1000, ..arabesque_core::Limits::default() });
    let message = read_scene_beside("a.gltf", huge.as_bytes(), &files, &small).unwrap_err().to_string();
    assert!(message.contains("bytes in its data URI: 3000 is over the limit of 1000"), "{message}");
}

/// Runs `gltf-validator` (npm) on both ways of writing; says so where it is not there.
#[test]
fn the_validator_of_khronos_finds_no_error() {
    const SCRIPT: &str = "const v = require('gltf-validator'); const fs = require('fs'); \
        v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1]))).then(r => { \
        console.log(JSON.stringify(r.issues)); process.exit(r.issues.numErrors + r.issues.numWarnings ? 1 : 0); });";
    let present = Command::new("node").args(["-e", "require('gltf-validator')"]).output();
    if !present.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: node and gltf-validator (npm, found by NODE_PATH) are not there");
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    for instancing in [false, true] {
        let path = dir.path().join(format!("{instancing}.glb"));
        std::fs::write(&path, written(instancing)).unwrap();
        let output = Command::new("node").args(["-e", SCRIPT]).arg(&path).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
