//! Feeds scenes as text to their readers: the first byte chooses glTF, OBJ with a file of materials behind a zero, or placements.
#![no_main]

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Bounds, Budget, Similarity, TriangleMesh, Vector};
use arabesque_fuzz::{geometry, limits};
use arabesque_io::{
    json::placements::{PlacementsOptions, read_placements, write_placements},
    mesh::{
        gltf::{GltfOptions, Scene, SceneMesh, SceneNode, read_scene, read_scene_beside, write_scene_with},
        obj,
        scene::Convention,
        usd,
    },
    table::centres,
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Some((which, data)) = data.split_first() else { return };
    let end = data.iter().position(|b| *b == 0).unwrap_or(data.len());
    let (first, rest) = data.split_at(end);
    let files = BTreeMap::from([("a".to_owned(), Arc::<[u8]>::from(rest.get(1..).unwrap_or_default()))]);
    let budget = Budget::new(limits());
    let text = String::from_utf8_lossy(first);
    let found = match which % 3 {
        0 => read_scene_beside("fuzz.gltf", first, &files, &budget),
        1 => obj::read_scene("fuzz.obj", &text, &files, &budget),
        _ => read_placements("fuzz.json", &text, &shapes(), &budget),
    };
    match found {
        Ok(scene) => check(scene),
        Err(error) => assert!(error.to_string().len() < 2000, "a message without end: {error}"),
    }
});

/// A scene of one triangle, for placements.
fn shapes() -> Scene {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector).to_vec();
    let mesh = TriangleMesh { positions, triangles: vec![[0, 1, 2]], ..TriangleMesh::default() };
    Scene {
        meshes: vec![SceneMesh::new("a", mesh)],
        nodes: vec![SceneNode::new("a", 0, Similarity::identity())],
        frame: Some(Bounds::new(Vector::ZERO, Vector::splat(1.0))),
        ..Scene::default()
    }
}

/// Writes a scene in every way, and splits it.
fn check(scene: Scene) {
    geometry::scene(&scene);
    let budget = Budget::new(limits());
    let options = GltfOptions { recipe: None, instancing: true };
    if let Ok(bytes) = write_scene_with(&scene, &options, &budget)
        && let Ok(back) = read_scene("again.glb", &bytes, &Budget::new(limits()))
    {
        assert_eq!((back.nodes.len(), back.triangles()), (scene.nodes.len(), scene.triangles()));
    }
    let recipe = Some("seed = 1\n");
    if let Ok((text, _)) = usd::write_usda(&scene, &Convention::default(), recipe, &Budget::new(limits())) {
        assert!(text.starts_with("#usda 1.0"));
    }
    if let Ok(out) = obj::write_scene(&scene, Some("a.mtl"), recipe, &Budget::new(limits())) {
        assert_eq!(obj::recipe_of(&out.obj).as_deref(), recipe);
    }
    if let Ok(text) = write_placements(&scene, &PlacementsOptions::default(), &Budget::new(limits()))
        && let Ok(back) = read_placements("again.json", &text, &scene, &Budget::new(limits()))
    {
        assert_eq!(back.nodes.len(), scene.nodes.len());
    }
    let _ = centres::write_centres_csv(&scene, recipe, &Budget::new(limits()));
    let _ = centres::write_centres_ply(&scene, recipe, &Budget::new(limits()));
    if let Ok(split) = scene.split_components(&Budget::new(limits())) {
        geometry::scene(&split);
    }
}
