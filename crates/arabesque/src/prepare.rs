//! From a recipe to a prepared run: every file is read, every unit resolved, nothing is synthesised yet.

use std::path::Path;

use arabesque_core::{
    Bounds, Domain, Error, Exemplar, Fields, Limits, Matrix, OrientationField, Outline, Request, Result, ScalarField,
    Shape, Warning,
};
use arabesque_io::{
    file,
    picture::Picture,
    png,
    svg::{self, Drawing, Page, Placed, ReadOptions, Rest},
};
use arabesque_patterns::{Params, Prepared as Engine};

use crate::{
    BorderRule, FieldSource, Input, Recipe, Size, Subject, recipe::FieldFile, size::pixels_per_user, spacing::spacing,
    subject::dots,
};

/// Nodes along the longer side of a direction field that comes from strokes.
const STROKE_NODES: usize = 128;
/// Values of black and white in a picture of scale.
const SCALE_RANGE: [f64; 2] = [0.5, 2.0];
/// Values of black and white in a picture of density.
const DENSITY_RANGE: [f64; 2] = [0.2, 1.0];
/// Shortest side of a tile, in mean spacings: in a narrower one every element would meet itself many times.
const LEAST_TILE_SIDE: f64 = 0.5;
/// Shortest side of any other domain, in mean spacings.
const LEAST_SIDE: f64 = 0.01;
/// Smallest and largest factor that a field may hold.
const FACTORS: [f64; 2] = [0.01, 100.0];

/// A run, ready to be started with any seed.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The recipe, with small inputs inside it.
    pub(crate) recipe: Recipe,
    /// The exemplar as it is drawn.
    pub(crate) drawing: Drawing,
    /// Whether the exemplar was a file of points.
    pub(crate) is_points: bool,
    pub(crate) engine: Engine<2>,
    pub(crate) request: Request<2>,
    pub(crate) page: Page,
    /// Outline of the domain where it is a shape.
    pub(crate) shape: Option<Outline<2>>,
    pub(crate) kept: Option<Placed>,
    /// The drawing of which a part is made anew.
    pub(crate) rest: Option<Rest>,
    /// What was noticed while reading.
    pub(crate) warnings: Vec<Warning>,
}

impl Recipe {
    /// Reads everything that the recipe refers to, beside `base` first, and analyses the exemplar.
    ///
    /// # Errors
    /// Whatever the files or the parameters are wrong with; the message names the file or the parameter.
    pub fn prepare(&self, base: Option<&Path>) -> Result<Prepared> {
        Preparation::new(self, base).finish()
    }

    /// The parameters of the engine that the recipe stands for.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown preset or name, or a value out of range.
    pub fn params(&self) -> Result<Params> {
        let mut params = Params::preset(&self.preset)?;
        for (name, value) in &self.set {
            params.set(name, value)?;
        }
        let shortcuts = [
            ("radius", self.radius.map(|v| v.to_string())),
            ("levels", self.levels.map(|v| v.to_string())),
            ("iterations", self.iterations.map(|v| v.to_string())),
        ];
        for (name, value) in shortcuts {
            if let Some(value) = value {
                params.set(name, &value)?;
            }
        }
        Ok(params)
    }
}

/// A domain with the page that shows it.
pub(crate) struct Place {
    pub(crate) domain: Domain<2>,
    pub(crate) shape: Option<Outline<2>>,
    pub(crate) page: Page,
}

/// On the way from a recipe to a prepared run.
pub(crate) struct Preparation<'a> {
    pub(crate) recipe: Recipe,
    pub(crate) base: Option<&'a Path>,
    pub(crate) limits: Limits,
    pub(crate) warnings: Vec<Warning>,
}

impl<'a> Preparation<'a> {
    pub(crate) fn new(recipe: &Recipe, base: Option<&'a Path>) -> Self {
        Self { recipe: recipe.clone(), base, limits: Limits::default(), warnings: Vec::new() }
    }
}

impl Preparation<'_> {
    fn finish(mut self) -> Result<Prepared> {
        // What is wrong on the command line is told before what is wrong in a file.
        let params = self.recipe.params()?;
        let sizes = [&self.recipe.size, &self.recipe.tile].map(|s| s.as_deref().map(str::parse::<Size>));
        for size in sizes.into_iter().flatten() {
            size?;
        }
        self.check_version();
        let bytes = self.recipe.exemplar.read(self.base, &self.limits)?;
        let rework = self.rework(&bytes)?;
        let (mut drawing, points) = match &rework {
            Some(rework) => (rework.drawing.clone(), None),
            None => self.subject(&bytes)?,
        };
        self.recipe.exemplar = self.recipe.exemplar.carrying(&bytes);
        self.warnings.append(&mut drawing.warnings);
        let (place, rest) = match rework {
            Some(rework) => (rework.place, Some(rework.rest)),
            None => (self.place(&drawing, points.is_some())?, None),
        };
        let exemplar = points.as_ref().unwrap_or(&drawing.exemplar);
        self.check_room(exemplar, &place.domain).map_err(|error| self.in_region(error))?;
        let mut request = Request::new(place.domain);
        request.known = rest.is_some().then_some(drawing.page.view);
        request.border = self.border(exemplar, rest.is_some()).into();
        request.fields = self.fields(&drawing, &request.domain.bounds())?;
        request.obstacles = self.avoided(&drawing, points.is_some(), &request.domain)?;
        let kept = self.kept(&drawing, points.is_some())?;
        self.check_kept(kept.as_ref(), &drawing.exemplar, &request.domain);
        if let Some(kept) = kept.as_ref().or(rest.as_ref().map(|r| &r.placed)) {
            request.frozen.clone_from(&kept.placements);
            request.frozen_curves.clone_from(&kept.curves);
            request.obstacles.extend(kept.obstacles.iter().cloned());
        }
        Ok(Prepared {
            engine: Engine::new(exemplar, &params).map_err(|error| self.in_exemplar(error))?,
            is_points: points.is_some(),
            recipe: self.recipe,
            drawing,
            request,
            page: place.page,
            shape: place.shape,
            kept,
            rest,
            warnings: self.warnings,
        })
    }

    /// The rule at the border. In a region that is made anew elements count by their centres, as those do that it replaces.
    fn border(&self, exemplar: &Exemplar<2>, in_place: bool) -> BorderRule {
        let usual = if in_place && exemplar.curves.is_empty() { BorderRule::Cross } else { BorderRule::Clip };
        self.recipe.border.unwrap_or(usual)
    }

    /// The exemplar as a drawing, and as points where it is a file of points.
    fn subject(&self, bytes: &[u8]) -> Result<(Drawing, Option<Exemplar<2>>)> {
        Ok(match Subject::read(&self.recipe.exemplar, bytes, self.recipe.method, &self.limits)? {
            Subject::Drawing(drawing) => (*drawing, None),
            Subject::Points(exemplar) => (dots(&exemplar), Some(exemplar)),
            Subject::Space(..) => {
                return Err(Error::input(
                    self.recipe.exemplar.name(),
                    "an exemplar in space, where one of the plane was expected",
                    "give the box to fill with --box, such as --box 10x10x10",
                ));
            }
        })
    }

    pub(crate) fn check_version(&mut self) {
        let (theirs, ours) = (&self.recipe.arabesque, env!("CARGO_PKG_VERSION"));
        if theirs != ours {
            self.warnings.push(Warning::new(
                format!("the recipe was written by version {theirs}, and this is {ours}: the result may differ"),
                format!("use version {theirs} to repeat it exactly"),
            ));
        }
    }

    fn place(&mut self, drawing: &Drawing, is_points: bool) -> Result<Place> {
        let recipe = &self.recipe;
        let given = [recipe.size.is_some(), recipe.tile.is_some(), recipe.domain.is_some()];
        if given.iter().filter(|g| **g).count() > 1 {
            return Err(Error::parameter("domain", "more than one", "only one of size, tile and domain"));
        }
        if let Some(text) = recipe.size.as_ref().or(recipe.tile.as_ref()) {
            let size: Size = text.parse()?;
            if is_points && size.unit.is_some() {
                return Err(Error::parameter("size", text, "plain numbers, because points have no unit of length"));
            }
            let (_, page) = size.on(&drawing.page);
            let domain = if recipe.tile.is_some() { Domain::Torus(page.view) } else { Domain::Box(page.view) };
            return Ok(Place { domain, shape: None, page });
        }
        if let Some(input) = recipe.domain.clone() {
            let input = self.embedded(&input)?;
            let (shape, page) = self.shape(&input, drawing, is_points)?;
            self.recipe.domain = Some(input);
            return Ok(shaped(shape, page));
        }
        match &drawing.job.domain {
            Some(shape) => Ok(shaped(shape.clone(), drawing.page)),
            None => Err(Error::parameter(
                "domain",
                "none",
                "--size WxH, --tile WxH, --domain SHAPE.svg or --redo REGION, or an exemplar with a layer Domain",
            )),
        }
    }

    /// The input with its content where that is small: standard input can be read only once.
    pub(crate) fn embedded(&self, input: &Input) -> Result<Input> {
        Ok(input.carrying(&input.read(self.base, &self.limits)?))
    }

    fn options(&self, input: &Input) -> ReadOptions {
        ReadOptions { limits: self.limits, ..ReadOptions::new(input.name()) }
    }

    fn text(&self, input: &Input) -> Result<String> {
        file::decode_text(input.name(), &input.read(self.base, &self.limits)?)
    }

    /// A shape of another file in the units of the exemplar, and its page in the same units.
    pub(crate) fn shape(&self, input: &Input, drawing: &Drawing, is_points: bool) -> Result<(Shape, Page)> {
        let (shape, page) = svg::read_shape(&self.text(input)?, input.id.as_deref(), &self.options(input))?;
        let factor = if is_points { 1.0 } else { pixels_per_user(&page) / pixels_per_user(&drawing.page) };
        if !(factor.is_finite() && factor > 0.0) {
            return Err(Error::input(input.name(), "a page without size", "give the page a width and a height"));
        }
        if factor == 1.0 {
            return Ok((shape, page));
        }
        let rings = shape.outline().rings.iter().map(|ring| ring.iter().map(|&p| p * factor).collect()).collect();
        let scaled = Shape::from_outline(Outline { rings })
            .ok_or_else(|| Error::input(input.name(), "a shape without area", "draw a closed shape"))?;
        let view = Bounds::new(page.view.min * factor, page.view.max * factor);
        Ok((scaled, Page { view, unit: page.unit, unit_per_user: page.unit_per_user / factor }))
    }

    fn check_room(&self, exemplar: &Exemplar<2>, domain: &Domain<2>) -> Result<()> {
        let spacing = spacing(exemplar);
        let expected = domain.measure() / spacing.powi(2);
        if expected.is_nan() || expected > self.limits.output_elements as f64 {
            return Err(Error::Limit {
                what: "size of the domain".into(),
                found: format!("room for about {expected:.0} elements"),
                limit: format!("{} elements", self.limits.output_elements),
                advice: "make it smaller; sizes without a unit are in the units of the exemplar".into(),
            });
        }
        let smallest = exemplar.elements.iter().map(|e| e.outline.area()).fold(f64::INFINITY, f64::min);
        if (smallest.is_finite() && domain.measure() < smallest) || expected < 0.5 {
            return Err(Error::no_result(
                format!(
                    "the domain ({:.4} square units) is smaller than one element takes ({:.4})",
                    domain.measure(),
                    if smallest.is_finite() { smallest.max(spacing.powi(2)) } else { spacing.powi(2) }
                ),
                "make it larger; sizes without a unit are in the units of the exemplar",
            ));
        }
        let least = spacing * if domain.period().is_some() { LEAST_TILE_SIDE } else { LEAST_SIDE };
        let side = domain.bounds().size().0.into_iter().fold(f64::INFINITY, f64::min);
        if side < least {
            return Err(Error::no_result(
                format!("the domain is {side} wide, where {least:.4} is the least for elements {spacing:.4} apart"),
                "make it wider; sizes without a unit are in the units of the exemplar",
            ));
        }
        Ok(())
    }

    /// The same error with the name of the file where it speaks of the exemplar.
    fn in_exemplar(&self, error: Error) -> Error {
        let name = self.recipe.exemplar.name();
        match error {
            Error::Input { problem, advice, .. } => Error::input(name, problem, advice),
            Error::Limit { what, found, limit, advice } => {
                Error::Limit { what: format!("{name}: {what}"), found, limit, advice }
            }
            other => other,
        }
    }

    /// The same error with the name of the region that is made anew, where one is.
    fn in_region(&self, error: Error) -> Error {
        match (error, self.recipe.redo.as_ref().or(self.recipe.to.as_ref())) {
            (Error::NoResult { problem, advice }, Some(region)) => {
                Error::no_result(format!("{}: region {region}: {problem}", self.recipe.exemplar.name()), advice)
            }
            (error, _) => error,
        }
    }

    /// Warns when nothing of what is to be kept comes near the domain.
    fn check_kept(&mut self, kept: Option<&Placed>, exemplar: &Exemplar<2>, domain: &Domain<2>) {
        let (Some(kept), Some(input)) = (kept, &self.recipe.keep) else { return };
        let corners = |outline: &Outline<2>| outline.rings.concat();
        let placed = kept.placements.iter().flat_map(|placement| {
            let element = &exemplar.elements[placement.source];
            let own = corners(&element.outline).into_iter().chain([element.centre]);
            own.map(|p| placement.transform.apply(p)).collect::<Vec<_>>()
        });
        let curves = kept.curves.iter().flat_map(|drawn| drawn.path.cubics.iter().flatten().copied());
        let others = kept.obstacles.iter().flat_map(corners);
        if !curves.chain(placed).chain(others).any(|p| domain.contains(p)) {
            self.warnings.push(Warning::new(
                format!("{}: nothing of what is to be kept lies in the domain", input.name()),
                "draw it where the pattern goes, in the coordinates of the result",
            ));
        }
    }

    fn fields(&mut self, drawing: &Drawing, bounds: &Bounds<2>) -> Result<Fields<2>> {
        let orientation = match self.recipe.orient.clone() {
            Some(FieldSource::Constant(degrees)) if degrees.is_finite() => {
                Some(OrientationField::Constant(Matrix::rotation(degrees.to_radians())))
            }
            Some(FieldSource::Constant(degrees)) => {
                return Err(Error::parameter("orient", degrees, "a finite number of degrees"));
            }
            Some(FieldSource::File(source)) => {
                let file = self.embedded(&source.file)?;
                let field = self.orientation(&file, bounds)?;
                self.recipe.orient = Some(FieldSource::File(FieldFile { file, ..source }));
                Some(field)
            }
            None if drawing.job.flow.is_empty() => None,
            None => OrientationField::from_strokes(&drawing.job.flow, *bounds, STROKE_NODES),
        };
        let (scale, scale_source) = self.factor("scale", self.recipe.scale.clone(), bounds, SCALE_RANGE)?;
        let (density, density_source) = self.factor("density", self.recipe.density.clone(), bounds, DENSITY_RANGE)?;
        self.recipe.scale = scale_source;
        self.recipe.density = density_source;
        Ok(Fields { orientation, scale, density })
    }

    fn orientation(&self, input: &Input, bounds: &Bounds<2>) -> Result<OrientationField<2>> {
        let bytes = input.read(self.base, &self.limits)?;
        let is_drawing = bytes.trim_ascii_start().starts_with(b"<") || bytes.starts_with(&[0xEF, 0xBB, 0xBF, b'<']);
        if png::is_png(&bytes) || !is_drawing {
            return Picture::read(input.name(), &bytes, &self.limits)?.orientation_field(input.name(), *bounds);
        }
        let strokes = svg::read_flow(&file::decode_text(input.name(), &bytes)?, &self.options(input))?;
        OrientationField::from_strokes(&strokes, *bounds, STROKE_NODES).ok_or_else(|| {
            Error::input(
                input.name(),
                "no stroke crosses the domain",
                "draw strokes over the domain, in its coordinates",
            )
        })
    }

    /// The field of a factor, and its source with the picture inside.
    fn factor(
        &self,
        name: &str,
        source: Option<FieldSource>,
        bounds: &Bounds<2>,
        range: [f64; 2],
    ) -> Result<(ScalarField<2>, Option<FieldSource>)> {
        let expected = format!("a factor between {} and {}, or a PNG picture", FACTORS[0], FACTORS[1]);
        let allowed = |v: f64| (FACTORS[0]..=FACTORS[1]).contains(&v);
        match source {
            None => Ok((ScalarField::Constant(1.0), None)),
            Some(FieldSource::Constant(v)) if allowed(v) => Ok((ScalarField::Constant(v), source)),
            Some(FieldSource::Constant(v)) => Err(Error::parameter(name, v, expected)),
            Some(FieldSource::File(field)) => {
                let range = field.range.unwrap_or(range);
                if !range.iter().all(|v| allowed(*v)) {
                    return Err(Error::parameter(name, format!("{}..{}", range[0], range[1]), expected));
                }
                let bytes = field.file.read(self.base, &self.limits)?;
                let picture = Picture::read(field.file.name(), &bytes, &self.limits)?;
                let file = field.file.carrying(&bytes);
                let source = FieldSource::File(FieldFile { file, ..field });
                Ok((picture.scalar_field(*bounds, range), Some(source)))
            }
        }
    }

    /// The areas to keep free: those given, else the layer Avoid of the exemplar.
    fn avoided(&mut self, drawing: &Drawing, is_points: bool, domain: &Domain<2>) -> Result<Vec<Outline<2>>> {
        let mut outlines = Vec::new();
        for k in 0..self.recipe.avoid.len() {
            let input = self.embedded(&self.recipe.avoid[k])?;
            outlines.push(self.shape(&input, drawing, is_points)?.0);
            self.recipe.avoid[k] = input;
        }
        if self.recipe.avoid.is_empty() {
            outlines.extend(drawing.job.avoid.clone());
        }
        let page = Shape::rectangle(domain.bounds());
        let left = outlines.iter().try_fold(page, |left, shape| match left {
            Some(left) => Ok(left.without(shape)),
            None => Err(()),
        });
        if !outlines.is_empty() && !matches!(left, Ok(Some(_))) {
            let advice = "make the avoided shapes smaller, or the domain larger";
            return Err(Error::no_result("the avoided shapes cover the whole domain", advice));
        }
        Ok(outlines.into_iter().map(|shape| shape.outline().clone()).collect())
    }

    fn kept(&mut self, drawing: &Drawing, is_points: bool) -> Result<Option<Placed>> {
        let Some(input) = self.recipe.keep.clone() else { return Ok(None) };
        if is_points {
            return Err(Error::Unsupported {
                what: "keeping elements beside an exemplar of points".into(),
                advice: "give an SVG exemplar".into(),
            });
        }
        let input = self.embedded(&input)?;
        let mut placed = svg::read_placed(&self.text(&input)?, drawing, &self.options(&input))?;
        self.warnings.append(&mut placed.warnings);
        let units = pixels_per_user(&placed.page) / pixels_per_user(&drawing.page);
        if (units - 1.0).abs() > 1e-6 {
            self.warnings.push(Warning::new(
                format!("{}: one unit of it is {units:.4} units of the exemplar, and is taken for one", input.name()),
                "draw what is kept in the units of the exemplar",
            ));
        }
        self.recipe.keep = Some(input);
        Ok(Some(placed))
    }
}

/// A shape as the place to fill.
pub(crate) fn shaped(shape: Shape, page: Page) -> Place {
    let outline = shape.outline().clone();
    Place { domain: Domain::Region(std::sync::Arc::new(shape)), shape: Some(outline), page }
}

impl Prepared {
    /// What was noticed while reading.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The recipe, with small inputs inside it.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Number of elements and of classes of the exemplar.
    pub fn exemplar_size(&self) -> (usize, usize) {
        (self.drawing.exemplar.elements.len(), self.drawing.exemplar.classes.len())
    }

    /// Number of curves and of styles of the exemplar.
    pub fn exemplar_curves(&self) -> (usize, usize) {
        (self.drawing.exemplar.curves.len(), self.drawing.exemplar.styles.len())
    }
}
