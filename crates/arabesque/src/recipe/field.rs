//! Where the values of a field come from.

use std::{borrow::Cow, fmt};

use arabesque_core::{Error, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};

use crate::recipe::input::Input;

/// Where the values of a field come from.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FieldSource {
    /// The same value everywhere.
    Constant(f64),
    /// A file.
    File(FieldFile),
}

/// A picture, or for directions strokes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FieldFile {
    /// Values of black and of white, for a picture of scale or density. Default: 0.5 and 2 for scale, 0.2 and 1 for density.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// The file.
    pub file: Input,
}

/// Accepts a number, a path or a table.
struct AnyField;

impl<'de> serde::de::Visitor<'de> for AnyField {
    type Value = FieldSource;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a path, or a table with a file")
    }

    fn visit_f64<E: serde::de::Error>(self, v: f64) -> std::result::Result<FieldSource, E> {
        Ok(FieldSource::Constant(v))
    }

    fn visit_i64<E: serde::de::Error>(self, v: i64) -> std::result::Result<FieldSource, E> {
        Ok(FieldSource::Constant(v as f64))
    }

    fn visit_u64<E: serde::de::Error>(self, v: u64) -> std::result::Result<FieldSource, E> {
        Ok(FieldSource::Constant(v as f64))
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> std::result::Result<FieldSource, E> {
        FieldSource::parse(text).map_err(|e| E::custom(e))
    }

    fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> std::result::Result<FieldSource, A::Error> {
        FieldFile::deserialize(serde::de::value::MapAccessDeserializer::new(map)).map(FieldSource::File)
    }
}

impl<'de> Deserialize<'de> for FieldSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(AnyField)
    }
}

impl JsonSchema for FieldSource {
    fn schema_name() -> Cow<'static, str> {
        "FieldSource".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<FieldFile>();
        let text = "a path, with @LOW..HIGH where black and white have other values than usual";
        json_schema!({ "anyOf": [{ "type": "number" }, { "type": "string", "description": text }, table] })
    }
}

impl FieldSource {
    /// A field as people write it: `30` or `30deg`, `strokes.svg`, `picture.png`, or `picture.png@0.5..2` with the values of black and white.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it is empty or the range is none.
    pub fn parse(text: &str) -> Result<Self> {
        let number = text.trim();
        let degrees = number.strip_suffix("deg").or_else(|| number.strip_suffix('°'));
        if let Ok(value) = degrees.map_or(number, str::trim).parse::<f64>() {
            return Ok(Self::Constant(value));
        }
        if text.trim().is_empty() {
            return Err(Error::parameter("field", "\"\"", "a number or a file"));
        }
        let range = text.rsplit_once('@').and_then(|(path, range)| Some((path, range.split_once("..")?)));
        let Some((path, (black, white))) = range else {
            return Ok(Self::File(FieldFile { range: None, file: Input::file(text) }));
        };
        let number = |t: &str| {
            t.trim().parse::<f64>().map_err(|_| Error::parameter("field", text, "a range such as picture.png@0.5..2"))
        };
        Ok(Self::File(FieldFile { range: Some([number(black)?, number(white)?]), file: Input::file(path) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_numbers_or_files_with_a_range() {
        for text in [" 30 ", "30deg", "30°"] {
            assert_eq!(FieldSource::parse(text).unwrap(), FieldSource::Constant(30.0));
        }
        let ranged = FieldFile { range: Some([0.5, 2.0]), file: Input::file("a@b.png") };
        assert_eq!(FieldSource::parse("a@b.png@0.5..2").unwrap(), FieldSource::File(ranged));
        for text in ["", " ", "a.png@x..2"] {
            assert!(FieldSource::parse(text).is_err(), "{text}");
        }
    }
}
