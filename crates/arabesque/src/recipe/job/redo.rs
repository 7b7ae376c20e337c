//! Filling a region of the exemplar's own file again.

use arabesque_core::Border;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::{
        fill::Method,
        parameters::{self, Parameters},
    },
    region::Region,
};

/// A region of the exemplar's own file that is filled again; everything else of the file stays as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Redo {
    /// What happens at the border of the region. Default: clip; where the drawing has elements alone, cross.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// What open strokes are taken for. Default: auto.
    #[serde(default)]
    pub method: Method,
    /// The region that is filled.
    pub region: Region,
    /// The region that serves as the example. Default: everything around the region that is filled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Region>,
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
    /// Parameters of the engine.
    #[serde(default, skip_serializing_if = "Parameters::is_empty")]
    #[schemars(schema_with = "parameters::of_patterns")]
    pub params: Parameters,
}

impl Redo {
    /// Fills `region` from what lies around it, with everything else at its default.
    pub fn of(region: Region) -> Self {
        Self {
            border: None,
            method: Method::default(),
            region,
            from: None,
            orient: None,
            scale: None,
            density: None,
            avoid: Vec::new(),
            params: Parameters::default(),
        }
    }

    pub(super) fn prepared_part(&self) -> Self {
        let (from, params) = (self.from.clone(), self.params.clone());
        Self { method: self.method, from, params, ..Self::of(self.region.clone()) }
    }
}
