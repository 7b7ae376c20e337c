//! Scenes read and changed.

use arabesque_core::{Budget, Matrix, Similarity, TriangleMesh, Vector};

use super::{GlbElements, GltfElements};
use crate::{
    mesh::{
        gltf::{as_text, is_gltf, recipe_of, write_scene},
        scene::{Scene, SceneMesh, SceneNode, matrix_of},
    },
    placed::{Changes, Paint, PlacedFile, Replaced},
};

fn result() -> Vec<u8> {
    let mesh = TriangleMesh {
        positions: [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 4.0]].map(Vector).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    let turned = |x: f64| Similarity {
        rotation: matrix_of([0.1, 0.3, -0.2, 0.9]),
        scale: 1.25,
        translation: Vector([x, 2.0 / 3.0, -4.0]),
    };
    let node = |class: &str, transform| SceneNode {
        class: Some(class.into()),
        source: Some(7),
        ..SceneNode::new(class, 0, transform)
    };
    let scene = Scene {
        meshes: vec![SceneMesh::new("wedge", mesh)],
        nodes: vec![node("a", Similarity::identity()), node("b", turned(1.0 / 3.0)), node("a", turned(5.0))],
        ..Scene::default()
    };
    write_scene(&scene, Some("seed = 1\n"), &Budget::default()).unwrap()
}

fn open(bytes: &[u8]) -> GlbElements {
    GlbElements::open("r.glb", bytes, &Budget::default()).unwrap()
}

fn changed(bytes: &[u8], changes: &Changes<3>) -> Vec<u8> {
    open(bytes).rewritten(changes, None, &Budget::default()).unwrap()
}

fn about(bytes: &[u8], id: usize, (rotation, scale, shift): (Matrix<3>, f64, Vector<3>)) -> Changes<3> {
    let centre = open(bytes).layout().item(id).unwrap().centre;
    let motion = Similarity::about(centre, centre + shift, rotation, scale);
    Changes { replaced: [(id, Replaced { base: id, motion, paint: Vec::new() })].into(), ..Changes::default() }
}

#[test]
fn motion_and_back_restores_every_byte() {
    let bytes = result();
    assert_eq!(changed(&bytes, &Changes::default()), bytes);
    let (turn, shift) = (matrix_of([0.0, 0.5, 0.1, 0.8]), Vector([0.1, -0.7, 3.3]));
    for id in 0..3 {
        let there = changed(&bytes, &about(&bytes, id, (turn, 2.0, shift)));
        assert_ne!(there, bytes);
        assert!(changed(&there, &about(&there, id, (turn.transpose(), 0.5, -shift))) == bytes, "{id}");
    }
}

#[test]
fn elements_go_and_come_and_keep_their_numbers() {
    let bytes = result();
    let gone = changed(&bytes, &Changes { removed: [0].into(), ..Changes::default() });
    assert_eq!(open(&gone).layout().items.iter().map(|item| item.id).collect::<Vec<_>>(), [1, 2]);
    assert_eq!(recipe_of(&gone).as_deref(), Some("seed = 1\n"));
    let copy = Replaced { base: 1, motion: Similarity::shift(Vector([1.0, 0.0, 0.0])), paint: Vec::new() };
    let more = changed(&bytes, &Changes { inserted: vec![(3, copy)], ..Changes::default() });
    assert_eq!(open(&more).layout().items.len(), 4);
    assert_eq!(changed(&more, &Changes { removed: [3].into(), ..Changes::default() }), bytes);
    let new = open(&bytes).rewritten(&Changes::default(), Some("seed = 2\n"), &Budget::default()).unwrap();
    assert_eq!(recipe_of(&new).as_deref(), Some("seed = 2\n"));
}

#[test]
fn paint_is_a_material_of_a_copy_of_the_mesh() {
    let bytes = result();
    let paint = vec![Paint { property: "fill".into(), value: "#ff0000".into() }];
    let red = Replaced { base: 1, motion: Similarity::identity(), paint };
    let painted = changed(&bytes, &Changes { replaced: [(1, red)].into(), ..Changes::default() });
    let document = String::from_utf8_lossy(&painted).into_owned();
    assert!(document.contains("\"baseColorFactor\":[1.0,0.0,0.0,1.0]"), "{document}");
    assert_eq!(open(&painted).nodes.iter().map(|node| node.mesh).collect::<Vec<_>>(), [Some(0), Some(1), Some(0)]);
    let stroke = vec![Paint { property: "stroke".into(), value: "red".into() }];
    let stroke = Replaced { base: 1, motion: Similarity::identity(), paint: stroke };
    let refused = Changes { replaced: [(1, stroke)].into(), ..Changes::default() };
    assert!(open(&bytes).rewritten(&refused, None, &Budget::default()).unwrap_err().to_string().contains("fill"));
}

#[test]
fn a_scene_as_text_is_changed_as_the_same_scene_is() {
    let (glb, budget) = (result(), Budget::default());
    let text = |glb: &[u8]| String::from_utf8(as_text(glb, &budget).unwrap()).unwrap();
    let changes = about(&glb, 1, (matrix_of([0.0, 0.5, 0.1, 0.8]), 1.5, Vector([0.1, -0.7, 3.3])));
    let opened = GltfElements::open("r.gltf", &text(&glb), &budget).unwrap();
    assert_eq!(opened.layout().items.len(), 3);
    assert!(opened.rewritten(&Changes::default(), None, &budget).unwrap() == text(&glb).into_bytes());
    assert!(opened.rewritten(&changes, None, &budget).unwrap() == text(&changed(&glb, &changes)).into_bytes());
    let outside = text(&glb).replace("data:application/octet-stream;base64,", "a.bin");
    let refused = GltfElements::open("r.gltf", &outside, &budget).unwrap_err().to_string();
    assert!(refused.contains("lie elsewhere"), "{refused}");
    let spoiled = text(&glb).replace("base64,", "base64,!");
    assert!(GltfElements::open("r.gltf", &spoiled, &budget).unwrap_err().to_string().contains("data URI"));
    assert!(GltfElements::open("r.gltf", "{}", &budget).is_err());
    let long = opened.rewritten(&Changes::default(), Some(&"#".repeat(100_000)), &budget).unwrap();
    assert!(is_gltf(&long) && !is_gltf(b"{\"page\": [], \"placements\": []}"));
}

#[test]
fn broken_scenes_are_refused() {
    let bytes = result();
    for end in [0, 4, 11, 20, 60, bytes.len() - 1] {
        assert!(GlbElements::open("r.glb", &bytes[..end], &Budget::default()).is_err(), "{end}");
    }
}
