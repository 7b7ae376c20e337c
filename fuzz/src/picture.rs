//! Feeds arbitrary bytes to the readers of pictures, of curves in space, and of recipes in meshes: never a panic or a
//! hang.
#![no_main]

use arabesque_core::{Budget, Limits};
use arabesque_io::{
    mesh::{gltf, obj},
    raster::{image, png},
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let budget = Budget::new(Limits { nodes: 3000, segments: 3000, elements: 500, pixels: 100_000, ..Limits::default() });
    if let Ok((image, _)) = image::read_image("fuzz.png", data, &budget) {
        assert_eq!(image.pixels.len(), image.width * image.height);
    }
    let _ = png::recipe_of(data);
    let _ = gltf::recipe_of(data);
    if let Ok(text) = std::str::from_utf8(data)
        && let Ok(lines) = obj::read_lines("fuzz.obj", text, &budget)
    {
        assert!(lines.iter().flat_map(|(_, path)| path.cubics.iter().flatten()).all(|p| p.is_finite()));
    }
});
