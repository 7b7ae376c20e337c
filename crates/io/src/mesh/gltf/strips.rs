//! GLB: textured strips with their pictures inside.

use arabesque_core::{Budget, Result};
use serde_json::{Value, json};

use super::{
    container::{asset, container},
    write::Buffer,
};
use crate::mesh::strip::Part;

const LINEAR: u32 = 9729;
const CLAMP_TO_EDGE: u32 = 33071;

/// Work of one corner.
const CORNER: u64 = 200;
/// Bytes of one corner, in the file and on the way there, and of one triangle.
const CORNER_BYTES: usize = 3 * (12 + 8);
const TRIANGLE_BYTES: usize = 3 * 12;

/// Everything in the document that there is one of for each part.
#[derive(Default)]
struct Content {
    buffer: Buffer,
    primitives: Vec<Value>,
    materials: Vec<Value>,
    textures: Vec<Value>,
    images: Vec<Value>,
}

impl Content {
    /// Adds the primitive of a part with its material, texture and picture.
    fn add(&mut self, part: &Part) {
        let number = self.primitives.len();
        let positions: Vec<[f32; 3]> = part.strip.positions.iter().map(|p| p.map(|v| v as f32)).collect();
        let texture: Vec<[f32; 2]> = part.strip.texture.iter().map(|p| p.map(|v| v as f32)).collect();
        let attributes = json!({
            "POSITION": self.buffer.vectors(&positions, true),
            "TEXCOORD_0": self.buffer.vectors(&texture, false),
        });
        let indices = self.buffer.indices(&part.strip.triangles);
        self.primitives.push(json!({ "attributes": attributes, "indices": indices, "material": number }));
        self.materials.push(json!({
            "name": part.name,
            "pbrMetallicRoughness": { "baseColorTexture": { "index": number }, "metallicFactor": 0.0 },
            "alphaMode": "BLEND",
            "doubleSided": true,
            "extensions": { "KHR_materials_unlit": {} },
        }));
        self.textures.push(json!({ "sampler": 0, "source": number }));
        let view = self.buffer.view(&part.picture, None);
        self.images.push(json!({ "name": part.name, "mimeType": "image/png", "bufferView": view }));
    }
}

/// Writes strips as one mesh, a primitive for each picture: unlit, seen from both sides, blended by its alpha. The
/// picture's top is at texture coordinate 0, as the format has it. Parts without triangles are left out.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] beyond 4 GiB or when the work or the memory is used up, [`arabesque_core::Error::Stopped`] when somebody asked to stop.
pub fn write_glb(parts: &[Part], recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>> {
    let bytes = parts.iter().map(|part| {
        let strip = &part.strip;
        CORNER_BYTES * strip.positions.len() + TRIANGLE_BYTES * strip.triangles.len() + 3 * part.picture.len()
    });
    let _held = budget.hold("the bytes of the mesh", bytes.sum())?;
    let mut content = Content::default();
    for part in parts.iter().filter(|part| !part.strip.triangles.is_empty()) {
        budget.spend(CORNER.saturating_mul(part.strip.positions.len() as u64))?;
        content.add(part);
    }
    let Content { buffer, primitives, materials, textures, images } = content;
    let sampler = json!({
        "magFilter": LINEAR, "minFilter": LINEAR, "wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE,
    });
    let document = json!({
        "asset": asset(recipe),
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "ribbon", "mesh": 0 }],
        "meshes": [{ "name": "ribbon", "primitives": primitives }],
        "materials": materials,
        "textures": textures,
        "samplers": [sampler],
        "images": images,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
    });
    container(&document, &buffer.bytes, "use fewer or longer pieces (--step)")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{
        gltf::container::{JSON_CHUNK, is_glb, recipe_of},
        strip::Strip,
    };

    fn part() -> Part {
        let mut strip = Strip::default();
        let corner = |x: f64, y: f64| ([x, y, 0.5], [x / 4.0, y / 2.0]);
        strip.push([corner(0.0, 0.0), corner(4.0, 0.0)], [corner(0.0, 3.0), corner(4.0, 2.0)]);
        Part { name: "a.png".into(), picture: vec![1, 2, 3], strip }
    }

    #[test]
    fn the_container_holds_what_its_header_says() {
        let bytes = write_glb(&[part()], Some("seed = 1\n"), &Budget::default()).unwrap();
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert!(is_glb(&bytes));
        assert_eq!((number(4), number(8)), (2, bytes.len()));
        let text = number(12);
        assert_eq!((text % 4, &bytes[16..20]), (0, JSON_CHUNK.as_slice()));
        let document: Value = serde_json::from_slice(&bytes[20..20 + text]).unwrap();
        assert_eq!(number(20 + text), bytes.len() - 28 - text);
        assert_eq!(document["accessors"][0]["max"], json!([4.0, 3.0, 0.5]));
        assert_eq!(document["accessors"][2]["count"], 6);
        for view in document["bufferViews"].as_array().unwrap() {
            let end = view["byteOffset"].as_u64().unwrap() + view["byteLength"].as_u64().unwrap();
            assert!(end <= document["buffers"][0]["byteLength"].as_u64().unwrap());
        }
        assert_eq!(recipe_of(&bytes).as_deref(), Some("seed = 1\n"));
    }

    #[test]
    fn broken_files_have_no_recipe() {
        let bytes = write_glb(&[part()], None, &Budget::default()).unwrap();
        assert_eq!(recipe_of(&bytes), None);
        for end in [0, 4, 15, 20, 40] {
            assert_eq!(recipe_of(&bytes[..end]), None);
        }
        assert_eq!(recipe_of(&[b"glTF".as_slice(), &[255; 20]].concat()), None);
    }

    #[test]
    fn texture_coordinates_stay_in_the_picture() {
        assert_eq!(part().strip.texture[2], [0.0, 1.0]);
    }
}
