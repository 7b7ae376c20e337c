//! What to write.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::format::Format;

/// What to write.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputOptions {
    /// Where to write it, when the command line does not say: in the folder of the recipe. Not kept in results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// File format. Default: by the extension of the path, else the usual one of the job: SVG for the plane, OBJ or CSV for a
    /// box, PNG or GLB for ribbons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<Format>,
    /// SVG: write every element out in place instead of linking to it. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub expand: bool,
    /// PNG: pixels per inch. Default: 96; of ribbons one pixel per user unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dpi: Option<f64>,
    /// PNG: pixels per user unit, instead of `dpi`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixels_per_unit: Option<f64>,
    /// PNG of what lies in space: from where it is seen, as `azimuth,elevation` in degrees. Default: -60,30.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<String>,
    /// GLB of a scene of meshes: one node with a list of places for each mesh (EXT_mesh_gpu_instancing) instead of a node for each
    /// element. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub instancing: bool,
    /// PLY of a scene of meshes: the centres of the elements, with their classes and rotations, instead of their meshes. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub centres: bool,
    /// Leave the recipe out of the file. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub bare: bool,
}
