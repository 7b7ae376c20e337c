//! The whole report: what is measured of what, in order.

use arabesque_core::{Budget, Domain, Error, Exemplar, Limits, Result};

use crate::{
    copies::copies,
    elements::{
        shapes::matches,
        told::{Judged, elements},
    },
    neighbours::{
        clearance::neighbours,
        distances::{Neighbourhood, distances},
        overlaps::overlaps,
        pairs::pairs,
    },
    report::Report,
    scene::{Scene, spacing},
    spread::{
        border::edges,
        density::density,
        evenness::{Field, evenness},
        raster::pitch,
    },
    strokes::{Graph, Strokes, strokes},
};

/// A result to be measured.
#[derive(Clone, Debug)]
pub struct Subject<'a, const D: usize> {
    /// Its elements, strokes and areas. Its classes may be other ones than those of the exemplar.
    pub content: &'a Exemplar<D>,
    /// What it fills: its page, or a shape on it.
    pub domain: Domain<D>,
    /// Of each element the one of the exemplar that it says it is a copy of. May be shorter, or empty.
    pub sources: &'a [Option<usize>],
}

/// What is judged. Default: everything.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Whether elements and strokes must lie in the directions of the exemplar: not where a field has turned the pattern.
    pub turns: bool,
    /// Whether elements must be as large as those of the exemplar: not where a field has scaled the pattern.
    pub sizes: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { turns: true, sizes: true }
    }
}

/// Elements of which figures are told of an exemplar.
const FEWEST: usize = 4;
/// Largest cells that tell anything of ink, in spacings.
const COARSEST: f64 = 0.25;
/// Spacings along the shorter side of a domain in which anything can be measured.
const SIDES: f64 = 2.0;

/// Measures a result beside its exemplar.
///
/// # Errors
/// [`Error::Input`] when the result is too small to be measured, [`Error::Limit`] when the budget is used up, [`Error::Stopped`] when
/// somebody asked to stop.
pub fn measure<const D: usize>(
    place: &str,
    exemplar: &Exemplar<D>,
    subject: &Subject<'_, D>,
    options: Options,
    budget: &Budget,
) -> Result<Report> {
    let budget = &budget.stage("measuring");
    let spacing = spacing(exemplar);
    let side = subject.domain.bounds().size().0.into_iter().fold(f64::INFINITY, f64::min);
    if side.is_nan() || side < SIDES * spacing {
        let problem = format!(
            "{} across, where the elements or lines of the exemplar are {} apart",
            arabesque_core::rounded(side),
            arabesque_core::rounded(spacing)
        );
        return Err(Error::input(place, problem, "measure a page of several spacings"));
    }
    check_room(&subject.domain, spacing, budget)?;
    let matches = matches(exemplar, subject.content, subject.sources, budget)?;
    let own = Scene::new(exemplar, Domain::Box(exemplar.window), spacing, budget)?;
    let found = Scene::new(subject.content, subject.domain.clone(), spacing, budget)?
        .with_classes(matches.iter().map(|m| m.class), exemplar.classes.len());
    let mut report = Report {
        elements: [own.bodies.len(), found.bodies.len()],
        strokes: [own.lines.len(), found.lines.len()],
        spacing,
        ..Report::default()
    };
    spread(&mut report, &own, &found, budget)?;
    if own.bodies.len() >= FEWEST {
        pairwise(&mut report, &own, &found, budget)?;
        let judged = Judged { turns: options.turns, sizes: options.sizes };
        let (measures, marks) = elements(exemplar, (&found, &matches), judged);
        report.measures.extend(measures);
        report.marks.extend(marks);
    } else if own.lines.is_empty() {
        report.notes.push("distances: the exemplar has too few elements".to_owned());
    }
    lines(&mut report, &own, &found, options, budget)?;
    if !options.turns {
        report.notes.push("directions: a field has turned the pattern".to_owned());
    }
    if !options.sizes {
        report.notes.push("sizes: a field has scaled the pattern".to_owned());
    }
    report.measures.sort_by_key(|m| m.family);
    Ok(report.summed())
}

/// Refuses a page that has room for more than results may have.
fn check_room<const D: usize>(domain: &Domain<D>, spacing: f64, budget: &Budget) -> Result<()> {
    let room = domain.bounds().measure() / spacing.powi(D as i32);
    let most = budget.limits().output_elements;
    if room <= most as f64 {
        return Ok(());
    }
    Err(Error::Limit {
        what: "size of the page".into(),
        found: format!("room for about {room:.0} elements"),
        limit: format!("{most} elements"),
        advice: format!("measure a part of it{}", Limits::raising("output-elements", room)),
    })
}

/// How things are spread over the page.
fn spread<const D: usize>(
    report: &mut Report,
    own: &Scene<'_, D>,
    found: &Scene<'_, D>,
    budget: &Budget,
) -> Result<()> {
    let (measures, classes) = density(own, found);
    report.measures.extend(measures);
    report.functions.density = classes;
    let pitch = pitch(own.spacing, &[own.domain.bounds(), found.domain.bounds()]);
    if pitch > COARSEST * own.spacing {
        report.notes.push("evenness: the page is too large to be looked at finely enough".to_owned());
        return Ok(());
    }
    let fields = [Field::of(own, pitch, budget)?, Field::of(found, pitch, budget)?];
    match evenness((own, &fields[0]), (found, &fields[1])) {
        Some(told) => {
            report.measures.extend(told.measures);
            report.functions.empty_space = told.curve;
            report.marks.extend(told.marks);
        }
        None => report.notes.push("evenness: there is no ink away from the border".to_owned()),
    }
    report.measures.extend(edges((own, &fields[0]), (found, &fields[1]), budget)?);
    Ok(())
}

/// Elements two by two.
fn pairwise<const D: usize>(
    report: &mut Report,
    own: &Scene<'_, D>,
    found: &Scene<'_, D>,
    budget: &Budget,
) -> Result<()> {
    let near = [neighbours(own, budget)?, neighbours(found, budget)?];
    let (measures, curves) =
        distances(&Neighbourhood { scene: own, near: &near[0] }, &Neighbourhood { scene: found, near: &near[1] });
    if measures.is_empty() {
        report.notes.push("distances: too few elements lie away from the border".to_owned());
    }
    report.measures.extend(measures);
    report.functions.nearest = curves;
    let (measure, curves) = pairs(own, found, budget)?;
    report.measures.extend(measure);
    report.functions.pairs = curves;
    let (measures, marks) = overlaps((own, &near[0]), (found, &near[1]), budget)?;
    report.measures.extend(measures);
    report.marks.extend(marks);
    Ok(())
}

/// Strokes, and what was taken over in one piece.
fn lines<const D: usize>(
    report: &mut Report,
    own: &Scene<'_, D>,
    found: &Scene<'_, D>,
    options: Options,
    budget: &Budget,
) -> Result<()> {
    let graphs = [Graph::of(own, budget)?, Graph::of(found, budget)?];
    let (measures, marks) = strokes(
        &Strokes { scene: own, graph: &graphs[0] },
        &Strokes { scene: found, graph: &graphs[1] },
        options.turns,
    );
    report.measures.extend(measures);
    report.marks.extend(marks);
    match copies((own, &graphs[0]), (found, &graphs[1]), budget)? {
        Some((measures, marks)) => {
            report.measures.extend(measures);
            report.marks.extend(marks);
        }
        None => report.notes.push("copies: too few elements and junctions to recognise a part by".to_owned()),
    }
    Ok(())
}
