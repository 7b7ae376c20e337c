//! Parameters of an engine by name.

use std::collections::BTreeMap;

use arabesque_core::options::{Kind, ParamSpec};
use arabesque_patterns::Params;
use arabesque_reliefs::ReliefParams;
use arabesque_ribbons::RibbonParams;
use arabesque_structures::StructureParams;
use arabesque_surface::SurfaceParams;
use schemars::{Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The key that names the preset.
const PRESET: &str = "preset";

/// Parameters of an engine, as `--preset` and `--set` have them. In a recipe one table, in which `preset` stands beside the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parameters {
    /// Named set of parameters to start from. Default: `default`.
    pub preset: Option<String>,
    /// Single parameters by name.
    pub set: BTreeMap<String, String>,
}

impl Parameters {
    /// Whether everything is at its default.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The parameters of the engine for elements and curves.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Parameter`] for an unknown preset or name, or a value out of range.
    pub fn engine_params(&self) -> arabesque_core::Result<Params> {
        let mut params = Params::preset(self.preset.as_deref().unwrap_or("default"))?;
        self.set.iter().try_for_each(|(name, value)| params.set(name, value))?;
        Ok(params)
    }
}

impl Serialize for Parameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let preset = self.preset.iter().map(|name| (PRESET, name));
        serializer.collect_map(preset.chain(self.set.iter().map(|(name, value)| (name.as_str(), value))))
    }
}

impl<'de> Deserialize<'de> for Parameters {
    /// Numbers, strings and truth values of a table, as the text that `--set` would have.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut set = plain_values(deserializer)?;
        let preset = set.remove(PRESET);
        Ok(Self { preset, set })
    }
}

/// Numbers, strings and truth values of a table, as text.
pub(in crate::recipe) fn plain_values<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, String>, D::Error> {
    let table = BTreeMap::<String, toml::Value>::deserialize(deserializer)?;
    let plain = table.into_iter().map(|(name, value)| match value {
        toml::Value::String(text) => Ok((name, text)),
        toml::Value::Integer(_) | toml::Value::Float(_) | toml::Value::Boolean(_) => Ok((name, value.to_string())),
        _ => Err(serde::de::Error::custom(format!("`{name}` must be a number, a string or a truth value"))),
    });
    plain.collect()
}

/// The schema of the parameters of the engine for elements and curves.
pub(super) fn of_patterns(_: &mut SchemaGenerator) -> Schema {
    let names = Params::PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>();
    let help = "Named set of parameters to start from. Default: default.";
    let preset = json_schema!({ "description": help, "type": "string", "enum": names });
    table(Params::specs(), [(PRESET, preset)])
}

/// The schema of the parameters of ribbons.
pub(super) fn of_ribbons(_: &mut SchemaGenerator) -> Schema {
    table(RibbonParams::specs().into_iter().filter(|spec| !spec.own_option), [])
}

/// The schema of the parameters of structures.
pub(super) fn of_structures(_: &mut SchemaGenerator) -> Schema {
    table(StructureParams::specs(), [])
}

/// The schema of the parameters of reliefs.
pub(super) fn of_reliefs(_: &mut SchemaGenerator) -> Schema {
    table(ReliefParams::specs(), [])
}

/// The schema of the parameters of surfaces.
pub(super) fn of_surfaces(_: &mut SchemaGenerator) -> Schema {
    table(SurfaceParams::specs(), [])
}

/// The schema of a table with a key for each parameter.
fn table<const N: usize>(specs: impl IntoIterator<Item = ParamSpec>, more: [(&str, Schema); N]) -> Schema {
    let own = more.into_iter().map(|(name, schema)| (name.to_owned(), schema.to_value()));
    let keys = specs.into_iter().map(|spec| (spec.name.to_owned(), of_param(&spec).to_value()));
    let keys: serde_json::Map<String, serde_json::Value> = own.chain(keys).collect();
    json_schema!({ "type": "object", "properties": keys, "additionalProperties": false })
}

/// The schema of one parameter: what it may be, and that it may also be written as text.
fn of_param(spec: &ParamSpec) -> Schema {
    let unit = spec.unit.map(|unit| format!(" In {unit}.")).unwrap_or_default();
    let description = format!("{}{unit} Default: {}.", spec.help, spec.default_text());
    let auto = spec.auto.map(|_| json_schema!({ "const": "auto" }));
    let value = match spec.kind {
        Kind::Choice(names) => json_schema!({ "enum": names }),
        Kind::Switch => json_schema!({ "enum": spec.kind.names() }),
        Kind::Integer { min, max } => json_schema!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Real { min, max } => json_schema!({ "type": "number", "minimum": min, "maximum": max }),
        Kind::Text(_) => json_schema!({ "type": "string" }),
    };
    match (auto, spec.kind) {
        (None, Kind::Choice(_) | Kind::Switch) => {
            json_schema!({ "description": description, "enum": spec.kind.names() })
        }
        (auto, _) => {
            let text = json_schema!({ "type": "string" });
            let any: Vec<Schema> = auto.into_iter().chain([value, text]).collect();
            json_schema!({ "description": description, "anyOf": any })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_has_every_parameter_with_its_default() {
        let schema = serde_json::to_string(&of_patterns(&mut SchemaGenerator::default())).unwrap();
        for spec in Params::specs() {
            assert!(schema.contains(&format!("\"{}\"", spec.name)), "{}", spec.name);
            assert!(schema.contains(&format!("Default: {}.", spec.default_text())), "{}", spec.name);
        }
        let schema = serde_json::to_string(&of_ribbons(&mut SchemaGenerator::default())).unwrap();
        assert!(schema.contains("\"wander\"") && !schema.contains("\"step\""), "{schema}");
    }
}
