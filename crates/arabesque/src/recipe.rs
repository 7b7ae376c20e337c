//! Recipes: a run, described completely.
//!
//! A recipe is a TOML document. Every file that arabesque writes carries one, with small inputs inside it, so that the run can be repeated from
//! the result alone.

use std::{borrow::Cow, collections::BTreeMap, fmt};

use arabesque_core::{Border, Error, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};

use crate::{Format, Input, Region, RibbonRecipe, nearest};

/// A run, described completely: what to read, where to fill, how, and what to write.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of arabesque that the recipe was written by.
    #[serde(default = "version")]
    pub arabesque: String,
    /// Seed of all random choices. Default: 0.
    #[serde(default)]
    pub seed: u64,
    /// Width and height of the page, such as `800x600` or `210mmx297mm`. One of `size`, `tile` and `domain` may be given; with none of
    /// them the layer Domain of the exemplar is filled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<String>,
    /// Width and height of a seamless tile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<String>,
    /// Width, depth and height of the box in space to fill, such as `10x10x5`, for an exemplar in space: curves (OBJ) or points (CSV
    /// with a column z). In place of `size`, `tile` and `domain`.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<String>,
    /// What happens at the border of the domain. Default: clip; where a region of a drawing of elements alone is made anew, cross.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border: Option<BorderRule>,
    /// What open strokes are taken for. Default: auto.
    #[serde(default)]
    pub method: Method,
    /// Named set of parameters. Default: `default`.
    #[serde(default = "default_preset")]
    pub preset: String,
    /// Neighbourhood radius, in the exemplar's units. Default: chosen from the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Levels of the hierarchy. Default: as the preset has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub levels: Option<usize>,
    /// Iterations a level. Default: as the preset has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub iterations: Option<usize>,
    /// The exemplar.
    pub exemplar: Input,
    /// A file with the shape to fill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Input>,
    /// Elements and strokes that stay where they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<Input>,
    /// The region of the exemplar's own file that is made anew; everything else of the file stays. In place of `size`, `tile` and `domain`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redo: Option<Region>,
    /// The region of the exemplar's file whose pattern is continued in the region `to`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Region>,
    /// The region of the exemplar's file that is filled with the pattern of the region `from`; everything else of the file stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<Region>,
    /// How the pattern is turned: degrees from x towards y (clockwise on the page), a picture, or strokes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orient: Option<FieldSource>,
    /// Size of the pattern relative to the exemplar, elements and gaps alike: a number, or a picture. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<FieldSource>,
    /// Elements per area relative to the exemplar: a number, or a picture. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<FieldSource>,
    /// Shapes that stay empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub avoid: Vec<Input>,
    /// Single parameters by name, as `--set` has them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "plain_values")]
    pub set: BTreeMap<String, String>,
    /// Lay the pattern of a picture along curves, instead of filling a domain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ribbon: Option<RibbonRecipe>,
    /// What to write.
    #[serde(default)]
    pub output: OutputOptions,
}

/// What to write.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputOptions {
    /// Where to write it, when the command line does not say. Not kept in results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// File format. Default: by the extension of the path, else SVG.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<Format>,
    /// SVG: write every element out in place instead of linking to it. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub expand: bool,
    /// PNG: pixels an inch. Default: 96.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dpi: Option<f64>,
    /// PNG: pixels a user unit, instead of `dpi`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixels_per_unit: Option<f64>,
    /// Leave the recipe out of the file. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub bare: bool,
}

/// What happens where elements meet the border of the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BorderRule {
    /// Elements lie wholly inside.
    Inside,
    /// Elements with their centre inside stay whole and may reach over the border.
    Cross,
    /// Whatever reaches into the domain is drawn, cut at the border.
    #[default]
    Clip,
    /// Strokes turn at the border and run along it; elements lie wholly inside.
    Turn,
}

impl From<BorderRule> for Border {
    fn from(rule: BorderRule) -> Self {
        match rule {
            BorderRule::Inside => Self::Inside,
            BorderRule::Cross => Self::Cross,
            BorderRule::Clip => Self::Clip,
            BorderRule::Turn => Self::Turn,
        }
    }
}

/// What the exemplar is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// The exemplar decides: filled shapes and groups are elements, open strokes and the net that they belong to are curves.
    #[default]
    Auto,
    /// Every connected piece is an element.
    Elements,
    /// Every stroke without a fill is a curve; what is filled is an element.
    Curves,
    /// Repetitive structures; not yet handled.
    Structures,
}

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

fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

fn default_preset() -> String {
    "default".to_owned()
}

impl Recipe {
    /// A recipe for `exemplar` with everything else at its default.
    pub fn new(exemplar: Input) -> Self {
        Self {
            arabesque: version(),
            seed: 0,
            size: None,
            tile: None,
            cuboid: None,
            border: None,
            method: Method::default(),
            preset: default_preset(),
            radius: None,
            levels: None,
            iterations: None,
            exemplar,
            domain: None,
            keep: None,
            redo: None,
            from: None,
            to: None,
            orient: None,
            scale: None,
            density: None,
            avoid: Vec::new(),
            set: BTreeMap::new(),
            ribbon: None,
            output: OutputOptions::default(),
        }
    }

    /// Reads a recipe from TOML.
    ///
    /// # Errors
    /// [`Error::Input`] with the line: no TOML, a missing or unknown key (the nearest known one is named), a value of the wrong kind.
    pub fn from_toml(name: &str, text: &str) -> Result<Self> {
        toml::from_str(text).map_err(|e| {
            let line = e.span().and_then(|span| text.get(..span.start)).map(|before| before.matches('\n').count() + 1);
            let place = line.map_or_else(|| name.to_owned(), |n| format!("{name}: line {n}"));
            let message = e.message().replace('\n', " ");
            let advice = meant(&message).map_or_else(
                || "see `arabesque fill --help` for what a recipe can say".to_owned(),
                |known| format!("did you mean `{known}`?"),
            );
            Error::input(place, message, advice)
        })
    }

    /// The recipe as TOML.
    ///
    /// # Errors
    /// [`Error::Input`] when a value has no form in TOML, such as a seed beyond 2^63.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string_pretty(self)
            .map_err(|e| Error::input("recipe", e.to_string(), "use a seed below 9223372036854775808"))
    }

    /// The JSON schema of recipes.
    pub fn schema() -> String {
        let schema = schemars::schema_for!(Recipe);
        serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
    }
}

/// The known key nearest to the unknown one that a message of the parser names first.
fn meant(message: &str) -> Option<&str> {
    if !message.contains("unknown") {
        return None;
    }
    let mut quoted = message.split('`').skip(1).step_by(2);
    let unknown = quoted.next()?;
    nearest(unknown, quoted)
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
    /// A field as people write it: `30`, `strokes.svg`, `picture.png`, or `picture.png@0.5..2` with the values of black and white.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it is empty or the range is none.
    pub fn parse(text: &str) -> Result<Self> {
        if let Ok(value) = text.trim().parse::<f64>() {
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

/// Numbers, strings and truth values of a table, as the text that `--set` would have.
fn plain_values<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<BTreeMap<String, String>, D::Error> {
    let table = BTreeMap::<String, toml::Value>::deserialize(deserializer)?;
    let plain = table.into_iter().map(|(name, value)| match value {
        toml::Value::String(text) => Ok((name, text)),
        toml::Value::Integer(_) | toml::Value::Float(_) | toml::Value::Boolean(_) => Ok((name, value.to_string())),
        _ => Err(serde::de::Error::custom(format!("`{name}` must be a number, a string or a truth value"))),
    });
    plain.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_recipe_is_enough() {
        let recipe = Recipe::from_toml(
            "r.toml",
            "size = \"210mmx297mm\"\nexemplar = \"leaves.svg\"\navoid = [\"a.svg#b\"]\nscale = 2\norient = \"flow.svg\"\n[set]\nlevels = 2\nmatching = \"hard\"\n",
        )
        .unwrap();
        assert_eq!(recipe.exemplar.path, "leaves.svg");
        assert_eq!(recipe.scale, Some(FieldSource::Constant(2.0)));
        assert_eq!(recipe.avoid, [Input::shape("a.svg#b")]);
        assert_eq!(recipe.set["levels"], "2");
        assert!(matches!(recipe.orient, Some(FieldSource::File(f)) if f.file.path == "flow.svg"));
    }

    #[test]
    fn recipes_survive_being_written() {
        let mut recipe = Recipe::new(Input::file("a.svg").carrying(b"<svg>\n'''\"\"\"]]>\\ \x09</svg>\n"));
        recipe.tile = Some("400x400".into());
        recipe.orient = Some(FieldSource::Constant(30.0));
        recipe.density = Some(FieldSource::parse("map.png@0.1..0.9").unwrap());
        recipe.avoid = vec![Input::shape("logo.svg#mark")];
        recipe.set.insert("search".into(), "exhaustive".into());
        recipe.output = OutputOptions { expand: true, dpi: Some(300.0), ..OutputOptions::default() };
        let text = recipe.to_toml().unwrap();
        assert_eq!(Recipe::from_toml("again", &text).unwrap(), recipe, "{text}");
    }

    #[test]
    fn unknown_keys_are_refused_with_the_nearest() {
        for (text, line, near) in [
            ("sede = 1\nexemplar = \"a\"\n", "line 1", "`seed`"),
            ("exemplar = \"a\"\n[output]\nexpend = true\n", "line 3", "`expand`"),
            ("exemplar = { pth = \"a\" }\n", "line 1", "`path`"),
            ("exemplar = \"a\"\nborder = \"clop\"\n", "line 2", "`clip`"),
        ] {
            let message = Recipe::from_toml("r.toml", text).unwrap_err().to_string();
            assert!(message.contains(line) && message.contains(near), "{message}");
        }
        assert!(Recipe::from_toml("r.toml", "seed = 1\n").unwrap_err().to_string().contains("exemplar"));
        assert!(Recipe::from_toml("r.toml", "seed = ").is_err());
    }

    #[test]
    fn the_schema_names_every_key() {
        let schema = Recipe::schema();
        for key in ["exemplar", "tile", "pixels_per_unit", "range", "hash"] {
            assert!(schema.contains(&format!("\"{key}\"")), "{key}");
        }
    }
}
