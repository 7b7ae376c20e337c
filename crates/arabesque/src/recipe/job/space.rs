//! Filling a part of space.

use std::collections::BTreeMap;

use arabesque_core::{Border, Error, Result, choices};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::{
        convention::{Unit, Up},
        deform::Deform,
        fill::Method,
        parameters::{self, Parameters},
        physics::Physics,
        structures::Direction,
    },
    size::Cuboid,
};

choices! {
    /// Where elements of a class may lie.
    pub enum Constraint {
        /// Those that lie on the floor in the exemplar lie on it at the same height, and no others do.
        Floor = "floor",
        /// Anywhere.
        Free = "free",
    }
}

/// A part of space that is filled from an exemplar in space: a scene of meshes (GLB), curves (OBJ) or points (CSV with a column z). One of
/// `box`, `inside`, `on` and `along` is given.
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
    /// A file with curves in space (OBJ), around which the exemplar goes on in a tube, its x along them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<Input>,
    /// Along curves: radius of the tube. Default: half of the lesser side of the exemplar across x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tube: Option<f64>,
    /// Along curves: degrees by which the pattern turns about the curve from start to end. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twist: Option<f64>,
    /// Files with closed meshes that stay empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub avoid: Vec<Input>,
    /// Elements that stay exactly where they are: a scene with the meshes of the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<Input>,
    /// What happens at the border: inside, cross or clip. Default: inside for meshes, clip for curves and points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// What open strokes are taken for. Default: auto.
    #[serde(default)]
    pub method: Method,
    /// Degrees by which the pattern is turned about what is up, about the normal of a mesh or about a curve; or the lines of an OBJ file, along
    /// which the x axis of the exemplar runs, in a box or a mesh that is filled. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orient: Option<FieldSource>,
    /// Where the x axis of the exemplar runs on a mesh: `least` or `most`, along which the mesh bends least or most; a direction in space such
    /// as `0,0,1`; or the lines of an OBJ file as strokes on the mesh. Default: least; where a single layer repeats, as its lattice breaks least, or level for a
    /// wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// Size of the pattern relative to the exemplar, elements and gaps alike: a number, or a table of places (CSV with x, y, z, value), between
    /// which it changes smoothly. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<FieldSource>,
    /// Elements per volume relative to the exemplar: a number, or a table of places as for scale. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<FieldSource>,
    /// Whether the exemplar stands on a floor, its lowest place, and so does the result: what lies on the floor in the exemplar lies on it
    /// at the same height, and nothing else does. Default: false; on a mesh always.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub floor: bool,
    /// For elements of these classes, where they may lie: `floor` as with floor, `free` anywhere. Classes without a rule follow floor.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub constrain: BTreeMap<String, Constraint>,
    /// The axis that is up in the files that are read. Results have the same; GLB always y. Default: y.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub up: Up,
    /// Length of a unit of the files that are read: mm, cm, m, in or ft. Results have the same; GLB always metres. Default: m.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub unit: Unit,
    /// Scenes of meshes: which elements bend: `auto`, those that the exemplar shows bent in several ways; `all`; `off`; or names of
    /// classes with commas between them. Default: auto.
    #[serde(default, skip_serializing_if = "Deform::is_auto")]
    pub deform: Deform,
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

/// Whether something is as it is where nobody says otherwise.
fn is_usual<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
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

    /// Follows the curves of a file.
    pub fn along(curves: Input) -> Self {
        Self { along: Some(curves), ..Self::default() }
    }

    /// Whether elements stand on a floor.
    pub(crate) fn stands(&self) -> bool {
        self.floor || self.on.is_some() || self.constrain.values().any(|rule| *rule == Constraint::Floor)
    }

    /// Whether what lies on something on the floor is to stay there: where all stand on a level floor,
    /// and nothing says otherwise of a class.
    pub(crate) fn stacks(&self) -> bool {
        self.floor && self.on.is_none() && self.constrain.is_empty() && self.keep.is_none()
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
            constrain: self.constrain.clone(),
            up: self.up,
            deform: self.deform.clone(),
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
        let given = [
            ("box", self.cuboid.is_some()),
            ("inside", self.inside.is_some()),
            ("on", self.on.is_some()),
            ("along", self.along.is_some()),
        ];
        let names: Vec<_> = given.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
        match names.as_slice() {
            [one] => Ok(one),
            [] => Err(Error::parameter("place", "none", "one of box, inside, on and along")),
            several => Err(Error::parameter("place", several.join(" and "), "one of them")),
        }
    }
}
