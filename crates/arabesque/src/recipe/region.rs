//! Regions of a drawing: what is filled again, or copied from.

use std::{borrow::Cow, fmt};

use arabesque_core::{Error, Limits, Result};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};

use crate::recipe::input::Input;

/// A region of the exemplar's file.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// Left edge, upper edge, width and height, in the units of the file.
    Box([f64; 4]),
    /// The shape of the file itself that has this id or label.
    Own(String),
    /// A shape of another file.
    Shape(Input),
}

impl Region {
    /// A region as people write it: `x,y,w,h`, `#id`, or `FILE.svg#id`.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it is none of these, or a box without area.
    pub fn parse(text: &str) -> Result<Self> {
        let text = text.trim();
        let fail = || {
            let expected = "x,y,w,h with a positive width and height in the units of the file, #ID of a shape in it, or FILE.svg#ID";
            Error::parameter("region", format!("\"{text}\""), expected)
        };
        if let Some(id) = text.strip_prefix('#') {
            return if id.is_empty() { Err(fail()) } else { Ok(Self::Own(id.to_owned())) };
        }
        let numbers: Vec<_> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
        if numbers.iter().all(std::result::Result::is_ok) || (numbers.len() == 4 && numbers.iter().any(|n| n.is_ok())) {
            let numbers: Vec<f64> = numbers.into_iter().flatten().collect();
            let [x, y, w, h] = <[f64; 4]>::try_from(numbers).map_err(|_| fail())?;
            let region = Self::Box([x, y, w, h]);
            return region.check().map(|()| region).map_err(|_| fail());
        }
        if text.is_empty() { Err(fail()) } else { Ok(Self::Shape(Input::shape(text))) }
    }

    /// Whether a box has an area and lies within the coordinates that are allowed.
    ///
    /// # Errors
    /// [`Error::Parameter`] when it does not.
    pub(crate) fn check(&self) -> Result<()> {
        let Self::Box([x, y, w, h]) = *self else { return Ok(()) };
        let limit = Limits::default().coordinate;
        let is_sound = [x, y, w, h].iter().all(|v| v.abs() <= limit) && w > 0.0 && h > 0.0;
        let expected = "x,y,w,h with a positive width and height in the units of the file";
        if is_sound { Ok(()) } else { Err(Error::parameter("region", self, expected)) }
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Box([x, y, w, h]) => write!(f, "{x},{y},{w},{h}"),
            Self::Own(id) => write!(f, "#{id}"),
            Self::Shape(input) => match &input.id {
                Some(id) => write!(f, "{}#{id}", input.path),
                None => f.write_str(&input.path),
            },
        }
    }
}

impl Serialize for Region {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Shape(input) => input.serialize(serializer),
            other => serializer.serialize_str(&other.to_string()),
        }
    }
}

/// Accepts a text or a table.
struct TextOrTable;

impl<'de> Visitor<'de> for TextOrTable {
    type Value = Region;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a region such as \"x,y,w,h\", or a table with a path")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> std::result::Result<Region, E> {
        Region::parse(text).map_err(|e| E::custom(e))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<Region, A::Error> {
        Input::deserialize(MapAccessDeserializer::new(map)).map(Region::Shape)
    }
}

impl<'de> Deserialize<'de> for Region {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(TextOrTable)
    }
}

impl JsonSchema for Region {
    fn schema_name() -> Cow<'static, str> {
        "Region".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<Input>();
        let text = "x,y,w,h in the units of the exemplar, #ID of a shape in it, or FILE.svg#ID";
        json_schema!({ "anyOf": [{ "type": "string", "description": text }, table] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_boxes_own_shapes_or_shapes_of_files() {
        assert_eq!(Region::parse(" 1, 2,3.5,4 ").unwrap(), Region::Box([1.0, 2.0, 3.5, 4.0]));
        assert_eq!(Region::parse("-5,-5,10,10").unwrap(), Region::Box([-5.0, -5.0, 10.0, 10.0]));
        assert_eq!(Region::parse("#hole").unwrap(), Region::Own("hole".into()));
        assert_eq!(Region::parse("a.svg#b").unwrap(), Region::Shape(Input::shape("a.svg#b")));
        for text in ["", "#", "1,2,3", "1,2,0,4", "1,2,-3,4", "1,2,inf,4", "1,2,x,4", "5"] {
            assert!(Region::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn regions_survive_being_written() {
        #[derive(Serialize, Deserialize)]
        struct Holder {
            region: Region,
        }
        for text in ["1,2,3,4", "#hole", "a.svg#b"] {
            let region = Region::parse(text).unwrap();
            assert_eq!(region.to_string(), text);
            let written = toml::to_string(&Holder { region: region.clone() }).unwrap();
            assert_eq!(toml::from_str::<Holder>(&written).unwrap().region, region);
        }
    }
}
