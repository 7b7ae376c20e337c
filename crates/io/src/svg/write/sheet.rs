//! Everything that one SVG file of a result is made of.

use arabesque_core::{Border, Budget, Covered, Domain, Drawn, Instance, Outline, Placement, Vector, Warning};

use crate::svg::drawing::{Drawing, HostDocument, Page, Placed};

/// How placed elements are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Each exemplar element once in `<defs>`, placed by `<use>`.
    #[default]
    Linked,
    /// Every element written out in page coordinates, for cutters and plotters.
    Expanded,
}

/// Bends deformed elements: `(placement, point of the exemplar) -> point of the output`.
pub type Bend<'a> = dyn Fn(usize, Vector<2>) -> Vector<2> + 'a;

/// Everything that one SVG file is made of.
pub struct Sheet<'a> {
    /// How the elements look.
    pub drawing: &'a Drawing,
    /// Where they lie.
    pub placements: &'a [Placement<2>],
    /// The order of placements and their copies on a torus, where copies do not follow what they are copies of.
    pub sequence: &'a [Instance<2>],
    /// The strokes.
    pub curves: &'a [Drawn<2>],
    /// The filled areas.
    pub areas: &'a [Covered<2>],
    /// The looks of frozen placements and of what else is kept.
    pub kept: Option<&'a Placed>,
    /// The drawing of which a part is refilled: then the result is that file with the new in it.
    pub host: Option<&'a HostDocument>,
    /// Page of the result.
    pub page: Page,
    /// The filled domain, in page coordinates.
    pub domain: &'a Domain<2>,
    /// The outline of the domain where it is a shape.
    pub shape: Option<&'a Outline<2>>,
    /// Whether elements are cut at the border.
    pub border: Border,
    /// How deformed placements are bent; without it they are drawn rigid.
    pub bend: Option<&'a Bend<'a>>,
    /// Linked or expanded.
    pub style: Style,
    /// The recipe, as TOML.
    pub recipe: Option<&'a str>,
    /// What writing may use up.
    pub budget: &'a Budget,
}

/// An SVG text and what could not be written as asked.
#[derive(Clone, Debug)]
pub struct Written {
    /// The file.
    pub text: String,
    /// Elements that stayed links or were clipped instead of cut.
    pub warnings: Vec<Warning>,
}
