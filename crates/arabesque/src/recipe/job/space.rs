//! Filling a part of space.

use arabesque_core::{Border, Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::{
        fill::Method,
        parameters::{self, Parameters},
        physics::Physics,
        structures::Direction,
    },
    size::Cuboid,
};

/// A part of space that is filled from an exemplar in space: a scene of meshes (GLB), curves (OBJ) or points (CSV with a column z). One of
/// `box`, `inside` and `on` is given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Space {
    /// Sides of a box along x, y and z in the units of the exemplar, such as `10x10x5`, with a corner at the origin.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<Cuboid>,
    /// A file with the closed mesh to fill: OBJ, PLY, STL or GLB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inside: Option<Input>,
    /// A file with the mesh to cover: the exemplar lies on it as it lies on its floor, y along the normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<Input>,
    /// Elements that stay exactly where they are: a scene with the meshes of the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<Input>,
    /// What happens at the border: inside, cross or clip. Default: inside for meshes, clip for curves and points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// What open strokes are taken for. Default: auto.
    #[serde(default)]
    pub method: Method,
    /// Degrees by which the pattern is turned about y, or about the normal of a mesh: a number. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orient: Option<FieldSource>,
    /// Where the x axis of the exemplar runs on a mesh: `least` or `most`, along which the mesh bends least or most; a direction in space such
    /// as `0,0,1`; or the lines of an OBJ file as strokes on the mesh. Default: least.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// Size of the pattern relative to the exemplar, elements and gaps alike: a number. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<FieldSource>,
    /// Elements per volume relative to the exemplar: a number. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<FieldSource>,
    /// Whether the exemplar stands on a floor, its lowest place, and so does the result: what lies on the floor in the exemplar lies on it
    /// at the same height, and nothing else does. Default: false; on a mesh always.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub floor: bool,
    /// Scenes of meshes: elements push one another apart, fall and come to rest. A number of steps of physics after each iteration of the
    /// engine, or `settle` for the end alone. Default: no physics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub physics: Option<Physics>,
    /// The direction in which elements fall; its length is the strength, 1 as on earth, and 0 for none. Default: 0, -1, 0; on a mesh
    /// towards it everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity: Option<[f64; 3]>,
    /// Friction between elements, and between them and what is around them, from 0 to 2. Default: 0.5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Parameters of the engine.
    #[serde(default, skip_serializing_if = "Parameters::is_empty")]
    #[schemars(schema_with = "parameters::of_patterns")]
    pub params: Parameters,
}

impl Space {
    /// Fills `cuboid` with everything else at its default.
    pub fn new(cuboid: Cuboid) -> Self {
        Self { cuboid: Some(cuboid), ..Self::default() }
    }

    /// Fills the closed mesh of a file.
    pub fn inside(mesh: Input) -> Self {
        Self { inside: Some(mesh), ..Self::default() }
    }

    /// Covers the mesh of a file.
    pub fn on(mesh: Input) -> Self {
        Self { on: Some(mesh), ..Self::default() }
    }

    pub(super) fn prepared_part(&self) -> Self {
        Self {
            method: self.method,
            params: self.params.clone(),
            floor: self.floor || self.on.is_some(),
            ..Self::default()
        }
    }

    /// The physics that is asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options of physics without it.
    pub(crate) fn asked_physics(&self) -> Result<Option<Physics>> {
        let options = [("gravity", self.gravity.is_some()), ("friction", self.friction.is_some())];
        match options.into_iter().find(|(_, is_given)| *is_given && self.physics.is_none()) {
            None => Ok(self.physics),
            Some((name, _)) => Err(Error::parameter(name, "given without physics", "both, or neither")),
        }
    }

    /// The place that is given, by the name of its key.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none or several.
    pub(crate) fn place(&self) -> Result<&'static str> {
        let given = [("box", self.cuboid.is_some()), ("inside", self.inside.is_some()), ("on", self.on.is_some())];
        let names: Vec<_> = given.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
        match names.as_slice() {
            [one] => Ok(one),
            [] => Err(Error::parameter("place", "none", "one of box, inside and on")),
            several => Err(Error::parameter("place", several.join(" and "), "one of them")),
        }
    }
}
