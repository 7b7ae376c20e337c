//! How meshes look: runs of triangles with a material, and materials with their textures and pictures.

use std::{collections::BTreeMap, ops::Range, sync::Arc};

use serde_json::Value;

use super::super::colour::srgb;

/// What the vertices of a primitive have beside places and normals; empty lists for what they do not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Two sets of texture coordinates: from 0 at the left to 1 at the right, and from 0 at the top to 1 at the bottom.
    pub uv: [Vec<[f32; 2]>; 2],
    /// Directions in which the first texture coordinate grows, and 1 or -1 for the side of the other.
    pub tangents: Vec<[f32; 4]>,
    /// Light red, green and blue, and opacity, by which the colour of the material is multiplied.
    pub colours: Vec<[f32; 4]>,
}

/// A run of triangles of a mesh that look alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Primitive {
    /// The triangles.
    pub triangles: Range<usize>,
    /// The vertices among which their corners are.
    pub vertices: Range<usize>,
    /// Index into [`Looks::materials`].
    pub material: Option<usize>,
    /// A value for each of `vertices`. Primitives of the same vertices share them.
    pub attributes: Arc<Attributes>,
}

/// How what lies behind is seen through a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Alpha {
    /// Not at all.
    #[default]
    Opaque,
    /// Where the opacity is below the number.
    Mask(f64),
    /// As much as is not opaque.
    Blend,
}

/// What a texture of a material says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Colour and opacity.
    BaseColour,
    /// Metalness in blue and roughness in green.
    MetallicRoughness,
    /// Normals.
    Normal,
    /// How much of the light around arrives, in red.
    Occlusion,
    /// Light that is sent out.
    Emissive,
}

/// Every slot in the order of [`Material::textures`].
pub const SLOTS: [Slot; 5] = [Slot::BaseColour, Slot::MetallicRoughness, Slot::Normal, Slot::Occlusion, Slot::Emissive];

/// A texture as a material uses it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextureUse {
    /// Index into [`Looks::textures`].
    pub texture: usize,
    /// Which set of texture coordinates it lies on.
    pub uv: u32,
    /// How strong it is, for normals and occlusion.
    pub strength: Option<f64>,
    /// `KHR_texture_transform`, as the file has it.
    pub transform: Option<Value>,
}

/// A surface as light meets it, by metalness and roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What the file calls it.
    pub name: String,
    /// Light red, green and blue, and opacity.
    pub base_colour: [f64; 4],
    /// From 0 to 1.
    pub metallic: f64,
    /// From 0 to 1.
    pub roughness: f64,
    /// Light that is sent out.
    pub emissive: [f64; 3],
    /// How it is seen through.
    pub alpha: Alpha,
    /// Whether triangles are seen from both sides.
    pub double_sided: bool,
    /// The textures, in the order of [`SLOTS`].
    pub textures: [Option<TextureUse>; 5],
    /// Extensions `KHR_materials_*`, as the file has them, but for the numbers of textures, which are indices into [`Looks::textures`].
    pub extensions: BTreeMap<String, Value>,
}

impl Default for Material {
    /// White, without metal, fairly rough.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_colour: [1.0; 4],
            metallic: 0.0,
            roughness: 0.8,
            emissive: [0.0; 3],
            alpha: Alpha::Opaque,
            double_sided: false,
            textures: Default::default(),
            extensions: BTreeMap::new(),
        }
    }
}

impl Material {
    /// The colour that a screen is given for it, without textures.
    pub fn screen_colour(&self) -> [f64; 3] {
        let [r, g, b, _] = self.base_colour;
        [r, g, b].map(srgb)
    }

    /// The texture of a slot.
    pub fn texture(&self, slot: Slot) -> Option<&TextureUse> {
        self.textures[slot as usize].as_ref()
    }

    /// Numbers of the textures that it uses, also in extensions.
    pub fn used_textures(&self) -> Vec<usize> {
        let mut used: Vec<usize> = self.textures.iter().flatten().map(|t| t.texture).collect();
        for extension in self.extensions.values() {
            collect(extension, &mut used);
        }
        used
    }

    /// The same with other numbers of textures; those that `number` does not know are left out.
    #[must_use]
    pub fn renumbered(&self, number: &dyn Fn(usize) -> Option<usize>) -> Self {
        let mut material = self.clone();
        for slot in &mut material.textures {
            *slot = slot.take().and_then(|used| Some(TextureUse { texture: number(used.texture)?, ..used }));
        }
        for extension in material.extensions.values_mut() {
            renumber(extension, number);
        }
        material
    }
}

/// The number of a texture that an entry of an extension uses.
fn texture_in(key: &str, entry: &Value) -> Option<usize> {
    let index = key.ends_with("Texture").then(|| entry.get("index"))??;
    index.as_u64().map(|n| usize::try_from(n).unwrap_or(usize::MAX))
}

fn collect(value: &Value, used: &mut Vec<usize>) {
    for (key, entry) in value.as_object().into_iter().flatten() {
        used.extend(texture_in(key, entry));
        collect(entry, used);
    }
}

fn renumber(value: &mut Value, number: &dyn Fn(usize) -> Option<usize>) {
    let Some(entries) = value.as_object_mut() else { return };
    entries.retain(|key, entry| match texture_in(key, entry) {
        None => {
            renumber(entry, number);
            true
        }
        Some(old) => match number(old) {
            Some(new) => {
                entry["index"] = new.into();
                true
            }
            None => false,
        },
    });
}

/// How a texture is looked up between and beyond its pixels, in the numbers of the format glTF; `None` for what is left to the viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sampler {
    /// How it is enlarged: 9728 or 9729.
    pub enlarging: Option<u32>,
    /// How it is reduced: 9728, 9729, or 9984 to 9987.
    pub reducing: Option<u32>,
    /// How it goes on to the left and right: 33071, 33648 or 10497.
    pub wrap_s: Option<u32>,
    /// How it goes on above and below, likewise.
    pub wrap_t: Option<u32>,
}

/// A picture and how it is looked up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texture {
    /// What the file calls it.
    pub name: String,
    /// Index into [`Looks::pictures`].
    pub picture: Option<usize>,
    /// The same picture in another format: the extension that says so, and its index.
    pub other: Option<(String, usize)>,
    /// How it is looked up.
    pub sampler: Sampler,
}

/// A picture, as the bytes of its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// What the file calls it, or the name of the file that it is.
    pub name: String,
    /// Kind of its bytes: `image/png` or `image/jpeg` above all.
    pub mime: String,
    /// The bytes, shared by all that use them.
    pub bytes: Arc<[u8]>,
}

/// Materials, textures and pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Looks {
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures that materials use.
    pub textures: Vec<Texture>,
    /// Pictures of textures.
    pub pictures: Vec<Picture>,
}

impl Looks {
    /// Adds those of another scene: what is to be added to its numbers of materials.
    pub fn join(&mut self, other: &Self) -> usize {
        let [materials, textures, pictures] = [self.materials.len(), self.textures.len(), self.pictures.len()];
        self.materials.extend(other.materials.iter().map(|m| m.renumbered(&|n| Some(n + textures))));
        self.textures.extend(other.textures.iter().map(|t| Texture {
            picture: t.picture.map(|n| n + pictures),
            other: t.other.clone().map(|(extension, n)| (extension, n + pictures)),
            ..t.clone()
        }));
        self.pictures.extend(other.pictures.iter().cloned());
        materials
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn material() -> Material {
        let mut material = Material { name: "wax".into(), ..Material::default() };
        material.textures[Slot::Normal as usize] = Some(TextureUse { texture: 1, ..TextureUse::default() });
        let coat = json!({ "clearcoatFactor": 1, "clearcoatTexture": { "index": 0 } });
        material.extensions.insert("KHR_materials_clearcoat".into(), coat);
        material
    }

    #[test]
    fn textures_of_extensions_are_counted_and_renumbered() {
        let material = material();
        assert_eq!(material.used_textures(), [1, 0]);
        let moved = material.renumbered(&|n| Some(n + 5));
        assert_eq!(moved.used_textures(), [6, 5]);
        let bare = material.renumbered(&|n| (n == 1).then_some(0));
        assert_eq!(bare.used_textures(), [0]);
        assert_eq!(bare.extensions["KHR_materials_clearcoat"], json!({ "clearcoatFactor": 1 }));
    }

    #[test]
    fn looks_of_two_scenes_stay_apart() {
        let texture = |n| Texture { picture: Some(n), ..Texture::default() };
        let one = Looks {
            materials: vec![material()],
            textures: vec![texture(0), texture(0)],
            pictures: vec![Picture::default()],
        };
        let mut both = one.clone();
        assert_eq!(both.join(&one), 1);
        assert_eq!(both.materials[1].used_textures(), [3, 2]);
        assert_eq!(both.textures[3].picture, Some(1));
    }
}
