//! Files that a recipe refers to, with their content where it is small.

use std::{borrow::Cow, fmt};

use arabesque_core::{Error, Result};
use arabesque_io::file;
use base64::{
    Engine as _, alphabet,
    engine::{
        DecodePaddingMode,
        general_purpose::{GeneralPurpose, GeneralPurposeConfig, STANDARD},
    },
};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};

/// Content up to this size travels inside the recipe. In bytes.
pub const EMBEDDED_BYTES: usize = 1 << 20;

/// A file that a run reads. In a recipe a path alone stands for it too, such as `leaves.svg` or `shape.svg#heart`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Input {
    /// Where it was: relative to the file that holds the recipe, or to the working folder.
    pub path: String,
    /// The one item of the file that counts, by its id.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Fingerprint of the content (FNV-1a, 128 bits): a changed file is noticed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hash: Option<String>,
    /// How `content` is written; plain text when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoding: Option<Encoding>,
    /// The content itself; when absent the file is read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
}

/// An [`Input`] written out as a table.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Table {
    /// Where it is: relative to the file that holds the recipe, or to the working folder.
    path: String,
    /// The one item of the file that counts, by its id.
    #[serde(default)]
    id: Option<String>,
    /// Fingerprint of the content (FNV-1a, 128 bits): a changed file is noticed.
    #[serde(default)]
    hash: Option<String>,
    /// How `content` is written; plain text when absent.
    #[serde(default)]
    encoding: Option<Encoding>,
    /// The content itself; when absent the file is read.
    #[serde(default)]
    content: Option<String>,
}

/// Accepts a path alone in place of a table.
struct PathOrTable;

impl<'de> Visitor<'de> for PathOrTable {
    type Value = Input;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a path, or a table with a path")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> std::result::Result<Input, E> {
        Ok(Input::shape(text))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<Input, A::Error> {
        let Table { path, id, hash, encoding, content } = Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Input { path, id, hash, encoding, content })
    }
}

impl<'de> Deserialize<'de> for Input {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(PathOrTable)
    }
}

impl JsonSchema for Input {
    fn schema_name() -> Cow<'static, str> {
        "Input".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<Table>();
        json_schema!({ "anyOf": [{ "type": "string", "description": "a path, with #ID where one item of the file counts" }, table] })
    }
}

/// How content is written in a recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// RFC 4648 base 64.
    Base64,
}

impl Input {
    /// The file at `path`.
    pub fn file(path: impl Into<String>) -> Self {
        Self { path: path.into(), ..Self::default() }
    }

    /// A shape as `FILE.svg` or `FILE.svg#id`.
    pub fn shape(text: &str) -> Self {
        match text.rsplit_once('#') {
            Some((path, id)) if !path.is_empty() && !id.is_empty() => {
                Self { path: path.to_owned(), id: Some(id.to_owned()), ..Self::default() }
            }
            _ => Self::file(text),
        }
    }

    /// The content that the recipe itself holds.
    ///
    /// # Errors
    /// [`Error::Input`] when it is not what `encoding` says.
    pub(crate) fn held(&self) -> Result<Option<Vec<u8>>> {
        match (&self.content, self.encoding) {
            (None, _) => Ok(None),
            (Some(text), None) => Ok(Some(text.clone().into_bytes())),
            (Some(text), Some(Encoding::Base64)) => match decode(text) {
                Some(bytes) => Ok(Some(bytes)),
                None => Err(Error::input(self.name(), "broken base 64", "give the path alone")),
            },
        }
    }

    /// Refuses content that is not the one that the fingerprint was taken of.
    pub(crate) fn check(&self, bytes: &[u8]) -> Result<()> {
        let Some(wanted) = &self.hash else { return Ok(()) };
        let found = fingerprint(bytes);
        if *wanted == found {
            return Ok(());
        }
        Err(Error::input(
            self.name(),
            format!(
                "the file has changed since the recipe was written: its digest is {found}, and {wanted} was expected"
            ),
            "restore it, or remove the line `hash` from the recipe",
        ))
    }

    /// The name for messages.
    pub fn name(&self) -> &str {
        if file::is_standard_input(&self.path) { "standard input" } else { &self.path }
    }

    /// This input as a recipe carries it: with its fingerprint, and with its content where that is small or cannot be read twice.
    #[must_use]
    pub fn embedding(&self, bytes: &[u8]) -> Self {
        let mut kept = Self { hash: Some(fingerprint(bytes)), content: None, encoding: None, ..self.clone() };
        if bytes.len() > EMBEDDED_BYTES && !file::is_stream(&self.path) {
            return kept;
        }
        match std::str::from_utf8(bytes) {
            Ok(text) if text.chars().all(is_plain) => kept.content = Some(text.to_owned()),
            _ => {
                kept.content = Some(encode(bytes));
                kept.encoding = Some(Encoding::Base64);
            }
        }
        kept
    }
}

/// Whether a character comes back unchanged from TOML, XML and comment lines alike.
fn is_plain(c: char) -> bool {
    c == '\n'
        || c == '\t'
        || (!c.is_control() && !matches!(c, '\u{2028}' | '\u{2029}' | '\u{FFFE}' | '\u{FFFF}' | '\u{FEFF}'))
}

/// FNV-1a over the bytes: it tells files apart, it does not protect against forgery.
pub(crate) fn fingerprint(bytes: &[u8]) -> String {
    let start: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let hash =
        bytes.iter().fold(start, |h, &b| (h ^ u128::from(b)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013B));
    format!("{hash:032x}")
}

/// Reads base 64 without its padding, which is taken out beforehand together with line breaks.
const LENIENT: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::RequireNone),
);

pub(crate) fn encode(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// What base 64 stands for; white space and padding may be anywhere.
fn decode(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> = text.bytes().filter(|b| !b.is_ascii_whitespace() && *b != b'=').collect();
    LENIENT.decode(digits).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_round_trip() {
        assert_eq!(encode(b"Man"), "TWFu");
        assert_eq!(encode(b"Ma"), "TWE=");
        for n in 0..70_u8 {
            let bytes: Vec<u8> = (0..n).map(|k| k.wrapping_mul(37)).collect();
            assert_eq!(decode(&encode(&bytes)).unwrap(), bytes);
        }
        assert!(decode("a?b").is_none());
        assert_eq!(decode("TW\nFu TWE=").unwrap(), b"ManMa");
    }

    #[test]
    fn content_travels_and_changes_are_noticed() {
        for bytes in [&b"plain\ntext"[..], b"carriage\r\nreturn", &[0, 255, 7]] {
            let input = Input::file("nowhere.svg").embedding(bytes);
            assert_eq!(input.held().unwrap().unwrap(), bytes);
            assert!(input.check(bytes).is_ok());
        }
        let input = Input::file("nowhere.svg").embedding(b"one");
        assert!(input.check(b"two").unwrap_err().to_string().contains("has changed"));
    }

    #[test]
    fn large_content_stays_outside() {
        assert!(Input::file("x").embedding(&vec![b'a'; EMBEDDED_BYTES + 1]).content.is_none());
    }

    #[test]
    fn shapes_have_ids() {
        assert_eq!(Input::shape("a.svg#heart").id.as_deref(), Some("heart"));
        assert_eq!(Input::shape("a.svg").id, None);
    }
}
