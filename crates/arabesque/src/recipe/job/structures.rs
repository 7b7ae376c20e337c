//! Continuing repetitive structures that are given as points.

use std::collections::BTreeMap;

use arabesque_core::Error;
use arabesque_structures::StructureParams;
use arabesque_surface::{Bend, SurfaceParams};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::{parameters, surface::surface_params},
    size::{Cuboid, Size},
};

/// Where a structure goes; one of `size`, `tile`, `domain`, `box`, `along`, `on` and `inside` is given.
///
/// The exemplar of the recipe is a set of points with attributes: PLY, XYZ or CSV.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Structures {
    /// Width and height of a part of the plane, in the units of the exemplar. In space a sheet: it lies in x and y and is as high as the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Size>,
    /// Width and height of a seamless tile of the plane, or of a sheet in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<Size>,
    /// A file with the shape of the plane to fill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Input>,
    /// Width, depth and height of a box in space.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<Cuboid>,
    /// A file with curves to follow: lines of an OBJ file, or paths of an SVG file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<Input>,
    /// A file with the mesh to cover: OBJ, PLY, STL or GLB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<Input>,
    /// A file with the closed mesh to fill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inside: Option<Input>,
    /// Points that stay where they are, with the attributes of the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<Input>,
    /// Shapes (SVG) and pictures (PNG) that stay free, over `size`, `tile` and `domain`; in pictures what is dark and opaque.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub avoid: Vec<Input>,
    /// How the structure is turned: degrees about the z axis, about the normal of a surface, or about a curve. Over `size`, `tile` and `domain` also
    /// strokes (SVG), or a picture whose hue, or gray, is the direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orient: Option<FieldSource>,
    /// Where the structure runs on a mesh: `least` or `most`, along which the mesh bends least or most; a direction in space such as `0,0,1`;
    /// or the lines of an OBJ file as strokes on the mesh. Default: least.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// Size of the structure relative to the exemplar: a number, or over `size`, `tile` and `domain` a picture. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<FieldSource>,
    /// How far from a curve a structure may lie that repeats across it too. Default: half of the exemplar across.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Size along each curve, times `scale`: `1..0.5` from start to end, or `0:1,0.5:2,1:1` at shares of the length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taper: Option<String>,
    /// Degrees by which the structure turns about a curve from its start to its end. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twist: Option<f64>,
    /// Whether the surface of the points is made as well, and written instead of them. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mesh: bool,
    /// Parameters of the engine by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "parameters::plain_values")]
    #[schemars(schema_with = "parameters::of_structures")]
    pub params: BTreeMap<String, String>,
    /// Parameters of the surface by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "parameters::plain_values")]
    #[schemars(schema_with = "parameters::of_surfaces")]
    pub surface: BTreeMap<String, String>,
}

/// Where a structure runs on a mesh.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Direction {
    /// Along which it bends least or most.
    #[schemars(with = "String")]
    #[serde(serialize_with = "by_name")]
    Bend(Bend),
    /// One direction in space, as it lies along the mesh.
    Towards([f64; 3]),
    /// Strokes on the mesh.
    Strokes(Input),
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn by_name<S: Serializer>(bend: &Bend, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(bend.name())
}

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Text(String),
            Towards([f64; 3]),
            Strokes(Input),
        }
        Ok(match Written::deserialize(deserializer)? {
            Written::Text(text) => Self::parse(&text),
            Written::Towards(way) => Self::Towards(way),
            Written::Strokes(input) => Self::Strokes(input),
        })
    }
}

impl Direction {
    /// A direction as people write it: `least`, `most`, `0,0,1`, or a file of strokes.
    pub fn parse(text: &str) -> Self {
        if let Ok(bend) = text.parse() {
            return Self::Bend(bend);
        }
        let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
        match numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()) {
            Some(way) => Self::Towards(way),
            None => Self::Strokes(Input::file(text)),
        }
    }
}

impl Structures {
    /// Follows the curves of a file.
    pub fn along(curves: Input) -> Self {
        Self { along: Some(curves), ..Self::default() }
    }

    /// Fills a box.
    pub fn boxed(cuboid: Cuboid) -> Self {
        Self { cuboid: Some(cuboid), ..Self::default() }
    }

    pub(super) fn prepared_part(&self) -> Self {
        Self { params: self.params.clone(), ..Self::default() }
    }

    /// The parameters of the engine.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name or a value out of range.
    pub(crate) fn engine_params(&self) -> arabesque_core::Result<StructureParams> {
        let mut params = StructureParams::default();
        self.params.iter().try_for_each(|(name, value)| params.set(name, value))?;
        Ok(params)
    }

    /// The parameters of the surface, where one is made.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name or a value out of range.
    pub(crate) fn surface_params(&self) -> arabesque_core::Result<SurfaceParams> {
        surface_params(&self.surface)
    }

    /// The place that is given, by the name of its key.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none or several.
    pub(crate) fn place(&self) -> arabesque_core::Result<&'static str> {
        let given = [
            ("size", self.size.is_some()),
            ("tile", self.tile.is_some()),
            ("domain", self.domain.is_some()),
            ("box", self.cuboid.is_some()),
            ("along", self.along.is_some()),
            ("on", self.on.is_some()),
            ("inside", self.inside.is_some()),
        ];
        let names: Vec<_> = given.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
        match names.as_slice() {
            [one] => Ok(one),
            [] => Err(Error::parameter("place", "none", "one of size, tile, domain, box, along, on and inside")),
            several => Err(Error::parameter("place", several.join(" and "), "one of them")),
        }
    }
}
