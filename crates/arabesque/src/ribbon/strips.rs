//! The exemplars of ribbons, as pictures.

use arabesque_core::{Budget, Error, Held, Image, Outline, Result, Vector, Warning, rounded};
use arabesque_io::{
    file,
    raster::{
        image::{self, Alpha},
        png,
        rows::picture_size,
    },
    svg::{self, Area},
};
use arabesque_ribbons::{Prepared as Engine, RibbonParams, StripExemplar, Width, check_pixels};

use crate::{
    method::Preparation,
    plane::options,
    recipe::{Input, Job, Ribbon},
    resources::Files,
};

/// Rows of an SVG exemplar as a picture for the search, unless one pixel a unit gives a number in the range below.
const ROWS: f64 = 96.0;
const USUAL_ROWS: [f64; 2] = [48.0, 192.0];
/// A ribbon wider than this many heights of the exemplar leaves most of its room empty.
const WIDE: f64 = 4.0;

/// Exemplars of ribbons, analysed.
#[derive(Debug)]
pub(crate) struct RibbonStrips {
    pub(crate) engine: Engine,
    /// The exemplars as files have them.
    pub(crate) sources: Vec<Source>,
    /// Pixels of the search per pixel or unit of the exemplars.
    pub(crate) finer: f64,
    /// The memory of the pictures.
    _held: Held,
}

/// An exemplar as its file has it.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) name: String,
    /// Its areas in pixels of the picture, where it is a drawing.
    pub(crate) areas: Option<Vec<Area>>,
}

/// Reads the exemplars of a ribbon and analyses them.
pub(crate) fn read(ribbon: &Ribbon, preparation: &mut Preparation<'_>) -> Result<RibbonStrips> {
    let mut params = ribbon.engine_params()?;
    let mut ribbon = ribbon.clone();
    let (files, coarse, warnings) = (preparation.files, params.coarse, &mut preparation.warnings);
    let mut loading = Loading { ribbon: &mut ribbon, files, warnings, coarse, pixels: 0 };
    let (exemplars, sources, finer) = loading.exemplars(&mut preparation.exemplar, &mut params)?;
    let pixels = exemplars.iter().map(|e| e.image.pixels.len()).sum::<usize>();
    let held = files.budget().hold("pictures of the exemplars", pixels * size_of::<[u8; 4]>())?;
    preparation.warnings.extend(width_warning(&params, &exemplars));
    let names: Vec<&str> = sources.iter().map(|s| s.name.as_str()).collect();
    let engine = Engine::new(exemplars, params, files.budget()).map_err(|error| named(error, &names))?;
    preparation.job = Job::Ribbon(ribbon);
    Ok(RibbonStrips { engine, sources, finer, _held: held })
}

/// The exemplars on their way into memory.
struct Loading<'a> {
    ribbon: &'a mut Ribbon,
    files: &'a Files,
    warnings: &'a mut Vec<Warning>,
    /// Pixels along each side that the search takes as one.
    coarse: usize,
    /// Pixels of all exemplars so far.
    pixels: usize,
}

impl Loading<'_> {
    /// Refuses more pixels than the search can take, before they are read.
    fn count(&mut self, name: &str, [width, height]: [f64; 2]) -> Result<()> {
        // A float too large for the integer becomes its largest value.
        self.pixels = self.pixels.saturating_add((width * height) as usize);
        check_pixels(self.pixels, self.coarse).map_err(|error| named(error, &[name]))
    }

    /// The exemplars as pictures, which are embedded, and the pixels of the search per pixel or unit of theirs; `params` then counts
    /// in pixels of the search.
    fn exemplars(
        &mut self,
        first: &mut Input,
        params: &mut RibbonParams,
    ) -> Result<(Vec<StripExemplar>, Vec<Source>, f64)> {
        let (mut exemplars, mut sources) = (Vec::new(), Vec::new());
        let mut finer = None;
        let mut then = std::mem::take(&mut self.ribbon.then);
        for input in std::iter::once(first).chain(&mut then) {
            let bytes = self.files.embed(input)?;
            let (image, source) = self.exemplar(input, &bytes, &mut finer)?;
            exemplars.push(StripExemplar::new(image));
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
        if let Some(text) = drawing_text(name, bytes, self.files.budget())? {
            let (image, areas, factor) = self.drawing(name, &text, *finer)?;
            *finer = Some(factor);
            return Ok((image, Source { name: path, areas: Some(areas) }));
        }
        self.count(name, picture_size(name, bytes)?.map(|n| n as f64))?;
        let (image, alpha) = image::read_image(name, bytes, self.files.budget())?;
        if alpha == Alpha::Missing && !self.ribbon.relax {
            let problem = "a picture without an alpha channel, where a transparent background was expected to outline the pattern";
            let advice = "save it with transparency, or use --relax, which takes the picture as a texture and cuts it";
            return Err(Error::input(name, problem, advice));
        }
        Ok((image, Source { name: path, areas: None }))
    }

    /// A drawing as a picture, as areas in pixels of the picture, and the pixels per user unit.
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
        self.count(name, view.size().0.map(|side| (side * factor).round().max(1.0)))?;
        let image = image::draw_svg(name, text, (view.size().0, factor), self.files.budget())?;
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

/// The text of an exemplar that is a drawing; `None` for anything else.
fn drawing_text(name: &str, bytes: &[u8], budget: &Budget) -> Result<Option<String>> {
    if png::is_png(bytes) {
        return Ok(None);
    }
    match file::decode_text(name, bytes, budget) {
        Ok(text) => Ok(Some(text).filter(|text| text.trim_start().starts_with('<'))),
        Err(Error::Input { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Warns of a ribbon that is much wider than its exemplar.
fn width_warning(params: &RibbonParams, exemplars: &[StripExemplar]) -> Option<Warning> {
    let height = exemplars.iter().map(|e| e.image.height).max().unwrap_or(0) as f64 * params.scale;
    let widest = match &params.width {
        Width::Exemplar => return None,
        Width::Constant(width) => *width,
        Width::Profile(stations) => stations.iter().map(|s| s.1).fold(0.0, f64::max),
    };
    (widest > WIDE * height).then(|| {
        let message = format!(
            "the ribbon is up to {} wide, the exemplar {} high: most of the ribbon stays empty",
            rounded(widest),
            rounded(height)
        );
        Warning::new(message, "use a smaller --width, or a larger --scale")
    })
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
