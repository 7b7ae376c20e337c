//! The document of a glTF file, as far as it is about geometry and how it looks.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Error, Result};
use serde::{Deserialize, de::IgnoredAny};
use serde_json::value::RawValue;

/// Work for each byte of the document.
const PER_BYTE: u64 = 20;
/// Bytes in memory for each byte of text, roughly.
const GROWTH: usize = 8;

/// Extensions that a file may require: they are understood, or say nothing about places.
const UNDERSTOOD: [&str; 7] = [
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "KHR_texture_transform",
    "KHR_lights_punctual",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
];
/// How extensions of paint begin.
pub(super) const PAINT: &str = "KHR_materials_";

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    pub(super) extensions_required: Vec<String>,
    pub(super) scene: Option<usize>,
    pub(super) scenes: Vec<SceneRecord>,
    pub(super) nodes: Vec<NodeRecord>,
    pub(super) meshes: Vec<MeshRecord>,
    pub(super) materials: Vec<MaterialRecord>,
    pub(super) textures: Vec<TextureRecord>,
    pub(super) samplers: Vec<SamplerRecord>,
    pub(super) images: Vec<ImageRecord>,
    pub(super) animations: Vec<IgnoredAny>,
    pub(super) accessors: Vec<AccessorRecord>,
    pub(super) buffer_views: Vec<ViewRecord>,
    pub(super) buffers: Vec<BufferRecord>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SceneRecord {
    pub(super) name: Option<String>,
    pub(super) nodes: Vec<usize>,
    pub(super) extras: Option<Box<RawValue>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeRecord {
    pub(super) name: Option<String>,
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) camera: Option<IgnoredAny>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) extensions: NodeExtensions,
    pub(super) extras: Option<Box<RawValue>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instancing {
    pub(super) attributes: BTreeMap<String, usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MeshRecord {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u32>,
    pub(super) material: Option<usize>,
    pub(super) targets: Vec<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct MaterialRecord {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: Option<Paint>,
    pub(super) normal_texture: Option<TextureInfo>,
    pub(super) occlusion_texture: Option<TextureInfo>,
    pub(super) emissive_texture: Option<TextureInfo>,
    pub(super) emissive_factor: Option<[f64; 3]>,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<f64>,
    pub(super) double_sided: bool,
    pub(super) extensions: BTreeMap<String, Box<RawValue>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Paint {
    pub(super) base_color_factor: Option<[f64; 4]>,
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: Option<f64>,
    pub(super) roughness_factor: Option<f64>,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureInfo {
    pub(super) index: usize,
    pub(super) tex_coord: u32,
    pub(super) scale: Option<f64>,
    pub(super) strength: Option<f64>,
    pub(super) extensions: BTreeMap<String, Box<RawValue>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TextureRecord {
    pub(super) name: Option<String>,
    pub(super) sampler: Option<usize>,
    pub(super) source: Option<usize>,
    pub(super) extensions: BTreeMap<String, Box<RawValue>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct SamplerRecord {
    pub(super) mag_filter: Option<u32>,
    pub(super) min_filter: Option<u32>,
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct ImageRecord {
    pub(super) name: Option<String>,
    pub(super) uri: Option<String>,
    pub(super) mime_type: Option<String>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct AccessorRecord {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<SparseRecord>,
}

#[derive(Debug, Deserialize)]
pub(super) struct SparseRecord {
    pub(super) count: usize,
    pub(super) indices: SparseList,
    pub(super) values: SparseList,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseList {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    /// Of indices alone.
    pub(super) component_type: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct ViewRecord {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct BufferRecord {
    pub(super) uri: Option<String>,
}

/// Reads the document.
///
/// # Errors
/// [`Error::Input`] for what is no such document, [`Error::Unsupported`] for extensions that are not understood; those of the budget.
pub(super) fn read_document(name: &str, text: &[u8], budget: &Budget) -> Result<Document> {
    budget.spend(PER_BYTE * text.len() as u64)?;
    let _held = budget.hold("the document of the glTF file", text.len().saturating_mul(GROWTH))?;
    let document: Document = serde_json::from_slice(text)
        .map_err(|e| Error::input(format!("{name}: its JSON"), e.to_string(), "write the file again; it is damaged"))?;
    let limit = ("nodes", budget.limits().nodes);
    for (what, count) in [
        ("nodes", document.nodes.len()),
        ("meshes", document.meshes.len()),
        ("materials", document.materials.len()),
        ("images", document.images.len()),
    ] {
        budget.within(&format!("{name}: {what}"), count, limit)?;
    }
    let known = |e: &String| UNDERSTOOD.contains(&e.as_str()) || e.starts_with(PAINT);
    match document.extensions_required.iter().find(|e| !known(e)) {
        None => Ok(document),
        Some(extension) => Err(Error::Unsupported {
            what: format!("{name}: the extension {}, which the file requires,", crate::text::short::short(extension)),
            advice: "save it as GLB without compression and without that extension".into(),
        }),
    }
}
