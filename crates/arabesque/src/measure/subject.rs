//! Results as they are read to be measured: with the understanding of their exemplar, and with what their recipes say of them.

use std::sync::Arc;

use arabesque_core::{
    Area, Bounds, Budget, Curve, Domain, Element, Error, Exemplar, Outline, Result, Shape, Similarity, Vector,
};
use arabesque_io::{
    file,
    svg::{self, Drawing, LargeFills, Page, ReadOptions, Tiling},
};

use crate::{
    exemplar::LoadedExemplar,
    recipe::{Carrier, Fill, Input, Job, Reading, carried_recipe, pixels_per_user},
    resources::Resources,
};

/// A result as it was read.
pub(super) enum Found {
    Drawing(Box<Drawing>),
    Points(Exemplar<2>),
    Space(Exemplar<3>),
}

impl Found {
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Drawing(_) => "a drawing",
            Self::Points(_) => "points",
            Self::Space(content) => in_space(content),
        }
    }
}

/// What an exemplar is, for people.
pub(super) fn kind(exemplar: &LoadedExemplar) -> &'static str {
    match exemplar {
        LoadedExemplar::Drawing(..) => "a drawing",
        LoadedExemplar::Points(_) => "points",
        LoadedExemplar::Space(content, _) => in_space(content),
    }
}

fn in_space(content: &Exemplar<3>) -> &'static str {
    if content.curves.is_empty() { "points in space" } else { "curves in space" }
}

/// Reads a result as its exemplar was understood.
pub(super) fn read(
    exemplar: &LoadedExemplar,
    input: &Input,
    bytes: &[u8],
    reading: Reading,
    budget: &Budget,
) -> Result<Found> {
    let name = input.name();
    let is_drawing = || file::decode_text(name, bytes, budget).map(|text| text.trim_start().starts_with('<'));
    let LoadedExemplar::Drawing(own, _) = exemplar else {
        return Ok(match LoadedExemplar::read(input, bytes, reading, budget)? {
            LoadedExemplar::Drawing(drawing, _) => Found::Drawing(drawing),
            LoadedExemplar::Points(content) => Found::Points(content),
            LoadedExemplar::Space(content, _) => Found::Space(content),
        });
    };
    if arabesque_io::raster::png::is_png(bytes) || !is_drawing()? {
        // What else it is, is told in the words of that reader.
        return match LoadedExemplar::read(input, bytes, reading, budget)? {
            LoadedExemplar::Points(content) => Ok(Found::Points(content)),
            LoadedExemplar::Space(content, _) => Ok(Found::Space(content)),
            LoadedExemplar::Drawing(..) => Err(Error::input(name, "no drawing", "give an SVG drawing")),
        };
    }
    let text = file::decode_text(name, bytes, budget)?;
    let mut options = ReadOptions { budget: budget.clone(), ..reading.of_drawings(name)? };
    options.tiling = Tiling::Page;
    options.parts = own.parts;
    let is_alike = own.understood.iter().any(|known| known.reason == svg::Reason::AreaAlike);
    options.large_fills = match own.exemplar.areas.is_empty() {
        true => LargeFills::Lines,
        false if is_alike => LargeFills::AreasAlike,
        false => LargeFills::Areas,
    };
    if reading.method == crate::recipe::Method::Auto {
        // Strokes that touch on a spoiled page are no net where the exemplar has none, and so the other way round.
        options.method = match (own.exemplar.elements.is_empty(), own.exemplar.curves.is_empty()) {
            (_, true) if own.exemplar.areas.is_empty() => svg::Method::Elements,
            (true, false) => svg::Method::Curves,
            _ => svg::Method::Auto,
        };
    }
    let mut drawing = svg::read_exemplar(&text, &options).map_err(|error| on_a_page(error, name))?;
    let factor = pixels_per_user(&drawing.page) / pixels_per_user(&own.page);
    if is_scaled(own, &drawing, factor) {
        drawing = scaled(&drawing, factor);
    }
    Ok(Found::Drawing(Box::new(drawing)))
}

/// What the reader of exemplars says of a page without anything on it, as it is said of a result.
fn on_a_page(error: Error, name: &str) -> Error {
    match error {
        Error::Input { problem, .. } if problem.starts_with("no element") || problem.starts_with("every element") => {
            Error::input(name, problem, "give a page with something on it that can be measured")
        }
        other => other,
    }
}

/// Whether lengths of the result are in another unit: by its page, if its elements and strokes then are of the size of the exemplar's.
fn is_scaled(own: &Drawing, result: &Drawing, factor: f64) -> bool {
    if !(factor.is_finite() && factor > 0.0) || (factor - 1.0).abs() < 1e-3 {
        return false;
    }
    let typical = |drawing: &Drawing| {
        let radii = drawing.exemplar.elements.iter().map(|e| e.outline.radius(e.centre));
        let widths = drawing.exemplar.curves.iter().map(|c| c.width);
        let mut sizes: Vec<f64> = radii.collect();
        if sizes.is_empty() {
            sizes = widths.collect();
        }
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).copied().unwrap_or(1.0)
    };
    let (wanted, there) = (typical(own), typical(result));
    (there * factor / wanted).ln().abs() < (there / wanted).ln().abs()
}

/// A drawing in other units. Only what is measured is scaled; the page is as well, so that marks lie on what they are about.
fn scaled(drawing: &Drawing, factor: f64) -> Drawing {
    let by = Similarity { scale: factor, ..Similarity::identity() };
    let old = &drawing.exemplar;
    let moved = |outline: &Outline<2>| outline.transformed(&by);
    let element = |e: &Element<2>| Element { centre: e.centre * factor, outline: moved(&e.outline), ..e.clone() };
    let curve = |c: &Curve<2>| Curve { path: c.path.transformed(&by), width: c.width * factor, ..c.clone() };
    let area = |a: &Area<2>| Area { outline: moved(&a.outline), ..a.clone() };
    let exemplar = Exemplar {
        elements: old.elements.iter().map(element).collect(),
        curves: old.curves.iter().map(curve).collect(),
        areas: old.areas.iter().map(area).collect(),
        window: Bounds::new(old.window.min * factor, old.window.max * factor),
        ..(**old).clone()
    };
    let page = Page {
        view: Bounds::new(drawing.page.view.min * factor, drawing.page.view.max * factor),
        unit_per_user: drawing.page.unit_per_user / factor,
        ..drawing.page
    };
    // The markup stays in the units of the file, under a scale.
    let within = |markup: &String| format!("<g transform=\"scale({factor})\">{markup}</g>");
    let mut scaled = Drawing { exemplar: Arc::new(exemplar), page, ..drawing.clone() };
    scaled.fragments.iter_mut().for_each(|f| f.markup = within(&f.markup));
    scaled.background = scaled.background.as_ref().map(within);
    scaled.strokes.iter_mut().flatten().for_each(|stroke| stroke.width *= factor);
    scaled
}

/// What the recipe of a result says that it should be.
#[derive(Default)]
pub(super) struct Intent {
    job: Option<Job>,
}

impl Intent {
    /// The intent of a file; none where it carries no recipe, or one that cannot be read.
    pub(super) fn of(name: &str, bytes: &[u8]) -> Self {
        let recipe = carried_recipe(name, bytes).ok().filter(|(_, carrier)| *carrier == Carrier::Result);
        Self { job: recipe.map(|(recipe, _)| recipe.job) }
    }

    fn fill(&self) -> Option<&Fill> {
        match &self.job {
            Some(Job::Fill(fill)) => Some(fill),
            _ => None,
        }
    }

    /// Whether a field turns the pattern.
    pub(super) fn is_turned(&self) -> bool {
        self.fill().is_some_and(|fill| fill.orient.is_some())
    }

    /// Whether a field scales it.
    pub(super) fn is_scaled(&self) -> bool {
        match &self.job {
            Some(Job::Fill(fill)) => fill.scale.is_some(),
            Some(Job::Space(space)) => space.scale.is_some(),
            _ => false,
        }
    }

    /// The page of points, which do not show it.
    pub(super) fn page(&self) -> Option<Bounds<2>> {
        let fill = self.fill().filter(|fill| fill.domain.is_none())?;
        let size = fill.size.filter(|size| size.unit.is_none())?;
        Some(Bounds::new(Vector::ZERO, Vector(size.sides)))
    }

    /// The box of what lies in space.
    pub(super) fn cuboid(&self) -> Option<Bounds<3>> {
        match &self.job {
            Some(Job::Space(space)) => space.cuboid.map(|cuboid| cuboid.bounds()),
            _ => None,
        }
    }

    /// What a drawing fills, and its name: the shape that was asked for or that its recipe has, else its page.
    pub(super) fn domain(
        &self,
        own: &Drawing,
        result: &Drawing,
        asked: Option<&Input>,
        resources: &Resources,
    ) -> Result<(Domain<2>, &'static str)> {
        let budget = resources.budget();
        if let Some(input) = asked {
            let shape = shape(input, &resources.read_as("--domain", input)?, result, &budget)?;
            return Ok((Domain::Region(Arc::new(shape)), "shape"));
        }
        // The whole page, also where what is on it lies in a corner.
        let page = Domain::Box(result.page.view);
        let Some(fill) = self.fill() else { return Ok((page, "page")) };
        // A recipe is believed as far as it can be: a shape that is gone is no reason not to measure.
        let known = match &fill.domain {
            Some(input) => resources.read(input).and_then(|bytes| shape(input, &bytes, result, &budget)).ok(),
            None if fill.size.is_none() && fill.tile.is_none() => own.job.domain.clone(),
            None => None,
        };
        Ok(known.map_or((page, "page"), |shape| (Domain::Region(Arc::new(shape)), "shape")))
    }
}

/// A shape in the coordinates of a result.
fn shape(input: &Input, bytes: &[u8], result: &Drawing, budget: &Budget) -> Result<Shape> {
    let name = input.name();
    let options = ReadOptions { budget: budget.clone(), ..ReadOptions::new(name) };
    let (shape, page) = svg::read_shape(&file::decode_text(name, bytes, budget)?, input.id.as_deref(), &options)?;
    let factor = pixels_per_user(&page) / pixels_per_user(&result.page);
    if !(factor.is_finite() && factor > 0.0) || (factor - 1.0).abs() < 1e-6 {
        return Ok(shape);
    }
    let rings = shape.outline().rings.iter().map(|ring| ring.iter().map(|&p| p * factor).collect()).collect();
    Shape::try_from_outline(Outline { rings }, budget)?
        .ok_or_else(|| Error::input(name, "a shape without area", "draw a closed shape"))
}
