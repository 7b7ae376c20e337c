//! Filling a part of the plane.

use arabesque_core::{Border, Error, Result, choices};
use arabesque_io::svg;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::parameters::{self, Parameters},
    size::{Size, Tile},
};

/// A page, a shape or a seamless tile that is filled. One of `size`, `tile` and `domain` may be given; with none of them the layer
/// Domain of the exemplar is filled.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fill {
    /// Width and height of the page, such as `800x600` or `210mmx297mm`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Size>,
    /// Width and height of a seamless tile, or `auto` for the smallest that the repeat of the exemplar fills exactly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<Tile>,
    /// What happens at the border of the domain. Default: clip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// What open strokes are taken for. Default: auto.
    #[serde(default)]
    pub method: Method,
    /// Whether the exemplar is one period of a pattern. Default: auto.
    #[serde(default, skip_serializing_if = "ExemplarTile::is_auto")]
    pub exemplar_tile: ExemplarTile,
    /// A file with the shape to fill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub domain: Option<Input>,
    /// Elements and strokes that stay where they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<Input>,
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

impl Fill {
    /// A page of this size, with everything else at its default.
    pub fn page(size: Size) -> Self {
        Self { size: Some(size), ..Self::default() }
    }

    pub(super) fn prepared_part(&self) -> Self {
        let params = self.params.clone();
        Self { method: self.method, exemplar_tile: self.exemplar_tile, params, ..Self::default() }
    }
}

choices! {
    /// Whether the exemplar is one period of a pattern.
    pub enum ExemplarTile {
        /// Where a `<pattern>` fills it, or what its opposite edges cut fits together beyond doubt.
        Auto = "auto",
        /// It is: what an edge cuts goes on at the opposite edge.
        Yes = "yes",
        /// It is a page of the pattern.
        No = "no",
    }
}

impl Default for ExemplarTile {
    /// [`ExemplarTile::Auto`].
    fn default() -> Self {
        Self::Auto
    }
}

impl ExemplarTile {
    fn is_auto(&self) -> bool {
        *self == Self::Auto
    }

    /// How a drawing is read for it.
    fn of_drawings(self) -> svg::Tiling {
        match self {
            Self::Auto => svg::Tiling::Auto,
            Self::Yes => svg::Tiling::Period,
            Self::No => svg::Tiling::Page,
        }
    }
}

/// What an exemplar is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// What it is made of. Default: auto.
    pub method: Method,
    /// Whether it is one period of a pattern. Default: auto.
    pub exemplar_tile: ExemplarTile,
    /// What fills are taken for that run through the frame. Default: areas, where the exemplar repeats.
    pub large_fills: svg::LargeFills,
}

impl Default for Reading {
    fn default() -> Self {
        let (method, exemplar_tile) = (Method::default(), ExemplarTile::default());
        Self { method, exemplar_tile, large_fills: svg::LargeFills::Areas }
    }
}

impl From<Method> for Reading {
    /// Everything but the method at its default.
    fn from(method: Method) -> Self {
        Self { method, ..Self::default() }
    }
}

impl Reading {
    /// How a drawing is read for it.
    pub(crate) fn of_drawings(self, name: &str) -> Result<svg::ReadOptions> {
        let (method, tiling) = (self.method.of_drawings()?, self.exemplar_tile.of_drawings());
        Ok(svg::ReadOptions { method, tiling, large_fills: self.large_fills, ..svg::ReadOptions::new(name) })
    }
}

choices! {
    /// What the exemplar is made of.
    pub enum Method {
        /// The exemplar decides: filled shapes and groups are elements, open strokes and their net are curves.
        Auto = "auto",
        /// Every connected piece is an element.
        Elements = "elements",
        /// Every stroke without a fill is a curve; what is filled is an element.
        Curves = "curves",
        /// Repetitive structures, given as points with attributes.
        Structures = "structures",
    }
}

impl Default for Method {
    /// [`Method::Auto`].
    fn default() -> Self {
        Self::Auto
    }
}

impl Method {
    /// How a drawing is read for this method.
    pub(crate) fn of_drawings(self) -> Result<svg::Method> {
        match self {
            Self::Auto => Ok(svg::Method::Auto),
            Self::Elements => Ok(svg::Method::Elements),
            Self::Curves => Ok(svg::Method::Curves),
            Self::Structures => {
                let expected = "auto, elements or curves; structures are points: PLY, XYZ or CSV";
                Err(Error::parameter("method", "structures", expected))
            }
        }
    }
}
