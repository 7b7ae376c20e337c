//! Materials, textures and pictures of a GLB file: what is used, each once.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use serde_json::{Value, json};

use super::buffer::Buffer;
use crate::mesh::scene::{Alpha, Looks, Material, Sampler, Slot, Texture, TextureUse};

/// What the format calls the moving of textures.
const TRANSFORM: &str = "KHR_texture_transform";

/// Materials as they come into use.
pub(super) struct LooksOut<'a> {
    looks: &'a Looks,
    /// Numbers of the materials in use; `None` stands for the plain one.
    used: Vec<Option<usize>>,
}

/// What a document says of how things look.
#[derive(Default)]
pub(super) struct Written {
    pub(super) materials: Vec<Value>,
    pub(super) textures: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    pub(super) images: Vec<Value>,
    pub(super) extensions: BTreeSet<String>,
    pub(super) required: BTreeSet<String>,
}

impl<'a> LooksOut<'a> {
    pub(super) fn new(looks: &'a Looks) -> Self {
        Self { looks, used: Vec::new() }
    }

    /// How many materials the scene has.
    pub(super) fn materials(&self) -> usize {
        self.looks.materials.len()
    }

    /// The number in the file of a material; the plain one for none.
    pub(super) fn material(&mut self, material: Option<usize>) -> usize {
        let material = material.filter(|m| *m < self.looks.materials.len());
        let known = self.used.iter().position(|m| *m == material);
        known.unwrap_or_else(|| {
            self.used.push(material);
            self.used.len() - 1
        })
    }

    /// The number of the material of what has none: without one things would be of metal.
    pub(super) fn plain(&mut self) -> usize {
        self.material(None)
    }

    /// The records of everything in use; pictures go into the buffer.
    pub(super) fn finish(self, buffer: &mut Buffer) -> Written {
        let plain = Material { name: "plain".into(), ..Material::default() };
        let materials: Vec<&Material> =
            self.used.iter().map(|m| m.and_then(|m| self.looks.materials.get(m)).unwrap_or(&plain)).collect();
        let textures: BTreeSet<usize> = materials.iter().flat_map(|m| m.used_textures()).collect();
        let textures: Vec<usize> = textures.into_iter().filter(|t| *t < self.looks.textures.len()).collect();
        let mut written = Written::default();
        let mut pictures = Pictures { looks: self.looks, by_bytes: BTreeMap::new() };
        for texture in textures.iter().map(|&t| &self.looks.textures[t]) {
            let record = pictures.texture(texture, &mut written, buffer);
            written.textures.push(record);
        }
        for material in materials {
            let renumbered = material.renumbered(&|n| textures.binary_search(&n).ok());
            let record = material_record(&renumbered, &mut written.extensions);
            written.materials.push(record);
        }
        written
    }
}

struct Pictures<'a> {
    looks: &'a Looks,
    /// Numbers in the file of pictures, by where their bytes lie: several may share them.
    by_bytes: BTreeMap<(usize, String), usize>,
}

impl Pictures<'_> {
    /// The number in the file of a picture; `None` where there are no bytes.
    fn picture(&mut self, number: usize, written: &mut Written, buffer: &mut Buffer) -> Option<usize> {
        let picture = self.looks.pictures.get(number).filter(|p| !p.bytes.is_empty() && !p.mime.is_empty())?;
        let key = (Arc::as_ptr(&picture.bytes).cast::<u8>() as usize, picture.mime.clone());
        Some(*self.by_bytes.entry(key).or_insert_with(|| {
            let view = buffer.view(&picture.bytes, None);
            let mut record = json!({ "mimeType": picture.mime, "bufferView": view });
            name(&mut record, &picture.name);
            written.images.push(record);
            written.images.len() - 1
        }))
    }

    fn texture(&mut self, texture: &Texture, written: &mut Written, buffer: &mut Buffer) -> Value {
        let mut record = json!({});
        name(&mut record, &texture.name);
        if texture.sampler != Sampler::default() {
            record["sampler"] = sampler(&texture.sampler, &mut written.samplers).into();
        }
        let source = texture.picture.and_then(|n| self.picture(n, written, buffer));
        if let Some(source) = source {
            record["source"] = source.into();
        }
        if let Some((extension, number)) = &texture.other
            && let Some(number) = self.picture(*number, written, buffer)
        {
            record["extensions"] = json!({ extension.as_str(): { "source": number } });
            written.extensions.insert(extension.clone());
            if source.is_none() {
                written.required.insert(extension.clone());
            }
        }
        record
    }
}

/// The number of a sampler among those that are written.
fn sampler(sampler: &Sampler, written: &mut Vec<Value>) -> usize {
    let mut record = json!({});
    let values = [sampler.enlarging, sampler.reducing, sampler.wrap_s, sampler.wrap_t];
    for (key, value) in ["magFilter", "minFilter", "wrapS", "wrapT"].into_iter().zip(values) {
        if let Some(value) = value {
            record[key] = value.into();
        }
    }
    let known = written.iter().position(|s| *s == record);
    known.unwrap_or_else(|| {
        written.push(record);
        written.len() - 1
    })
}

fn name(record: &mut Value, name: &str) {
    if !name.is_empty() {
        record["name"] = name.into();
    }
}

fn material_record(material: &Material, extensions: &mut BTreeSet<String>) -> Value {
    let mut pbr = json!({ "metallicFactor": material.metallic, "roughnessFactor": material.roughness });
    if material.base_colour != [1.0; 4] {
        pbr["baseColorFactor"] = json!(material.base_colour);
    }
    let mut record = json!({});
    name(&mut record, &material.name);
    let mut used = |slot: Slot, strength: &str| Some(texture_info(material.texture(slot)?, strength, extensions));
    let textures = [
        ("baseColorTexture", used(Slot::BaseColour, "")),
        ("metallicRoughnessTexture", used(Slot::MetallicRoughness, "")),
        ("normalTexture", used(Slot::Normal, "scale")),
        ("occlusionTexture", used(Slot::Occlusion, "strength")),
        ("emissiveTexture", used(Slot::Emissive, "")),
    ];
    for (k, (key, info)) in textures.into_iter().enumerate() {
        let Some(info) = info else { continue };
        // The first two are about metalness and roughness, and stand there.
        (if k < 2 { &mut pbr } else { &mut record })[key] = info;
    }
    record["pbrMetallicRoughness"] = pbr;
    if material.emissive != [0.0; 3] {
        record["emissiveFactor"] = json!(material.emissive);
    }
    match material.alpha {
        Alpha::Opaque => {}
        Alpha::Mask(cutoff) => {
            record["alphaMode"] = "MASK".into();
            record["alphaCutoff"] = cutoff.into();
        }
        Alpha::Blend => record["alphaMode"] = "BLEND".into(),
    }
    if material.double_sided {
        record["doubleSided"] = true.into();
    }
    for (key, extension) in &material.extensions {
        record["extensions"][key.as_str()] = extension.clone();
        extensions.insert(key.clone());
        if mentions(extension, TRANSFORM) {
            extensions.insert(TRANSFORM.into());
        }
    }
    record
}

/// A texture as a material uses it; `strength` is what the format calls how strong it is.
fn texture_info(used: &TextureUse, strength: &str, extensions: &mut BTreeSet<String>) -> Value {
    let mut info = json!({ "index": used.texture });
    if used.uv != 0 {
        info["texCoord"] = used.uv.into();
    }
    if let Some(value) = used.strength.filter(|_| !strength.is_empty()) {
        info[strength] = value.into();
    }
    if let Some(transform) = &used.transform {
        info["extensions"] = json!({ TRANSFORM: transform });
        extensions.insert(TRANSFORM.into());
    }
    info
}

/// Whether something has a key somewhere below.
fn mentions(value: &Value, key: &str) -> bool {
    let entries = value.as_object().into_iter().flatten();
    entries.into_iter().any(|(name, entry)| name == key || mentions(entry, key))
}
