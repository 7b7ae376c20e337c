//! Feeds scenes to the reader of GLB: bytes as they are, or a document of text and a chunk of bytes parted by a zero, in a sound container.
#![no_main]

use arabesque_core::Budget;
use arabesque_fuzz::{geometry, limits};
use arabesque_io::mesh::gltf::{is_glb, read_scene, recipe_of};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let bytes = if is_glb(data) { data.to_vec() } else { container(data) };
    let _ = recipe_of(&bytes);
    match read_scene("fuzz.glb", &bytes, &Budget::new(limits())) {
        Ok(scene) => {
            geometry::scene(&scene);
            geometry::geometry(&scene.into_geometry("fuzz.glb"));
        }
        Err(error) => assert!(error.to_string().len() < 2000, "a message without end: {error}"),
    }
});

fn container(data: &[u8]) -> Vec<u8> {
    let end = data.iter().position(|b| *b == 0).unwrap_or(data.len());
    let (document, rest) = data.split_at(end);
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, chunk, filler) in [(b"JSON", document, b' '), (b"BIN\0", rest.get(1..).unwrap_or_default(), 0)] {
        let length = chunk.len().next_multiple_of(4);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
        bytes.resize(bytes.len() + length - chunk.len(), filler);
    }
    bytes
}
