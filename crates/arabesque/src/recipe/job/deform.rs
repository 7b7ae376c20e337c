//! Which elements of a scene bend.

use std::{borrow::Cow, convert::Infallible, fmt, str::FromStr};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Which elements of a scene bend, by class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Deform {
    /// Those that the exemplar shows bent in several ways, and those of which its file says so.
    #[default]
    Auto,
    /// All of them.
    All,
    /// None.
    Off,
    /// Those of classes with these names, and no others.
    Classes(Vec<String>),
}

impl Deform {
    /// Whether nothing was asked for.
    pub fn is_auto(&self) -> bool {
        *self == Self::Auto
    }
}

impl fmt::Display for Deform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::All => f.write_str("all"),
            Self::Off => f.write_str("off"),
            Self::Classes(names) => f.write_str(&names.join(",")),
        }
    }
}

impl FromStr for Deform {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.trim() {
            "" | "auto" => Self::Auto,
            "all" => Self::All,
            "off" => Self::Off,
            names => {
                let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
                Self::Classes(names.map(str::to_owned).collect())
            }
        })
    }
}

impl Serialize for Deform {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Deform {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Ok(text.parse().unwrap_or_default())
    }
}

impl JsonSchema for Deform {
    fn schema_name() -> Cow<'static, str> {
        "Deform".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "default": "auto" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_classes_but_for_three_words() {
        let read = |text: &str| text.parse::<Deform>().unwrap();
        assert_eq!([read("auto"), read(" all "), read("off")], [Deform::Auto, Deform::All, Deform::Off]);
        let names = Deform::Classes(vec!["noodle".into(), "bag".into()]);
        assert_eq!(read("noodle, bag,"), names);
        assert_eq!(read(&names.to_string()), names);
    }
}
