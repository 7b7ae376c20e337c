//! Domains of the plane: where the pattern goes, on which page it is shown, and whether there is room.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Domain, Error, Exemplar, Limits, Outline, Result, Shape, rounded};
use arabesque_io::svg::{self, Drawing, Page, ReadOptions};
use arabesque_patterns::repeat::Repeat;

use crate::{
    recipe::{Fill, Input, Size, Tile, pixels_per_user},
    resources::Files,
    spacing::spacing,
};

/// Shortest side of a tile, in mean spacings: in a narrower one every element would meet itself many times.
const MIN_TILE_SIDE: f64 = 0.5;
/// Shortest side of any other domain, in mean spacings.
const MIN_SIDE: f64 = 0.01;

/// A domain with the page that shows it.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) domain: Domain<2>,
    /// Outline of the domain where it is a shape.
    pub(crate) shape: Option<Outline<2>>,
    pub(crate) page: Page,
}

impl Place {
    /// A shape as the place to fill.
    pub(crate) fn shaped(shape: Shape, page: Page) -> Self {
        let outline = shape.outline().clone();
        Self { domain: Domain::Region(Arc::new(shape)), shape: Some(outline), page }
    }

    /// The place that `fill` asks for, whose domain file is embedded.
    pub(crate) fn of(fill: &mut Fill, drawing: &Drawing, units: Units, files: &Files) -> Result<Self> {
        let given = [fill.size.is_some(), fill.tile.is_some(), fill.domain.is_some()];
        if given.iter().filter(|g| **g).count() > 1 {
            return Err(Error::parameter("domain", "more than one", "only one of size, tile and domain"));
        }
        let tile = match fill.tile {
            Some(Tile::Of(size)) => Some(size),
            Some(Tile::Auto) => return Err(Error::parameter("tile", "auto", "a size here, such as 400x400")),
            None => None,
        };
        if let Some(size) = fill.size.or(tile) {
            return Self::sized(&size, tile.is_some(), drawing, units);
        }
        if let Some(input) = &mut fill.domain {
            files.embed(input)?;
            let (shape, page) = read_shape(input, drawing, units, files)?;
            return Ok(Self::shaped(shape, page));
        }
        match &drawing.job.domain {
            Some(shape) => Ok(Self::shaped(shape.clone(), drawing.page)),
            None => Err(Error::parameter(
                "domain",
                "none",
                "--size WxH, --tile WxH, --domain SHAPE.svg or --redo REGION, or an exemplar with a layer Domain",
            )),
        }
    }

    fn sized(size: &Size, is_tile: bool, drawing: &Drawing, units: Units) -> Result<Self> {
        if units == Units::None && size.unit.is_some() {
            return Err(Error::parameter("size", size, "plain numbers, because points have no unit of length"));
        }
        let (_, page) = size.on(&drawing.page);
        let domain = if is_tile { Domain::Torus(page.view) } else { Domain::Box(page.view) };
        Ok(Self { domain, shape: None, page })
    }
}

/// Whether the exemplar has a unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Units {
    /// A drawing: its page says how long a user unit is.
    OfPage,
    /// Points: bare numbers.
    None,
}

/// A shape of another file in the units of the exemplar, and its page in the same units.
pub(crate) fn read_shape(input: &Input, drawing: &Drawing, units: Units, files: &Files) -> Result<(Shape, Page)> {
    let (shape, page) = svg::read_shape(&files.text(input)?, input.id.as_deref(), &options(input, files))?;
    let factor = match units {
        Units::None => 1.0,
        Units::OfPage => pixels_per_user(&page) / pixels_per_user(&drawing.page),
    };
    if !(factor.is_finite() && factor > 0.0) {
        return Err(Error::input(input.name(), "a page without size", "give the page a width and a height"));
    }
    if factor == 1.0 {
        return Ok((shape, page));
    }
    let rings = shape.outline().rings.iter().map(|ring| ring.iter().map(|&p| p * factor).collect()).collect();
    let scaled = Shape::try_from_outline(Outline { rings }, &files.budget().stage("scaling a shape"))?
        .ok_or_else(|| Error::input(input.name(), "a shape without area", "draw a closed shape"))?;
    let view = Bounds::new(page.view.min * factor, page.view.max * factor);
    Ok((scaled, Page { view, unit: page.unit, unit_per_user: page.unit_per_user / factor }))
}

/// How an SVG file beside the exemplar is read.
pub(crate) fn options(input: &Input, files: &Files) -> ReadOptions {
    ReadOptions { budget: files.budget().clone(), ..ReadOptions::new(input.name()) }
}

/// Refuses a tile that is smaller than one cell of the repeat.
pub(crate) fn check_cell(repeat: Option<&Repeat>, domain: &Domain<2>) -> Result<()> {
    let (Some(repeat), Domain::Torus(tile)) = (repeat, domain) else { return Ok(()) };
    let Some(least) = repeat.smallest_tile() else { return Ok(()) };
    let size = tile.size();
    if (0..2).all(|k| size[k] >= SMALLER * least[k]) {
        return Ok(());
    }
    let near = [0, 1].map(|k| rounded((size[k] / least[k]).round().max(1.0) * least[k]));
    let [width, height] = least.map(rounded);
    Err(Error::no_result(
        format!(
            "a tile of {}x{} is smaller than the cell by which the pattern repeats, {width}x{height}",
            rounded(size[0]),
            rounded(size[1])
        ),
        format!("use the nearest tile that suits, --tile {}x{}, or --tile auto", near[0], near[1]),
    ))
}

/// A domain narrower than this many mean distances of elements holds none of them for sure.
const CROWDED: f64 = 0.25;

/// A tile that is smaller than this share of the cell along a side is not stretched to fit.
const SMALLER: f64 = 0.92;

/// Refuses a domain that is too large or too small for the pattern.
/// Areas alone, and what repeats in a region that is filled again, fit into any.
pub(crate) fn check_room(exemplar: &Exemplar<2>, domain: &Domain<2>, fits: bool, budget: &Budget) -> Result<()> {
    let spacing = spacing(exemplar);
    let expected = domain.measure() / spacing.powi(2);
    if expected.is_nan() || expected > budget.limits().output_elements as f64 {
        let period = exemplar.period.map_or_else(String::new, |[a, b]| {
            let [a, b] = [a, b].map(|v| rounded(v.norm()));
            format!(", or the period of the pattern larger, which is only {a} by {b}")
        });
        return Err(Error::Limit {
            what: "size of the domain".into(),
            found: format!("room for about {expected:.0} elements"),
            limit: format!("{} elements", budget.limits().output_elements),
            advice: format!(
                "make it smaller{period}{}; sizes without a unit are in the units of the exemplar",
                Limits::raising("output-elements", expected)
            ),
        });
    }
    if fits || (exemplar.elements.is_empty() && exemplar.curves.is_empty()) {
        return Ok(());
    }
    let smallest = exemplar.elements.iter().map(|e| e.outline.area()).fold(f64::INFINITY, f64::min);
    // Where elements crowd in a part of the frame, each takes less than its share of the frame.
    let longer = domain.bounds().size().0.into_iter().fold(0.0, f64::max);
    if (smallest.is_finite() && domain.measure() < smallest) || (expected < 0.5 && longer < CROWDED * spacing) {
        return Err(Error::no_result(
            format!(
                "the domain ({} square units) is smaller than one element takes ({})",
                rounded(domain.measure()),
                rounded(if smallest.is_finite() { smallest.max(spacing.powi(2)) } else { spacing.powi(2) })
            ),
            "make it larger; sizes without a unit are in the units of the exemplar",
        ));
    }
    let least = spacing * if domain.period().is_some() { MIN_TILE_SIDE } else { MIN_SIDE };
    let side = domain.bounds().size().0.into_iter().fold(f64::INFINITY, f64::min);
    if side < least {
        return Err(Error::no_result(
            format!(
                "the domain is {} wide, where {} is the least for elements {} apart",
                rounded(side),
                rounded(least),
                rounded(spacing)
            ),
            "make it wider; sizes without a unit are in the units of the exemplar",
        ));
    }
    Ok(())
}
