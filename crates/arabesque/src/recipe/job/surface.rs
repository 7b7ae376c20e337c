//! Making a surface of points.

use std::collections::BTreeMap;

use arabesque_core::Result;
use arabesque_surface::SurfaceParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{input::Input, job::parameters};

/// The surface of points in space; the exemplar of the recipe are the points: PLY, XYZ, CSV, OBJ or GLB.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// A file with a closed mesh; what of the surface lies outside of it is cut off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trim: Option<Input>,
    /// Parameters by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "parameters::plain_values")]
    #[schemars(schema_with = "parameters::of_surfaces")]
    pub params: BTreeMap<String, String>,
}

impl Surface {
    pub(super) fn prepared_part(&self) -> Self {
        Self { params: self.params.clone(), ..Self::default() }
    }

    /// The parameters of the surface.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Parameter`] for an unknown name or a value out of range.
    pub(crate) fn engine_params(&self) -> Result<SurfaceParams> {
        surface_params(&self.params)
    }
}

/// Parameters of a surface by name.
pub(super) fn surface_params(set: &BTreeMap<String, String>) -> Result<SurfaceParams> {
    let mut params = SurfaceParams::default();
    set.iter().try_for_each(|(name, value)| params.set(name, value))?;
    params.check()?;
    Ok(params)
}
