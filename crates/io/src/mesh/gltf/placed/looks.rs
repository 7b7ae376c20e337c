//! How elements of a scene look, and look from now on.

use std::{collections::BTreeMap, ops::Range};

use arabesque_core::{Decimals, Error, Result};
use serde_json::{Value, json};

use crate::{
    mesh::colour::linear,
    placed::{layout::Paint, splice::Splices},
};

/// What to do about a scene that is none of ours.
pub(super) const ADVICE: &str = "edit a scene as arabesque wrote it";

/// Meshes and materials of a scene, and those that are new.
pub(super) struct Looks {
    meshes: Vec<Value>,
    materials: Vec<Value>,
    /// How many there were.
    known: [usize; 2],
    painted: BTreeMap<(usize, Vec<Paint>), usize>,
}

impl Looks {
    /// Those that stand in two places of a document.
    pub(super) fn new(text: &str, meshes: &Range<usize>, materials: Option<&Range<usize>>) -> Result<Self> {
        let list = |range: &Range<usize>| {
            serde_json::from_str::<Vec<Value>>(&text[range.clone()])
                .map_err(|e| Error::input("scene", e.to_string(), ADVICE))
        };
        let meshes = list(meshes)?;
        let materials = materials.map(list).transpose()?.unwrap_or_default();
        Ok(Self { known: [meshes.len(), materials.len()], meshes, materials, painted: BTreeMap::new() })
    }

    /// The mesh that looks like another, painted.
    pub(super) fn painted(&mut self, mesh: usize, paint: &[Paint]) -> Result<usize> {
        if paint.is_empty() || mesh >= self.meshes.len() {
            return Ok(mesh);
        }
        let key = (mesh, paint.to_vec());
        if let Some(known) = self.painted.get(&key) {
            return Ok(*known);
        }
        let mut new = self.meshes[mesh].clone();
        for primitive in new["primitives"].as_array_mut().into_iter().flatten() {
            let own =
                primitive["material"].as_u64().and_then(|n| self.materials.get(usize::try_from(n).ok()?)).cloned();
            let material = material(own.unwrap_or_else(|| json!({})), paint)?;
            if paint.iter().any(|paint| paint.property == "fill") {
                // Colours of corners would be multiplied with it.
                primitive["attributes"].as_object_mut().map(|attributes| attributes.remove("COLOR_0"));
            }
            let number = found_or_added(&mut self.materials, material);
            primitive["material"] = number.into();
        }
        let number = found_or_added(&mut self.meshes, new);
        self.painted.insert(key, number);
        Ok(number)
    }

    /// Appends what is new to the lists of the document.
    pub(super) fn write(&self, of_meshes: &Range<usize>, of_materials: Option<&Range<usize>>, splices: &mut Splices) {
        let text = |list: &[Value]| list.iter().map(Value::to_string).collect::<Vec<_>>().join(",");
        let [meshes, materials] = self.known;
        if self.meshes.len() > meshes {
            let end = of_meshes.end - 1;
            splices.put(end..end, format!(",{}", text(&self.meshes[meshes..])));
        }
        if self.materials.len() > materials {
            let new = text(&self.materials[materials..]);
            match of_materials {
                Some(range) => {
                    let comma = if materials > 0 { "," } else { "" };
                    splices.put(range.end - 1..range.end - 1, format!("{comma}{new}"));
                }
                None => splices.put(of_meshes.end..of_meshes.end, format!(",\"materials\":[{new}]")),
            }
        }
    }
}

fn found_or_added(list: &mut Vec<Value>, new: Value) -> usize {
    list.iter().position(|known| *known == new).unwrap_or_else(|| {
        list.push(new);
        list.len() - 1
    })
}

/// A material in another colour.
fn material(mut material: Value, paint: &[Paint]) -> Result<Value> {
    let known = material["pbrMetallicRoughness"]["baseColorFactor"].as_array().cloned().unwrap_or_default();
    let mut colour: [f64; 4] = std::array::from_fn(|k| known.get(k).and_then(Value::as_f64).unwrap_or(1.0));
    for Paint { property, value } in paint {
        match property.as_str() {
            "fill" => {
                let Ok(new) = value.parse::<svgtypes::Color>() else {
                    return Err(Error::parameter("fill", value, "a colour such as #c0392b"));
                };
                for (part, byte) in colour.iter_mut().zip([new.red, new.green, new.blue]) {
                    *part = Decimals::for_extent(1.0).round(linear(f64::from(byte) / 255.0));
                }
                if let Some(look) = material["pbrMetallicRoughness"].as_object_mut() {
                    look.remove("baseColorTexture");
                }
            }
            "opacity" | "fill-opacity" => colour[3] = value.trim().parse().unwrap_or(1.0),
            other => {
                return Err(Error::Unsupported {
                    what: format!("{other} of a mesh"),
                    advice: "set fill or opacity".into(),
                });
            }
        }
    }
    material["pbrMetallicRoughness"]["baseColorFactor"] = json!(colour);
    if colour[3] < 1.0 {
        material["alphaMode"] = "BLEND".into();
    }
    Ok(material)
}
