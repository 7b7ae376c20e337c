//! How physics takes part in a run.

use std::{borrow::Cow, fmt, str::FromStr};

use arabesque_core::{Error, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The word for [`Physics::Settle`].
const SETTLE: &str = "settle";
/// Most substeps of an iteration.
const MOST: usize = 100;

/// How physics takes part in a run: elements push one another apart, fall and come to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Physics {
    /// So many small steps after each iteration of the engine, and at the end until all is at rest.
    Substeps(usize),
    /// At the end alone, until all is at rest.
    Settle,
}

impl Default for Physics {
    /// Five substeps.
    fn default() -> Self {
        Self::Substeps(5)
    }
}

impl fmt::Display for Physics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Substeps(count) => write!(f, "{count}"),
            Self::Settle => f.write_str(SETTLE),
        }
    }
}

impl FromStr for Physics {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        match text.parse() {
            _ if text == SETTLE => Ok(Self::Settle),
            Ok(count) if (1..=MOST).contains(&count) => Ok(Self::Substeps(count)),
            _ => {
                let expected = format!("a number of steps from 1 to {MOST}, or {SETTLE}");
                Err(Error::parameter("physics", text, expected))
            }
        }
    }
}

impl Serialize for Physics {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Substeps(count) => serializer.serialize_u64(*count as u64),
            Self::Settle => serializer.serialize_str(SETTLE),
        }
    }
}

impl<'de> Deserialize<'de> for Physics {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Number(u64),
            Text(String),
        }
        let text = match Written::deserialize(deserializer)? {
            Written::Number(count) => count.to_string(),
            Written::Text(text) => text,
        };
        text.parse().map_err(serde::de::Error::custom)
    }
}

impl JsonSchema for Physics {
    fn schema_name() -> Cow<'static, str> {
        "Physics".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "integer", "minimum": 1, "maximum": MOST }, { "const": SETTLE }] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn physics_is_a_number_of_steps_or_settle() {
        assert_eq!(" 7 ".parse::<Physics>().unwrap(), Physics::Substeps(7));
        assert_eq!("settle".parse::<Physics>().unwrap(), Physics::Settle);
        for text in ["", "0", "101", "-1", "2.5", "Settle", "on"] {
            let error = text.parse::<Physics>().unwrap_err().to_string();
            assert!(error.contains("from 1 to 100, or settle"), "{error}");
        }
        for physics in [Physics::default(), Physics::Settle] {
            let text = toml::to_string(&std::collections::BTreeMap::from([("physics", physics)])).unwrap();
            let back: std::collections::BTreeMap<String, Physics> = toml::from_str(&text).unwrap();
            assert_eq!(back["physics"], physics);
        }
    }
}
