//! From a recipe to ribbons: files are read, exemplars prepared, curves measured.

use std::path::Path as FilePath;

use arabesque_core::{Bounds, Error, Image, Limits, Observer, Outline, Path, Result, StopReason, Vector, Warning};
use arabesque_io::{
    file,
    image::{self, Alpha},
    mask::Region,
    obj, png,
    svg::{self, Area, Page, ReadOptions, Unit},
};
use arabesque_ribbons::{Mask, Prepared as Engine, Ribbon, RibbonParams, RibbonRequest, StripExemplar, Width};

use crate::{
    Format, Input, OutputOptions, Recipe, RibbonRecipe, Size, prepare::Preparation, ribbon_picture::resolution,
};

/// Rows of an SVG exemplar as a picture for the search, unless one pixel a unit gives a number in the range below.
const ROWS: f64 = 96.0;
const USUAL_ROWS: [f64; 2] = [48.0, 192.0];
/// A ribbon wider than this many heights of the exemplar leaves most of its room empty.
const WIDE: f64 = 4.0;

/// A run of ribbons, ready to be started with any seed.
#[derive(Clone, Debug)]
pub struct RibbonPrepared {
    pub(crate) recipe: Recipe,
    pub(crate) engine: Engine,
    /// The exemplars as files have them.
    pub(crate) sources: Vec<Source>,
    pub(crate) track: Track,
    warnings: Vec<Warning>,
}

/// An exemplar as its file has it.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) name: String,
    /// Its areas in pixels of the picture, where it is a drawing.
    pub(crate) areas: Option<Vec<Area>>,
}

/// What the pattern follows.
#[derive(Clone, Debug)]
pub(crate) enum Track {
    /// Curves on a page.
    Plane { request: RibbonRequest<2>, page: Page },
    /// Curves in space.
    Space { request: RibbonRequest<3> },
}

/// Ribbons of the plane or of space.
#[derive(Clone, Debug)]
pub enum Laid {
    /// On a page.
    Plane(Vec<Ribbon<2>>),
    /// In space.
    Space(Vec<Ribbon<3>>),
}

/// The result of one run of ribbons.
#[derive(Clone, Debug)]
pub struct RibbonArtwork<'a> {
    pub(crate) prepared: &'a RibbonPrepared,
    /// The ribbons, one a curve; fewer when the run was stopped.
    pub laid: Laid,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why the run ended.
    pub stopped: StopReason,
    /// Seed of the run.
    pub seed: u64,
}

impl Recipe {
    /// Whether a pattern is laid along curves: then [`Recipe::prepare_ribbon`] takes the place of [`Recipe::prepare`].
    pub fn is_ribbon(&self) -> bool {
        self.ribbon.is_some()
    }

    /// Reads the exemplars and the curves, beside `base` first, and prepares the search.
    ///
    /// # Errors
    /// Whatever the files or the parameters are wrong with; [`Error::Unsupported`] for what a ribbon has not, such as `tile`.
    pub fn prepare_ribbon(&self, base: Option<&FilePath>) -> Result<RibbonPrepared> {
        let Some(ribbon) = self.ribbon.clone() else {
            let advice = "add a table [ribbon] with the key along";
            return Err(Error::input("recipe", "no table [ribbon], where a ribbon is asked for", advice));
        };
        let preparation = Preparation::new(self, base);
        RibbonPreparation { preparation, ribbon, first: None }.finish()
    }

    /// What of this recipe has no meaning for a ribbon.
    fn not_for_ribbons(&self) -> Option<&'static str> {
        let given = [
            (self.tile.is_some(), "tile"),
            (self.cuboid.is_some(), "box"),
            (self.domain.is_some(), "domain"),
            (self.border.is_some(), "border"),
            (self.keep.is_some(), "keep"),
            (self.redo.is_some(), "redo"),
            (self.from.is_some() || self.to.is_some(), "from and to"),
            (self.orient.is_some(), "orient"),
            (self.density.is_some(), "density"),
            (self.radius.is_some(), "radius"),
            (self.levels.is_some(), "levels"),
            (self.iterations.is_some(), "iterations"),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, name)| name)
    }
}

/// On the way from a recipe to a prepared ribbon.
struct RibbonPreparation<'a> {
    preparation: Preparation<'a>,
    ribbon: RibbonRecipe,
    /// Position of the first piece, in pixels of the search.
    first: Option<(usize, i64)>,
}

impl RibbonPreparation<'_> {
    fn finish(mut self) -> Result<RibbonPrepared> {
        let recipe = &self.preparation.recipe;
        if let Some(what) = recipe.not_for_ribbons() {
            let advice = "leave it away, or leave the table [ribbon] away";
            return Err(Error::Unsupported { what: format!("{what} together with ribbon"), advice: advice.into() });
        }
        let mut params = self.ribbon.params(recipe)?;
        let size = recipe.size.as_deref().map(str::parse::<Size>).transpose()?;
        resolution(&recipe.output, None)?;
        self.preparation.check_version();
        let (exemplars, sources) = self.exemplars(&mut params)?;
        self.warn_of_width(&params, &exemplars);
        let mut track = self.track(size)?;
        match &mut track {
            Track::Plane { request, page } => {
                request.changes.clone_from(&self.ribbon.changes);
                request.first = self.first;
                request.avoid = self.avoided(page)?;
                self.warn_of_page(request, page);
            }
            Track::Space { request } => {
                self.check_space()?;
                request.changes.clone_from(&self.ribbon.changes);
                request.first = self.first;
            }
        }
        let names: Vec<&str> = sources.iter().map(|s| s.name.as_str()).collect();
        let engine = Engine::new(exemplars, params).map_err(|error| named(error, &names))?;
        let Preparation { mut recipe, warnings, .. } = self.preparation;
        recipe.ribbon = Some(self.ribbon);
        Ok(RibbonPrepared { recipe, engine, sources, track, warnings })
    }

    fn limits(&self) -> Limits {
        self.preparation.limits
    }

    fn read(&self, input: &Input) -> Result<Vec<u8>> {
        input.read(self.preparation.base, &self.limits())
    }

    /// The exemplars as pictures; `params` then counts in their pixels.
    fn exemplars(&mut self, params: &mut RibbonParams) -> Result<(Vec<StripExemplar>, Vec<Source>)> {
        let mut inputs = vec![self.preparation.recipe.exemplar.clone()];
        inputs.append(&mut self.ribbon.then);
        let (mut exemplars, mut sources) = (Vec::new(), Vec::new());
        let mut finer = None;
        for (k, input) in inputs.into_iter().enumerate() {
            let bytes = self.read(&input)?;
            let carrying = input.carrying(&bytes);
            let (image, source) = self.exemplar(&input, &bytes, &mut finer)?;
            exemplars.push(StripExemplar::new(image));
            sources.push(source);
            if k == 0 {
                self.preparation.recipe.exemplar = carrying;
            } else {
                self.ribbon.then.push(carrying);
            }
        }
        self.check_alike(&sources)?;
        let factor = finer.unwrap_or(1.0);
        params.scale /= factor;
        let column = |x: usize| (x as f64 * factor).round() as usize;
        let range = |[from, to]: [usize; 2]| column(from)..column(to);
        if let Some(first) = exemplars.first_mut() {
            first.start = self.ribbon.start.map(range);
        }
        if let Some(last) = exemplars.last_mut() {
            last.end = self.ribbon.end.map(range);
        }
        self.first = self.first(factor)?;
        Ok((exemplars, sources))
    }

    /// Refuses pictures beside drawings, whose pixels are not user units.
    fn check_alike(&self, sources: &[Source]) -> Result<()> {
        if sources.iter().all(|s| s.areas.is_some()) || sources.iter().all(|s| s.areas.is_none()) {
            return Ok(());
        }
        Err(Error::Unsupported {
            what: "a drawing and a picture as exemplars of one ribbon".into(),
            advice: "give pictures alone, or drawings alone".into(),
        })
    }

    /// An exemplar as a picture. A drawing has more or fewer pixels than user units, by a factor that `params` then counts in.
    fn exemplar(&mut self, input: &Input, bytes: &[u8], finer: &mut Option<f64>) -> Result<(Image, Source)> {
        let name = input.name();
        let path = name.to_owned();
        if !png::is_png(bytes) && file::decode_text(name, bytes).is_ok_and(|text| text.trim_start().starts_with('<')) {
            let (image, areas, factor) = self.drawing(name, &file::decode_text(name, bytes)?, *finer)?;
            *finer = Some(factor);
            return Ok((image, Source { name: path, areas: Some(areas) }));
        }
        let (image, alpha) = image::read_image(name, bytes, &self.limits())?;
        if alpha == Alpha::Missing && !self.ribbon.relax {
            let problem = "a picture without an alpha channel, where a transparent background was expected to outline the pattern";
            let advice = "save it with transparency, or use --relax, which takes the picture as a texture and cuts it";
            return Err(Error::input(name, problem, advice));
        }
        Ok((image, Source { name: path, areas: None }))
    }

    /// A drawing as a picture, as areas in pixels of the picture, and the pixels a user unit.
    fn drawing(&mut self, name: &str, text: &str, finer: Option<f64>) -> Result<(Image, Vec<Area>, f64)> {
        let options = ReadOptions { limits: self.limits(), ..ReadOptions::new(name) };
        let taken = svg::read_areas(text, &options)?;
        self.preparation.warnings.extend(taken.warnings);
        let view = taken.page.view;
        let height = view.size()[1];
        let usual = (USUAL_ROWS[0]..=USUAL_ROWS[1]).contains(&height);
        let factor = finer.unwrap_or(if usual { 1.0 } else { ROWS / height });
        if !(factor.is_finite() && factor > 0.0) {
            return Err(Error::input(name, "a page without height", "give the page a width and a height"));
        }
        let image = image::draw_svg(name, text, (view.size().0, factor), &self.limits())?;
        let size = view.size();
        let pixels = [image.width as f64 / size[0], image.height as f64 / size[1]];
        let to_pixels = |p: Vector<2>| Vector::xy((p - view.min)[0] * pixels[0], (p - view.min)[1] * pixels[1]);
        let rings =
            |area: &Area| area.outline.rings.iter().map(|r| r.iter().map(|p| to_pixels(*p)).collect()).collect();
        let areas = taken.areas.iter().map(|area| Area { outline: Outline { rings: rings(area) }, ..area.clone() });
        Ok((image, areas.collect(), factor))
    }

    fn warn_of_width(&mut self, params: &RibbonParams, exemplars: &[StripExemplar]) {
        let height = exemplars.iter().map(|e| e.image.height).max().unwrap_or(0) as f64 * params.scale;
        let widest = match &params.width {
            Width::Exemplar => return,
            Width::Constant(width) => *width,
            Width::Profile(stations) => stations.iter().map(|s| s.1).fold(0.0, f64::max),
        };
        if widest > WIDE * height {
            let message = format!(
                "the ribbon is up to {widest} wide, the exemplar {height} high: most of the ribbon stays empty"
            );
            self.preparation.warnings.push(Warning::new(message, "use a smaller --width, or a larger --scale"));
        }
    }

    /// Where the first piece begins, in pixels of the search; `factor` of them are a pixel or unit of the exemplar.
    fn first(&self, factor: f64) -> Result<Option<(usize, i64)>> {
        let Some([column, row]) = self.ribbon.first else { return Ok(None) };
        let [column, row] = [column, row].map(|v| (v as f64 * factor).round() as i64);
        let column = usize::try_from(column)
            .map_err(|_| Error::parameter("first", format!("{column},{row}"), "a column from 0 on, and a row"))?;
        Ok(Some((column, row)))
    }

    /// Reads the curves.
    fn track(&mut self, size: Option<Size>) -> Result<Track> {
        let input = self.ribbon.along.clone();
        let bytes = self.read(&input)?;
        self.ribbon.along = input.carrying(&bytes);
        let name = input.name();
        if png::is_png(&bytes) {
            let problem = "a picture where curves were expected";
            return Err(Error::input(name, problem, "give an SVG file with a path, or an OBJ file with l elements"));
        }
        let text = file::decode_text(name, &bytes)?;
        if is_obj(name, &text) {
            if input.id.is_some() {
                let advice = "leave the id away: all lines of an OBJ file are followed";
                return Err(Error::Unsupported { what: format!("{name}: one line by its id"), advice: advice.into() });
            }
            if size.is_some() {
                let advice = "leave the canvas away";
                return Err(Error::Unsupported { what: "a canvas for curves in space".into(), advice: advice.into() });
            }
            let curves = obj::read_lines(name, &text, &self.limits())?;
            return Ok(Track::Space { request: RibbonRequest::new(curves) });
        }
        let options = ReadOptions { limits: self.limits(), ..ReadOptions::new(name) };
        let lines = svg::read_lines(&text, input.id.as_deref(), &options)?;
        self.preparation.warnings.extend(lines.warnings);
        let own = lines.page.unwrap_or_else(|| page_around(&lines.paths));
        let page = size.map_or(own, |size| size.on(&own).1);
        Ok(Track::Plane { request: RibbonRequest::new(lines.paths), page })
    }

    /// Refuses what only the plane has.
    fn check_space(&self) -> Result<()> {
        if self.preparation.recipe.avoid.is_empty() {
            return Ok(());
        }
        let advice = "leave it away, or give curves of the plane (SVG)";
        Err(Error::Unsupported { what: "avoid with curves in space".into(), advice: advice.into() })
    }

    /// The cells of the canvas that must stay free; one a pixel of the canvas.
    fn avoided(&mut self, page: &Page) -> Result<Option<Mask>> {
        let inputs = std::mem::take(&mut self.preparation.recipe.avoid);
        if inputs.is_empty() {
            return Ok(None);
        }
        let scale = resolution(&self.preparation.recipe.output, Some(page))?;
        let [width, height] = scale.pixels(page, &self.limits())?;
        let mut region = Region::empty(page.view, width, height);
        for input in inputs {
            let bytes = self.read(&input)?;
            self.preparation.recipe.avoid.push(input.carrying(&bytes));
            if png::is_png(&bytes) {
                region.add_picture(&image::read_image(input.name(), &bytes, &self.limits())?.0);
                continue;
            }
            let text = file::decode_text(input.name(), &bytes)?;
            let options = ReadOptions { limits: self.limits(), ..ReadOptions::new(input.name()) };
            region.add_outline(svg::read_shape(&text, input.id.as_deref(), &options)?.0.outline());
        }
        if region.uniform() == Some(true) {
            let advice = "make the avoided regions smaller; of a picture, transparent and light pixels are free";
            return Err(Error::no_result("what is to be avoided covers the whole canvas", advice));
        }
        let Region { bounds, width, height, cells } = region;
        Ok(Some(Mask { bounds, width, height, blocked: cells }))
    }

    /// Warns of curves that lie off the canvas.
    fn warn_of_page(&mut self, request: &RibbonRequest<2>, page: &Page) {
        for (name, path) in &request.curves {
            if !path.bounds().intersects(&page.view) {
                let advice = "move it onto the page, or give another canvas with --on-canvas";
                self.preparation.warnings.push(Warning::new(format!("{name} lies off the canvas"), advice));
            }
        }
    }
}

/// The same error with the name of the exemplar's file in place of "exemplar".
fn named(error: Error, names: &[&str]) -> Error {
    match error {
        Error::Input { place, problem, advice } => {
            let number = place.strip_prefix("exemplar").map(|rest| rest.trim().parse().unwrap_or(1_usize));
            let name = number.and_then(|n| names.get(n.wrapping_sub(1)));
            Error::input(name.map_or(place.clone(), |name| (*name).to_owned()), problem, advice)
        }
        Error::Limit { what, found, limit, advice } => {
            Error::Limit { what: format!("{}: {what}", names.join(", ")), found, limit, advice }
        }
        other => other,
    }
}

fn is_obj(name: &str, text: &str) -> bool {
    Format::of_path(name).ok().flatten() == Some(Format::Obj) && !text.trim_start().starts_with('<')
}

/// A page around curves whose file states none.
fn page_around(curves: &[(String, Path<2>)]) -> Page {
    let tight = curves.iter().fold(Bounds::EMPTY, |all, (_, path)| all.union(&path.bounds()));
    let size = tight.size();
    let view = Bounds::new(tight.min, tight.max).grown(0.1 * size[0].max(size[1]).max(1.0));
    let whole = Bounds::new(view.min.map(f64::floor), view.max.map(f64::ceil));
    Page { view: whole, unit: Unit::Px, unit_per_user: 1.0 }
}

impl RibbonPrepared {
    /// What was noticed while reading.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Width and height of each exemplar, in pixels of the search.
    pub fn exemplar_sizes(&self) -> Vec<(usize, usize)> {
        self.engine.exemplars().iter().map(|e| (e.image.width, e.image.height)).collect()
    }

    /// Number of curves.
    pub fn curves(&self) -> usize {
        match &self.track {
            Track::Plane { request, .. } => request.curves.len(),
            Track::Space { request } => request.curves.len(),
        }
    }

    /// Runs with the given seed. Any number of runs may be made from one preparation.
    ///
    /// # Errors
    /// [`Error::NoResult`] where no part of an exemplar is valid for a piece, [`Error::Limit`] when a limit is reached.
    pub fn run(&self, seed: u64, observer: &mut (impl Observer<2> + Observer<3>)) -> Result<RibbonArtwork<'_>> {
        let (laid, warnings, stopped) = match &self.track {
            Track::Plane { request, .. } => {
                let outcome = self.engine.run(&RibbonRequest { seed, ..request.clone() }, observer)?;
                (Laid::Plane(outcome.ribbons), outcome.warnings, outcome.stopped)
            }
            Track::Space { request } => {
                let outcome = self.engine.run_in_space(&RibbonRequest { seed, ..request.clone() }, observer)?;
                (Laid::Space(outcome.ribbons), outcome.warnings, outcome.stopped)
            }
        };
        let warnings = self.warnings.iter().cloned().chain(warnings).collect();
        let artwork = RibbonArtwork { prepared: self, laid, warnings, stopped, seed };
        if artwork.pieces() == 0 {
            return Err(Error::no_result("stopped before anything was placed", "give it more time"));
        }
        Ok(artwork)
    }
}

impl RibbonArtwork<'_> {
    /// Number of pieces of each ribbon.
    fn lengths(&self) -> Vec<usize> {
        match &self.laid {
            Laid::Plane(ribbons) => ribbons.iter().map(|r| r.pieces.len()).collect(),
            Laid::Space(ribbons) => ribbons.iter().map(|r| r.pieces.len()).collect(),
        }
    }

    /// Number of ribbons that have a piece.
    pub fn ribbons(&self) -> usize {
        self.lengths().iter().filter(|n| **n > 0).count()
    }

    /// Number of pieces of all ribbons.
    pub fn pieces(&self) -> usize {
        self.lengths().iter().sum()
    }

    /// Cost of all ribbons together, in 8-bit colour steps.
    pub fn cost(&self) -> f64 {
        match &self.laid {
            Laid::Plane(ribbons) => ribbons.iter().map(|r| r.cost).sum(),
            Laid::Space(ribbons) => ribbons.iter().map(|r| r.cost).sum(),
        }
    }

    /// The recipe of this very result, as its file carries it.
    ///
    /// # Errors
    /// As [`Recipe::to_toml`].
    pub fn recipe(&self, output: &OutputOptions) -> Result<String> {
        // A recipe that stands alone leaves the format open: running it makes a result, not the recipe again.
        let format = output.format.filter(|f| *f != Format::Toml);
        let output = OutputOptions { path: None, format, ..output.clone() };
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Recipe { seed: self.seed, arabesque: version, output, ..self.prepared.recipe.clone() }.to_toml()
    }
}
