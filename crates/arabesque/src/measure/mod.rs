//! How good results are, beside their exemplar.

mod picture;
mod subject;
mod text;

use arabesque_core::{Domain, Error, Exemplar, Result};
use arabesque_io::svg::Drawing;
use arabesque_measure::{Options, Subject, measure as measure_content};
use schemars::JsonSchema;
use serde::Serialize;

use crate::{
    exemplar::LoadedExemplar,
    recipe::{Input, Reading},
    resources::Resources,
};
use subject::{Found, Intent, read};

pub use arabesque_measure::{Family, FamilyFault, Measure, Verdict};

/// How results are measured. Default: as they are, on their whole pages or in the shapes that their recipes fill.
#[derive(Clone, Debug, Default)]
pub struct MeasureOptions {
    /// What the exemplar and the results are taken for.
    pub reading: Reading,
    /// The shape that the results fill, where it is not the page.
    pub domain: Option<Input>,
    /// Whether directions are left out, because the pattern was turned on purpose. A recipe with a direction field says so by itself.
    pub any_direction: bool,
    /// Whether sizes are left out, because the pattern was scaled on purpose. A recipe with a scale field says so by itself.
    pub any_size: bool,
}

/// The reports of several results of one exemplar.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[schemars(title = "Measurements")]
pub struct Measurements {
    /// Version of arabesque.
    pub version: &'static str,
    /// Name of the exemplar.
    pub exemplar: String,
    /// One report a result, in their order.
    pub reports: Vec<MeasureReport>,
}

/// The report of one result.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct MeasureReport {
    /// Name of the result.
    pub file: String,
    /// `drawing`, `points`, `points in space` or `curves in space`.
    pub kind: &'static str,
    /// What it fills: `page`, or `shape`.
    pub domain: &'static str,
    /// What was measured.
    #[serde(flatten)]
    pub report: arabesque_measure::Report,
    /// The result, for the picture.
    #[serde(skip)]
    drawing: Option<Box<Drawing>>,
}

impl Measurements {
    /// The JSON schema of what `measure --json` writes.
    pub fn schema() -> String {
        serde_json::to_string_pretty(&schemars::schema_for!(Self)).unwrap_or_default() + "\n"
    }
}

/// Measures results beside their exemplar.
///
/// # Errors
/// As [`LoadedExemplar::read`] and [`Resources::read`]; [`Error::Input`] when a result is not of the kind of the exemplar, or too small.
pub fn measure(
    exemplar: &Input,
    results: &[Input],
    options: &MeasureOptions,
    resources: &Resources,
) -> Result<Measurements> {
    let bytes = resources.read_as("exemplar", exemplar)?;
    let loaded = LoadedExemplar::read(exemplar, &bytes, options.reading, &resources.budget())?;
    let one = |result: &Input| one(&loaded, result, options, resources);
    Ok(Measurements {
        version: env!("CARGO_PKG_VERSION"),
        exemplar: exemplar.name().to_owned(),
        reports: results.iter().map(one).collect::<Result<_>>()?,
    })
}

fn one(
    exemplar: &LoadedExemplar,
    input: &Input,
    options: &MeasureOptions,
    resources: &Resources,
) -> Result<MeasureReport> {
    let budget = resources.budget();
    let bytes = resources.read_as("result", input)?;
    let intent = Intent::of(input.name(), &bytes);
    let found = read(exemplar, input, &bytes, options.reading, &budget)?;
    let judged = Options {
        turns: !options.any_direction && !intent.is_turned(),
        sizes: !options.any_size && !intent.is_scaled(),
    };
    let name = input.name();
    match (exemplar, found) {
        (LoadedExemplar::Drawing(own, _), Found::Drawing(drawing)) => {
            let (domain, what) = intent.domain(own, &drawing, options, resources)?;
            let sources: Vec<Option<usize>> = drawing.fragments.iter().map(|f| f.source).collect();
            let subject = Subject { content: &drawing.exemplar, domain, sources: &sources };
            let report = measure_content(name, &own.exemplar, &subject, judged, &budget)?;
            Ok(MeasureReport { file: name.to_owned(), kind: "drawing", domain: what, report, drawing: Some(drawing) })
        }
        (LoadedExemplar::Points(own), Found::Points(content)) => {
            let drawing = crate::exemplar::points_as_drawing(&content);
            let domain = Domain::Box(intent.page().unwrap_or(content.window));
            let report = plain(name, (own, &content, domain), judged, &budget)?;
            let drawing = Some(Box::new(drawing));
            Ok(MeasureReport { file: name.to_owned(), kind: "points", domain: "page", report, drawing })
        }
        (LoadedExemplar::Space(own, _), Found::Space(content)) => {
            let domain = Domain::Box(intent.cuboid().unwrap_or(content.window));
            let report = plain(name, (own, &content, domain), judged, &budget)?;
            let kind = if own.curves.is_empty() { "points in space" } else { "curves in space" };
            Ok(MeasureReport { file: name.to_owned(), kind, domain: "page", report, drawing: None })
        }
        (exemplar, found) => Err(Error::input(
            name,
            format!("{}, where the exemplar is {}", found.kind(), subject::kind(exemplar)),
            "measure results of the kind of their exemplar",
        )),
    }
}

/// A report of what says nothing about itself.
fn plain<const D: usize>(
    name: &str,
    (own, content, domain): (&Exemplar<D>, &Exemplar<D>, Domain<D>),
    judged: Options,
    budget: &arabesque_core::Budget,
) -> Result<arabesque_measure::Report> {
    measure_content(name, own, &Subject { content, domain, sources: &[] }, judged, budget)
}
