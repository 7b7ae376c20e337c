//! Parameters of an engine by name.

use std::collections::BTreeMap;

use arabesque_patterns::Params;
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
pub(super) fn plain_values<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, String>, D::Error> {
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
    json_schema!({ "type": "object" })
}

/// The schema of the parameters of ribbons.
pub(super) fn of_ribbons(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object" })
}
