//! Materials, textures and pictures of a glTF file.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Error, Result, Warning};
use serde_json::value::RawValue;

use super::{
    accessor::Binary,
    buffers::{Sources, mime_of},
    document::{ImageRecord, MaterialRecord, PAINT, TextureInfo, TextureRecord},
    extras::value_of,
};
use crate::mesh::scene::{Alpha, Looks, Material, Picture, Sampler, Texture, TextureUse};

/// Work of one of them.
const PER_RECORD: u64 = 2000;
/// Extensions by which a texture has its picture in another format.
const OTHERS: [&str; 3] = ["KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif"];
/// What the format calls the moving of textures.
const TRANSFORM: &str = "KHR_texture_transform";

/// Reads how things look. Pictures that cannot be read are left out with a warning: the rest of the scene stands without them.
///
/// # Errors
/// [`Error::Limit`] for too many bytes, and those of the budget.
pub(super) fn looks(binary: &Binary<'_>, sources: &mut Sources<'_>) -> Result<(Looks, Vec<Warning>)> {
    let document = binary.document;
    let count = document.materials.len() + document.textures.len() + document.images.len();
    binary.budget.spend(PER_RECORD.saturating_mul(count as u64))?;
    let mut reader = Reader { binary, sources, views: BTreeMap::new(), missing: Vec::new() };
    let pictures =
        document.images.iter().enumerate().map(|(n, image)| reader.picture(n, image)).collect::<Result<_>>()?;
    let textures = document.textures.iter().map(|texture| reader.texture(texture)).collect();
    let materials = document.materials.iter().map(|material| reader.material(material)).collect();
    let mut warnings = Vec::new();
    if let Some(first) = reader.missing.first() {
        let message = format!("{}: {} pictures are left out: {first}", binary.name, reader.missing.len());
        warnings.push(Warning::new(message, "save the file with its pictures inside, as GLB"));
    }
    Ok((Looks { materials, textures, pictures }, warnings))
}

struct Reader<'a, 'b, 'c> {
    binary: &'b Binary<'a>,
    sources: &'b mut Sources<'c>,
    /// Pictures that are parts of buffers, by the number of the part.
    views: BTreeMap<usize, Arc<[u8]>>,
    /// What is wrong with pictures that are left out.
    missing: Vec<String>,
}

impl Reader<'_, '_, '_> {
    fn picture(&mut self, number: usize, image: &ImageRecord) -> Result<Picture> {
        let found = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match self.sources.bytes(&format!("image {number}"), uri) {
                Err(Error::Input { place, problem, .. }) => Err(format!("{place}: {problem}")),
                other => Ok(other?),
            },
            (None, Some(view)) => self.part(view)?.map_err(|problem| format!("image {number}: {problem}")),
            (None, None) => Err(format!("image {number} says neither where it is nor what it is")),
        };
        let bytes = found.unwrap_or_else(|problem| {
            self.missing.push(problem);
            Arc::default()
        });
        let said = image.mime_type.clone().or_else(|| mime_of(image.uri.as_deref()?).map(str::to_owned));
        let mime = kind_of(&bytes).map(str::to_owned).or(said).unwrap_or_default();
        let beside = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let name = image.name.as_deref().or(beside).unwrap_or_default().to_owned();
        Ok(Picture { name, mime, bytes })
    }

    fn part(&mut self, view: usize) -> Result<std::result::Result<Arc<[u8]>, String>> {
        if let Some(known) = self.views.get(&view) {
            return Ok(Ok(Arc::clone(known)));
        }
        let bytes = match self.binary.view(view) {
            Ok(bytes) => bytes,
            Err(problem) => return Ok(Err(problem)),
        };
        self.sources.hold(bytes.len())?;
        let bytes: Arc<[u8]> = bytes.into();
        self.views.insert(view, Arc::clone(&bytes));
        Ok(Ok(bytes))
    }

    fn texture(&self, record: &TextureRecord) -> Texture {
        let document = self.binary.document;
        let picture = |n: usize| Some(n).filter(|n| *n < document.images.len());
        let other = OTHERS.iter().find_map(|extension| {
            let source = value_of(record.extensions.get(*extension)?)?.get("source")?.as_u64()?;
            Some(((*extension).to_owned(), picture(usize::try_from(source).ok()?)?))
        });
        let sampler = record.sampler.and_then(|n| document.samplers.get(n));
        let one_of = |value: Option<u32>, known: &[u32]| value.filter(|v| known.contains(v));
        let sampler = sampler.map(|s| Sampler {
            enlarging: one_of(s.mag_filter, &[9728, 9729]),
            reducing: one_of(s.min_filter, &[9728, 9729, 9984, 9985, 9986, 9987]),
            wrap_s: one_of(s.wrap_s, &[33071, 33648, 10497]),
            wrap_t: one_of(s.wrap_t, &[33071, 33648, 10497]),
        });
        let name = record.name.clone().unwrap_or_default();
        Texture { name, picture: record.source.and_then(picture), other, sampler: sampler.unwrap_or_default() }
    }

    fn material(&self, record: &MaterialRecord) -> Material {
        let share = |value: Option<f64>, otherwise: f64| value.filter(|v| (0.0..=1.0).contains(v)).unwrap_or(otherwise);
        let info = |info: Option<&TextureInfo>| self.used(info?);
        let paint = record.pbr_metallic_roughness.as_ref();
        let colour = paint.and_then(|p| p.base_color_factor).unwrap_or([1.0; 4]);
        Material {
            name: record.name.clone().unwrap_or_default(),
            base_colour: colour.map(|c| share(Some(c), 1.0)),
            metallic: share(paint.and_then(|p| p.metallic_factor), 1.0),
            roughness: share(paint.and_then(|p| p.roughness_factor), 1.0),
            emissive: record.emissive_factor.unwrap_or_default().map(|c| share(Some(c), 0.0)),
            alpha: match record.alpha_mode.as_deref() {
                Some("MASK") => Alpha::Mask(record.alpha_cutoff.filter(|v| *v >= 0.0 && v.is_finite()).unwrap_or(0.5)),
                Some("BLEND") => Alpha::Blend,
                _ => Alpha::Opaque,
            },
            double_sided: record.double_sided,
            textures: [
                info(paint.and_then(|p| p.base_color_texture.as_ref())),
                info(paint.and_then(|p| p.metallic_roughness_texture.as_ref())),
                info(record.normal_texture.as_ref()),
                info(record.occlusion_texture.as_ref()),
                info(record.emissive_texture.as_ref()),
            ],
            extensions: self.extensions(&record.extensions),
        }
    }

    fn used(&self, info: &TextureInfo) -> Option<TextureUse> {
        if info.index >= self.binary.document.textures.len() {
            return None;
        }
        let transform =
            info.extensions.get(TRANSFORM).and_then(|raw| value_of(raw)).filter(serde_json::Value::is_object);
        let strength = info.scale.or(info.strength).filter(|v| v.is_finite());
        Some(TextureUse { texture: info.index, uv: info.tex_coord, strength, transform })
    }

    fn extensions(&self, extensions: &BTreeMap<String, Box<RawValue>>) -> BTreeMap<String, serde_json::Value> {
        let textures = self.binary.document.textures.len();
        let known = extensions.iter().filter(|(name, _)| name.starts_with(PAINT));
        let found =
            known.filter_map(|(name, raw)| Some((name.clone(), value_of(raw).filter(serde_json::Value::is_object)?)));
        let material = Material { extensions: found.collect(), ..Material::default() };
        material.renumbered(&|n| (n < textures).then_some(n)).extensions
    }
}

/// The kind of a picture by how its bytes begin.
fn kind_of(bytes: &[u8]) -> Option<&'static str> {
    let known: [(&[u8], &str); 3] = [
        (b"\x89PNG\r\n\x1a\n", "image/png"),
        (b"\xff\xd8\xff", "image/jpeg"),
        (b"\xabKTX 20\xbb\r\n\x1a\n", "image/ktx2"),
    ];
    let webp = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
    let avif = bytes.get(4..12) == Some(b"ftypavif");
    let by_magic = known.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, kind)| kind);
    by_magic.or(webp.then_some("image/webp")).or(avif.then_some("image/avif"))
}
