//! Continuing reliefs: surface detail that is given as points with normals.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Error, Result, Vector};
use arabesque_reliefs::ReliefParams;
use arabesque_surface::SurfaceParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{
    input::Input,
    job::{Direction, parameters, surface::surface_params},
    size::Size,
};

/// Where a relief goes; one of `extent`, `on` and `fill_hole` is given.
///
/// The exemplar of the recipe is a patch of the relief: points with or without normals (PLY, XYZ, CSV), a mesh (OBJ, PLY, STL, GLB), or a height field (PNG).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Relief {
    /// Width and depth of the part of the plane to cover, in the units of the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<Size>,
    /// Whether the extent is a tile that repeats without a seam. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tile: bool,
    /// A file with the mesh to cover: OBJ, PLY, STL or GLB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<Input>,
    /// Where the relief runs on a mesh: `least` or `most`, along which the mesh bends least or most; a direction in space such as `0,0,1`;
    /// or the lines of an OBJ file as strokes on the mesh. Default: least.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// Size of the relief on a mesh, relative to the exemplar. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Whether a gap in the exemplar is filled from what is around it. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fill_hole: bool,
    /// The box of the relief proper along its plane: lowest and highest coordinates, `[x0, y0, x1, y1]`. Default: the exemplar without its border.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[f64; 4]>,
    /// Of a height field: how much higher white is than black, in pixels. Default: a tenth of the shorter side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// Whether a PNG file is the height field of the result, with 16 bits, instead of a picture of it. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub height_field: bool,
    /// Whether the surface of the points is made as well, and written instead of them. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mesh: bool,
    /// Parameters of the engine by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "parameters::plain_values")]
    #[schemars(schema_with = "parameters::of_reliefs")]
    pub params: BTreeMap<String, String>,
    /// Parameters of the surface by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "parameters::plain_values")]
    #[schemars(schema_with = "parameters::of_surfaces")]
    pub surface: BTreeMap<String, String>,
}

impl Relief {
    /// Covers a part of the plane.
    pub fn over(extent: Size) -> Self {
        Self { extent: Some(extent), ..Self::default() }
    }

    pub(super) fn prepared_part(&self) -> Self {
        Self {
            params: self.params.clone(),
            bounds: self.bounds,
            height: self.height,
            fill_hole: self.fill_hole,
            ..Self::default()
        }
    }

    /// The parameters of the engine.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name or a value out of range.
    pub(crate) fn engine_params(&self) -> Result<ReliefParams> {
        let mut params = ReliefParams::default();
        self.params.iter().try_for_each(|(name, value)| params.set(name, value))?;
        Ok(params)
    }

    /// The parameters of the surface, where one is made.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name or a value out of range.
    pub(crate) fn surface_params(&self) -> Result<SurfaceParams> {
        surface_params(&self.surface)
    }

    /// The box of the relief proper in the axes of its plane, where it is given.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a box without width or depth.
    pub(crate) fn proper(&self) -> Result<Option<Bounds<2>>> {
        let Some([x0, y0, x1, y1]) = self.bounds else { return Ok(None) };
        if [x0, y0, x1, y1].iter().all(|v| v.is_finite()) && x0 < x1 && y0 < y1 {
            return Ok(Some(Bounds::new(Vector::xy(x0, y0), Vector::xy(x1, y1))));
        }
        let expected = "x0,y0,x1,y1 with x0 below x1 and y0 below y1";
        Err(Error::parameter("box", format!("{x0},{y0},{x1},{y1}"), expected))
    }

    /// Checks what can be checked before files are read.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no place or several, and for options that go with another place.
    pub(crate) fn check(&self) -> Result<()> {
        let given = [("extent", self.extent.is_some()), ("on", self.on.is_some()), ("fill_hole", self.fill_hole)];
        let names: Vec<_> = given.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
        match names.as_slice() {
            [_] => {}
            [] => {
                return Err(Error::parameter(
                    "place",
                    "none",
                    "one of extent, on and fill_hole (--extent, --on or --fill-hole)",
                ));
            }
            several => return Err(Error::parameter("place", several.join(" and "), "one of them")),
        }
        if self.tile && self.extent.is_none() {
            return Err(Error::parameter("tile", "true", "an extent, which is the size of the tile"));
        }
        if self.on.is_none() && (self.direction.is_some() || self.scale.is_some()) {
            let given = self.scale.map(|scale| ("scale", scale.to_string()));
            let (name, shown) = given.unwrap_or_else(|| ("direction", "given".to_owned()));
            return Err(Error::parameter(name, shown, "nothing without a mesh to lie on (--on MESH)"));
        }
        if self.on.is_some() && self.height_field {
            return Err(Error::parameter("height_field", "true", "a relief in the plane, not on a mesh"));
        }
        if self.mesh && self.height_field {
            return Err(Error::parameter("height_field and mesh", "true", "one of them"));
        }
        if let Some(scale) = self.scale.filter(|s| !(1e-6..=1e6).contains(s)) {
            return Err(Error::parameter("scale", scale, "a number from 0.000001 to 1000000"));
        }
        if let Some(height) = self.height.filter(|h| !(1e-6..=1e9).contains(h)) {
            return Err(Error::parameter("height", height, "a positive number of pixels up to 1e9"));
        }
        self.proper().map(|_| ())
    }
}
