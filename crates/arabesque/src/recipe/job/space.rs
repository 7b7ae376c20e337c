//! Filling a box in space.

use arabesque_core::Border;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{
    field::FieldSource,
    job::{
        fill::Method,
        parameters::{self, Parameters},
    },
    size::Cuboid,
};

/// A box in space that is filled from an exemplar in space: curves (OBJ) or points (CSV with a column z).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Space {
    /// Width, depth and height of the box in the units of the exemplar, such as `10x10x5`.
    #[serde(rename = "box")]
    pub cuboid: Cuboid,
    /// What happens at the sides of the box: inside, cross or clip. Default: clip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// What open strokes are taken for. Default: auto.
    #[serde(default)]
    pub method: Method,
    /// Size of the pattern relative to the exemplar, elements and gaps alike: a number. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<FieldSource>,
    /// Elements per volume relative to the exemplar: a number. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<FieldSource>,
    /// Parameters of the engine.
    #[serde(default, skip_serializing_if = "Parameters::is_empty")]
    #[schemars(schema_with = "parameters::of_patterns")]
    pub params: Parameters,
}

impl Space {
    /// Fills `cuboid` with everything else at its default.
    pub fn new(cuboid: Cuboid) -> Self {
        Self {
            cuboid,
            border: None,
            method: Method::default(),
            scale: None,
            density: None,
            params: Parameters::default(),
        }
    }

    pub(super) fn prepared_part(&self) -> Self {
        Self { method: self.method, params: self.params.clone(), ..Self::new(Cuboid([1.0; 3])) }
    }
}
