//! Ribbons: pictures and drawings along curves of the plane or of space.

use std::sync::Arc;

use arabesque_core::{Bounds, Error, Image, Outline, Path, Result, Vector, Warning, Watch};
use arabesque_io::{
    file,
    image::{self, Alpha},
    mask::Region,
    obj, png,
    svg::{self, Area, Page, Unit},
};
use arabesque_ribbons::{self as ribbons, Exemplar, Mask, Params, Prepared as Engine};

use crate::{
    Artwork, Format, Input, Job, Ribbon, Size,
    artwork::{RibbonMade, resolution_of_canvas},
    method::{Method, Ready},
    prepare::{Files, Preparation, Session, Show, place::options},
};

/// Rows of an SVG exemplar as a picture for the search, unless one pixel a unit gives a number in the range below.
const ROWS: f64 = 96.0;
const USUAL_ROWS: [f64; 2] = [48.0, 192.0];
/// A ribbon wider than this many heights of the exemplar leaves most of its room empty.
const WIDE: f64 = 4.0;

/// Exemplars of ribbons, analysed.
#[derive(Debug)]
pub(crate) struct RibbonReady {
    pub(crate) engine: Engine,
    /// The exemplars as files have them.
    pub(crate) sources: Vec<Source>,
    /// Pixels of the search per pixel or unit of the exemplars.
    finer: f64,
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
    Plane { request: ribbons::Request<2>, page: Page },
    /// Curves in space.
    Space { request: ribbons::Request<3> },
}

impl Method for Ribbon {
    /// PNG, or GLB for curves in space.
    fn usual_format(&self, _: &Input) -> Format {
        let in_space = Format::of_path(&self.along.path).ok().flatten() == Some(Format::Obj);
        if in_space { Format::Glb } else { Format::Png }
    }

    fn fixed(&self) -> Job {
        Job::Ribbon(Self {
            along: Input::default(),
            changes: Vec::new(),
            size: None,
            first: None,
            avoid: Vec::new(),
            ..self.clone()
        })
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<Arc<dyn Ready>> {
        let mut params = self.engine_params()?;
        let mut ribbon = self.clone();
        let mut loading =
            Loading { ribbon: &mut ribbon, files: preparation.files, warnings: &mut preparation.warnings };
        let (exemplars, sources, finer) = loading.exemplars(&mut preparation.exemplar, &mut params)?;
        preparation.warnings.extend(width_warning(&params, &exemplars));
        let names: Vec<&str> = sources.iter().map(|s| s.name.as_str()).collect();
        let engine = Engine::new(exemplars, params).map_err(|error| named(error, &names))?;
        preparation.job = Job::Ribbon(ribbon);
        Ok(Arc::new(RibbonReady { engine, sources, finer }))
    }
}

/// The exemplars on their way into memory.
struct Loading<'a> {
    ribbon: &'a mut Ribbon,
    files: &'a Files,
    warnings: &'a mut Vec<Warning>,
}

impl Loading<'_> {
    /// The exemplars as pictures, which are embedded, and the pixels of the search per pixel or unit of theirs; `params` then counts
    /// in pixels of the search.
    fn exemplars(&mut self, first: &mut Input, params: &mut Params) -> Result<(Vec<Exemplar>, Vec<Source>, f64)> {
        let (mut exemplars, mut sources) = (Vec::new(), Vec::new());
        let mut finer = None;
        let mut then = std::mem::take(&mut self.ribbon.then);
        for input in std::iter::once(first).chain(&mut then) {
            let bytes = self.files.embed(input)?;
            let (image, source) = self.exemplar(input, &bytes, &mut finer)?;
            exemplars.push(Exemplar::new(image));
            sources.push(source);
        }
        self.ribbon.then = then;
        check_alike(&sources)?;
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
        Ok((exemplars, sources, factor))
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
        let (image, alpha) = image::read_image(name, bytes, &self.files.limits())?;
        if alpha == Alpha::Missing && !self.ribbon.relax {
            let problem = "a picture without an alpha channel, where a transparent background was expected to outline the pattern";
            let advice = "save it with transparency, or use --relax, which takes the picture as a texture and cuts it";
            return Err(Error::input(name, problem, advice));
        }
        Ok((image, Source { name: path, areas: None }))
    }

    /// A drawing as a picture, as areas in pixels of the picture, and the pixels a user unit.
    fn drawing(&mut self, name: &str, text: &str, finer: Option<f64>) -> Result<(Image, Vec<Area>, f64)> {
        let taken = svg::read_areas(text, &options(&Input::file(name), self.files))?;
        self.warnings.extend(taken.warnings);
        let view = taken.page.view;
        let height = view.size()[1];
        let usual = (USUAL_ROWS[0]..=USUAL_ROWS[1]).contains(&height);
        let factor = finer.unwrap_or(if usual { 1.0 } else { ROWS / height });
        if !(factor.is_finite() && factor > 0.0) {
            return Err(Error::input(name, "a page without height", "give the page a width and a height"));
        }
        let image = image::draw_svg(name, text, (view.size().0, factor), &self.files.limits())?;
        let size = view.size();
        let pixels = [image.width as f64 / size[0], image.height as f64 / size[1]];
        let to_pixels = |p: Vector<2>| Vector::xy((p - view.min)[0] * pixels[0], (p - view.min)[1] * pixels[1]);
        let rings =
            |area: &Area| area.outline.rings.iter().map(|r| r.iter().map(|p| to_pixels(*p)).collect()).collect();
        let areas = taken.areas.iter().map(|area| Area { outline: Outline { rings: rings(area) }, ..area.clone() });
        Ok((image, areas.collect(), factor))
    }
}

/// Refuses pictures beside drawings, whose pixels are not user units.
fn check_alike(sources: &[Source]) -> Result<()> {
    if sources.iter().all(|s| s.areas.is_some()) || sources.iter().all(|s| s.areas.is_none()) {
        return Ok(());
    }
    Err(Error::Unsupported {
        what: "a drawing and a picture as exemplars of one ribbon".into(),
        advice: "give pictures alone, or drawings alone".into(),
    })
}

/// Warns of a ribbon that is much wider than its exemplar.
fn width_warning(params: &Params, exemplars: &[Exemplar]) -> Option<Warning> {
    let height = exemplars.iter().map(|e| e.image.height).max().unwrap_or(0) as f64 * params.scale;
    let widest = match &params.width {
        ribbons::Width::Exemplar => return None,
        ribbons::Width::Constant(width) => *width,
        ribbons::Width::Profile(stations) => stations.iter().map(|s| s.1).fold(0.0, f64::max),
    };
    (widest > WIDE * height).then(|| {
        let message =
            format!("the ribbon is up to {widest} wide, the exemplar {height} high: most of the ribbon stays empty");
        Warning::new(message, "use a smaller --width, or a larger --scale")
    })
}

impl RibbonReady {
    /// Reads the files of the request, which are embedded in the job of `session`.
    fn resolve(&self, session: &mut Session<'_>) -> Result<Track> {
        let Job::Ribbon(mut ribbon) = session.job.clone() else {
            return Err(Error::parameter("request", session.job.name(), "a request for a ribbon"));
        };
        let mut track = follow(&mut ribbon, session)?;
        let first = self.first(&ribbon)?;
        match &mut track {
            Track::Plane { request, page } => {
                request.changes.clone_from(&ribbon.changes);
                request.first = first;
                request.seed = session.seed;
                request.avoid = avoided(&mut ribbon.avoid, page, session)?;
                session.warnings.extend(off_canvas(request, page));
            }
            Track::Space { request } => {
                if !ribbon.avoid.is_empty() {
                    let advice = "leave it out, or give curves of the plane (SVG)";
                    return Err(Error::Unsupported {
                        what: "avoid with curves in space".into(),
                        advice: advice.into(),
                    });
                }
                request.changes.clone_from(&ribbon.changes);
                request.first = first;
                request.seed = session.seed;
            }
        }
        session.job = Job::Ribbon(ribbon);
        Ok(track)
    }

    /// Where the first piece begins, in pixels of the search.
    fn first(&self, ribbon: &Ribbon) -> Result<Option<(usize, i64)>> {
        let Some([column, row]) = ribbon.first else { return Ok(None) };
        let [column, row] = [column, row].map(|v| (v as f64 * self.finer).round() as i64);
        let column = usize::try_from(column)
            .map_err(|_| Error::parameter("first", format!("{column},{row}"), "a column from 0 on, and a row"))?;
        Ok(Some((column, row)))
    }
}

/// Reads the curves, whose file is embedded.
fn follow(ribbon: &mut Ribbon, session: &mut Session<'_>) -> Result<Track> {
    let files = session.files();
    let input = &mut ribbon.along;
    let bytes = files.embed(input)?;
    let (name, size): (_, Option<Size>) = (input.name(), ribbon.size);
    if png::is_png(&bytes) {
        let problem = "a picture where curves were expected";
        return Err(Error::input(name, problem, "give an SVG file with a path, or an OBJ file with l elements"));
    }
    let text = file::decode_text(name, &bytes)?;
    if is_obj(name, &text) {
        if input.id.is_some() {
            let advice = "leave the id out: all lines of an OBJ file are followed";
            return Err(Error::Unsupported { what: format!("{name}: one line by its id"), advice: advice.into() });
        }
        if size.is_some() {
            let advice = "leave the canvas out";
            return Err(Error::Unsupported { what: "a canvas for curves in space".into(), advice: advice.into() });
        }
        let curves = obj::read_lines(name, &text, &files.limits())?;
        return Ok(Track::Space { request: ribbons::Request::new(curves) });
    }
    let lines = svg::read_lines(&text, input.id.as_deref(), &options(input, files))?;
    session.warnings.extend(lines.warnings);
    let own = lines.page.unwrap_or_else(|| page_around(&lines.paths));
    let page = size.map_or(own, |size| size.on(&own).1);
    Ok(Track::Plane { request: ribbons::Request::new(lines.paths), page })
}

/// The cells of the canvas that must stay free, one for each pixel of the canvas. The files are embedded.
fn avoided(inputs: &mut [Input], page: &Page, session: &Session<'_>) -> Result<Option<Mask>> {
    if inputs.is_empty() {
        return Ok(None);
    }
    let (files, limits) = (session.files(), session.limits());
    let [width, height] = resolution_of_canvas(session.output(), Some(page))?.pixels(page, &limits)?;
    let mut region = Region::empty(page.view, width, height);
    for input in inputs {
        let bytes = files.embed(input)?;
        if png::is_png(&bytes) {
            region.add_picture(&image::read_image(input.name(), &bytes, &limits)?.0);
            continue;
        }
        let text = file::decode_text(input.name(), &bytes)?;
        region.add_outline(svg::read_shape(&text, input.id.as_deref(), &options(input, files))?.0.outline());
    }
    if region.uniform() == Some(true) {
        let advice = "make the avoided regions smaller; of a picture, transparent and light pixels are free";
        return Err(Error::no_result("what is to be avoided covers the whole canvas", advice));
    }
    let Region { bounds, width, height, cells } = region;
    Ok(Some(Mask { bounds, width, height, blocked: cells }))
}

/// Warnings of curves that lie off the canvas.
fn off_canvas(request: &ribbons::Request<2>, page: &Page) -> Vec<Warning> {
    let off = request.curves.iter().filter(|(_, path)| !path.bounds().intersects(&page.view));
    let advice = "move it onto the page, or give another canvas with --on-canvas";
    off.map(|(name, _)| Warning::new(format!("{name} lies off the canvas"), advice)).collect()
}

impl Ready for RibbonReady {
    fn understood(&self) -> String {
        let sizes = self.engine.exemplars().iter().map(|e| format!("{} x {} pixels", e.image.width, e.image.height));
        format!("exemplar: {}", sizes.collect::<Vec<_>>().join(", then "))
    }

    fn run(self: Arc<Self>, mut session: Session<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        resolution_of_canvas(session.output(), None)?;
        let track = Arc::new(self.resolve(&mut session)?);
        let origin = session.origin();
        let mut made = match &*track {
            Track::Plane { request, .. } => {
                let make = |snapshot| RibbonMade::of_plane(&self, &track, snapshot);
                let outcome = self.engine.run(request, &mut Show { watch, origin: &origin, make })?;
                RibbonMade::new(&self, &track, outcome.ribbons.into(), outcome.warnings, outcome.stopped)
            }
            Track::Space { request } => {
                let make = |snapshot| RibbonMade::of_space(&self, &track, snapshot);
                let outcome = self.engine.run_in_space(request, &mut Show { watch, origin: &origin, make })?;
                RibbonMade::new(&self, &track, outcome.ribbons.into(), outcome.warnings, outcome.stopped)
            }
        };
        if made.pieces() == 0 {
            return Err(Error::no_result("stopped before anything was placed", "give it more time"));
        }
        made.warnings.splice(0..0, session.warnings);
        Ok(Artwork::new(origin, made))
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
