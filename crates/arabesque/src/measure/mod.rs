//! How good results are, beside their exemplar.

mod picture;
mod report;
mod subject;
mod text;

use arabesque_core::{Budget, Domain, Error, Exemplar, Result};
use arabesque_measure::{Options, Subject, measure as measure_content};

use crate::{exemplar::LoadedExemplar, recipe::Input, resources::Resources};
use subject::{Found, Intent, read};

pub use arabesque_measure::{Family, FamilyFault, Measure, Verdict};
pub use report::{MeasureOptions, MeasureReport, Measurements};

/// What is being done, for messages about limits.
const MEASURING: &str = "reading and measuring";

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
    let budget = resources.budget().stage(MEASURING);
    let loaded = LoadedExemplar::read(exemplar, &bytes, options.reading, &budget)?;
    let mut work = budget.millions();
    let mut reports = Vec::new();
    for result in results {
        // Each has the whole of the limits for itself.
        let budget = resources.budget().stage(MEASURING);
        reports.push(one((&loaded, result), options, resources, &budget)?);
        work += budget.millions();
    }
    Ok(Measurements { version: env!("CARGO_PKG_VERSION"), exemplar: exemplar.name().to_owned(), reports, work })
}

fn one(
    (exemplar, input): (&LoadedExemplar, &Input),
    options: &MeasureOptions,
    resources: &Resources,
    budget: &Budget,
) -> Result<MeasureReport> {
    let bytes = resources.read_as("result", input)?;
    let intent = Intent::of(input.name(), &bytes);
    let found = read(exemplar, input, &bytes, options.reading, budget)?;
    let judged = Options {
        turns: !options.any_direction && !intent.is_turned(),
        sizes: !options.any_size && !intent.is_scaled(),
    };
    let name = input.name();
    match (exemplar, found) {
        (LoadedExemplar::Drawing(own, _), Found::Drawing(drawing)) => {
            let (domain, what) = intent.domain(own, &drawing, options.domain.as_ref(), resources)?;
            let sources: Vec<Option<usize>> = drawing.fragments.iter().map(|f| f.source).collect();
            let subject = Subject { content: &drawing.exemplar, domain, sources: &sources };
            let report = measure_content(name, &own.exemplar, &subject, judged, budget)?;
            Ok(MeasureReport { file: name.to_owned(), kind: "drawing", domain: what, report, drawing: Some(drawing) })
        }
        (LoadedExemplar::Points(own), Found::Points(content)) => {
            let drawing = crate::exemplar::points_as_drawing(&content);
            let domain = Domain::Box(intent.page().unwrap_or(content.window));
            let report = plain(name, (own, &content, domain), judged, budget)?;
            let drawing = Some(Box::new(drawing));
            Ok(MeasureReport { file: name.to_owned(), kind: "points", domain: "page", report, drawing })
        }
        (LoadedExemplar::Space(own, _), Found::Space(content)) => {
            let domain = Domain::Box(intent.cuboid().unwrap_or(content.window));
            let report = plain(name, (own, &content, domain), judged, budget)?;
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
