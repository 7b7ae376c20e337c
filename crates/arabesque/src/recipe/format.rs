//! File formats of results.

use std::{path::Path, str::FromStr};

use arabesque_core::{Error, Result, suggest::did_you_mean};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// File format of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Vector drawing.
    Svg,
    /// Picture.
    Png,
    /// Placements.
    Json,
    /// Points with classes.
    Csv,
    /// Curves in space as polylines; ribbons as textured strips.
    Obj,
    /// Ribbons as textured strips, with their pictures; points and meshes.
    Glb,
    /// The same as GLB, as text with its bytes inside it.
    Gltf,
    /// Points with attributes, and meshes.
    Ply,
    /// Scenes of meshes as USD text.
    Usda,
    /// The recipe alone.
    Toml,
}

impl Format {
    /// Every format, by name.
    pub const ALL: [(&'static str, Self); 10] = [
        ("svg", Self::Svg),
        ("png", Self::Png),
        ("json", Self::Json),
        ("csv", Self::Csv),
        ("obj", Self::Obj),
        ("glb", Self::Glb),
        ("gltf", Self::Gltf),
        ("ply", Self::Ply),
        ("usda", Self::Usda),
        ("toml", Self::Toml),
    ];

    /// The format that the extension of a path stands for.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an extension that no format has.
    pub fn of_path(path: &str) -> Result<Option<Self>> {
        match Path::new(path).extension().and_then(|e| e.to_str()) {
            Some(extension) => extension.parse().map(Some),
            None => Ok(None),
        }
    }

    /// The name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, f)| *f == self).map_or("svg", |(name, _)| name)
    }
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let lower = text.to_ascii_lowercase();
        Self::ALL.iter().find(|(name, _)| *name == lower).map(|(_, f)| *f).ok_or_else(|| {
            let names = Self::ALL.map(|(name, _)| name);
            let hint = did_you_mean(&lower, names);
            Error::parameter("output format", text, format!("one of {}{hint}", names.join(", ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_choose_the_format() {
        assert_eq!(Format::of_path("a/b.SVG").unwrap(), Some(Format::Svg));
        assert_eq!(Format::of_path("-").unwrap(), None);
        assert!(Format::of_path("a.swg").unwrap_err().to_string().contains("did you mean svg"));
    }
}
