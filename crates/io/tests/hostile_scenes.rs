//! Scenes that few bytes make large, that lead nowhere, or that hold no numbers.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use arabesque_core::{Budget, Error, Limits, Result};
use arabesque_io::{
    file::NothingBeside,
    mesh::{
        gltf::{Scene, read_scene},
        obj,
    },
};

/// A document of one triangle, with other entries at its end.
fn document(nodes: &str, more: &str) -> String {
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"nodes\": [{nodes}], \
         \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0}}}}]}}], \
         \"accessors\": [{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}}], \
         \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": 36}}, {{\"buffer\": 0, \"byteOffset\": 12, \"byteLength\": 24}}], \
         \"buffers\": [{{\"byteLength\": 36, \"uri\": \"data:application/octet-stream;base64,{data}\"}}]{more}}}"
    )
}

fn read(nodes: &str, more: &str) -> Result<Scene> {
    read_scene("a.gltf", document(nodes, more).as_bytes(), &Budget::default())
}

fn refused(nodes: &str, more: &str, expected: &str) {
    let message = read(nodes, more).unwrap_err().to_string();
    assert!(message.contains(expected) && message.len() < 500, "{expected}: {message}");
}

#[test]
fn a_hundred_thousand_nodes_share_one_mesh() {
    let node = |k: usize| format!("{{\"mesh\": 0, \"translation\": [{k}, 0, 0]}}");
    let nodes: Vec<String> = (0..100_000).map(node).collect();
    let scene = read(&nodes.join(", "), "").unwrap();
    assert_eq!((scene.nodes.len(), scene.meshes.len()), (100_000, 1));
    let few = Budget::new(Limits { nodes: 50_000, ..Limits::default() });
    let found = read_scene("a.gltf", document(&nodes.join(", "), "").as_bytes(), &few);
    assert!(matches!(found, Err(Error::Limit { .. })));
}

#[test]
fn trees_that_are_deep_or_no_trees_are_refused() {
    let chain: Vec<String> = (1..2000).map(|k| format!("{{\"children\": [{k}]}}")).collect();
    refused(&format!("{}, {{\"mesh\": 0}}", chain.join(", ")), "", "depth of nodes: 257 is over the limit");
    let scenes = ", \"scenes\": [{\"nodes\": [0]}]";
    refused("{\"children\": [1]}, {\"children\": [0]}", scenes, "below itself");
    refused("{\"children\": [0]}", scenes, "below itself");
}

#[test]
fn numbers_that_are_none_are_refused_and_flat_things_left_out() {
    refused("{\"mesh\": 0, \"translation\": [1e999, 0, 0]}", "", "its JSON: number out of range");
    refused("{\"mesh\": 0, \"scale\": [1e300, 1e300, 1e300]}", "", "a.gltf: a node without a name");
    let scene =
        read("{\"mesh\": 0}, {\"mesh\": 0, \"scale\": [0, 0, 0]}, {\"mesh\": 0, \"scale\": [1, 0, 1]}", "").unwrap();
    assert_eq!(scene.nodes.len(), 1);
    assert!(scene.warnings[0].message.contains("2 nodes whose transform leaves no volume are left out"));
    refused("{\"mesh\": 0, \"scale\": [0, 0, 0]}", "", "1 nodes with meshes, all scaled to nothing");
    refused("", "", "no mesh and no points");
    refused("{\"name\": \"empty\"}", "", "no mesh and no points");
}

#[test]
fn turned_stretches_of_one_kind_share_a_mesh() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = format!(
        "{{\"mesh\": 0, \"scale\": [2, 1, 1]}}, {{\"mesh\": 0, \"scale\": [4, 2, 2], \"rotation\": [0, {half}, 0, {half}]}}, \
         {{\"mesh\": 0, \"scale\": [-1, 1, 1]}}, {{\"mesh\": 0, \"scale\": [-3, 3, 3], \"rotation\": [{half}, 0, 0, {half}]}}"
    );
    let scene = read(&nodes, "").unwrap();
    assert_eq!(scene.nodes.iter().map(|n| n.mesh).collect::<Vec<_>>(), [0, 0, 1, 1]);
    assert!((scene.nodes[1].transform.scale / scene.nodes[0].transform.scale - 2.0).abs() < 1e-9);
}

#[test]
fn what_is_left_out_is_told_at_once() {
    let more = ", \"animations\": [{}, {}], \"scenes\": [{\"name\": \"a\", \"nodes\": [0]}, {\"nodes\": []}], \
                \"extensionsUsed\": [\"KHR_lights_punctual\"]";
    let nodes = "{\"mesh\": 0, \"camera\": 0, \"skin\": 0, \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}";
    let scene = read(nodes, more).unwrap();
    let told: Vec<&str> = scene.warnings.iter().map(|w| w.message.as_str()).collect();
    let expected = "a.gltf: left out: 1 camera, 1 light, 2 animations, 1 skin; meshes are read as they rest";
    assert_eq!(told, [expected, "a.gltf: 2 scenes, of which \"a\" is read"]);
}

#[test]
fn the_same_bytes_may_be_many_pictures_and_are_held_once() {
    let images: Vec<&str> = (0..20_000).map(|_| "{\"bufferView\": 1}").collect();
    let more = format!(", \"images\": [{}]", images.join(", "));
    let scene = read("{\"mesh\": 0}", &more).unwrap();
    let pictures = &scene.looks.pictures;
    assert!(pictures.len() == 20_000 && std::sync::Arc::ptr_eq(&pictures[0].bytes, &pictures[19_999].bytes));
}

#[test]
fn texts_that_are_cut_off_are_refused() {
    let whole = document("{\"mesh\": 0}", "");
    for end in (1..whole.len()).step_by(7) {
        assert!(read_scene("a.gltf", &whole.as_bytes()[..end], &Budget::default()).is_err(), "{end}");
    }
    let obj = "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3000000000\n";
    let message = obj::read_scene("a.obj", obj, &NothingBeside, &Budget::default()).unwrap_err().to_string();
    assert!(message.contains("line 6: vertex 3000000000 where there are 3 so far"), "{message}");
}
