//! What was understood of an exemplar.

mod repeat;

pub use repeat::RepeatReport;

use std::{fmt, sync::Arc};

use arabesque_core::{Budget, Error, Exemplar, Result, Role, Warning};
use arabesque_io::{
    mesh::obj::junctions,
    raster::png::{RenderJob, Resolution, write_png},
    svg::{Drawing, Understood, write_survey},
};
use arabesque_patterns::Known;
use serde::Serialize;

use crate::{
    exemplar::{LoadedExemplar, points_as_drawing},
    recipe::{Format, Input, NO_RECIPE, Reading},
    resources::Resources,
    spacing::{length, spacing},
};

/// A scene as an exemplar.
pub(crate) struct SceneUnderstood {
    pub(crate) exemplar: Arc<Exemplar<3>>,
    /// What is to be told of it.
    pub(crate) told: Vec<String>,
    pub(crate) warnings: Vec<Warning>,
    /// Millions of units of work that reading it took.
    pub(crate) work: u64,
}

/// What was understood of an exemplar.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name of the file.
    pub file: String,
    /// `drawing`, `points`, `points in space`, `curves in space` or `scene of meshes`.
    pub kind: &'static str,
    /// Number of elements, context included.
    pub elements: usize,
    /// How many of them may be copied.
    pub sources: usize,
    /// How many are cut at the frame and serve as context only.
    pub cut_at_frame: usize,
    /// Number of curves.
    pub curves: usize,
    /// Number of filled areas that run through the frame.
    pub areas: usize,
    /// Places where three or more pieces of curves in space meet; `None` in the plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub junctions: Option<usize>,
    /// How they are painted, in order of their first curve.
    pub styles: Vec<StyleReport>,
    /// The classes, in order of their first element.
    pub classes: Vec<ClassReport>,
    /// Lower corner of the frame.
    pub frame_min: Vec<f64>,
    /// Size of the frame, in user units.
    pub frame_size: Vec<f64>,
    /// Unit of the page; `None` for points.
    pub unit: Option<&'static str>,
    /// How many of that unit one user unit is.
    pub unit_per_user: Option<f64>,
    /// Mean distance of elements, or of the lines of a net where that is smaller, in user units.
    pub spacing: f64,
    /// Neighbourhood radius that a run would use by default on its finest level, in user units.
    pub suggested_radius: f64,
    /// What everything in the file was taken for, and why; empty for points.
    pub understood: Vec<UnderstoodReport>,
    /// What else is to be told of a scene: elements of several meshes, stacks, what bends.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub told: Vec<String>,
    /// What it repeats by; `None` where it is treated as irregular.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<RepeatReport>,
    /// Layers that make the file a whole job.
    pub layers: Vec<&'static str>,
    /// What was noticed while reading.
    pub warnings: Vec<Warning>,
    /// Millions of units of work that reading and understanding took.
    pub work: u64,
    /// The picture of what was understood.
    #[serde(skip)]
    drawing: Option<Drawing>,
}

/// Things that were taken for the same for one reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UnderstoodReport {
    /// `elements`, `curves`, `background` or `left out`.
    pub taken_for: &'static str,
    /// Why.
    pub why: &'static str,
    /// How many there are.
    pub count: usize,
    /// What the first of them are called in the file.
    pub names: Vec<String>,
}

impl UnderstoodReport {
    /// What was understood of a drawing.
    pub fn of(drawing: &Drawing) -> Vec<Self> {
        let one = |known: &Understood| Self {
            taken_for: known.reason.taken_for(),
            why: known.reason.why(),
            count: known.count,
            names: known.names.clone(),
        };
        drawing.understood.iter().map(one).collect()
    }
}

impl fmt::Display for UnderstoodReport {
    /// One line, with as many names as fit.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = format!("{}: {}, {}", self.taken_for, self.count, self.why);
        let (mut named, mut shown) = (String::new(), 0);
        for name in &self.names {
            let separator = if shown > 0 { ", " } else { "" };
            if line.len() + named.len() + separator.len() + name.len() > LINE {
                break;
            }
            named.push_str(separator);
            named.push_str(name);
            shown += 1;
        }
        if shown > 0 {
            let more = if shown < self.count { ", ..." } else { "" };
            line = format!("{line} ({named}{more})");
        }
        f.write_str(&line)
    }
}

/// One class of elements.
#[derive(Clone, Debug, Serialize)]
pub struct ClassReport {
    /// Its name.
    pub name: String,
    /// How many elements it has.
    pub elements: usize,
    /// Mean diameter of its elements, in user units; 0 for points.
    pub diameter: f64,
}

/// Curves painted alike.
#[derive(Clone, Debug, Serialize)]
pub struct StyleReport {
    /// Its name.
    pub name: String,
    /// How many curves it has.
    pub curves: usize,
    /// How many of them are closed.
    pub closed: usize,
    /// Ends of the others inside the frame.
    pub ends: usize,
    /// Length of all of them, in user units.
    pub length: f64,
    /// Width of the stroke, in user units.
    pub width: f64,
}

/// Length up to which names are added to a line on what was understood.
const LINE: usize = 110;

/// Neighbours that a neighbourhood of the suggested radius holds on average.
const SUGGESTED_NEIGHBOURS: f64 = 12.0;

/// What was understood of a scene of meshes, and what is to be told of it.
pub(crate) fn of_scene(input: &Input, scene: SceneUnderstood) -> Report {
    let SceneUnderstood { exemplar, told, warnings, work } = scene;
    Report { told, warnings, work, ..describe(input, "scene of meshes", &exemplar) }
}

/// What was understood of an exemplar that is no scene of meshes.
///
/// # Errors
/// As [`LoadedExemplar::read`].
pub(crate) fn of_other(
    input: &Input,
    bytes: &[u8],
    reading: impl Into<Reading>,
    resources: &Resources,
) -> Result<Report> {
    let budget = resources.budget().stage("reading");
    let report = match LoadedExemplar::read(input, bytes, reading, &budget)? {
        LoadedExemplar::Drawing(drawing, known) => {
            let mut report = describe(input, "drawing", &drawing.exemplar);
            report.repeat = RepeatReport::of(&drawing.exemplar, known, &budget)?;
            report.unit = Some(drawing.page.unit.name());
            report.unit_per_user = Some(drawing.page.unit_per_user);
            report.understood = UnderstoodReport::of(&drawing);
            report.layers = layers(&drawing);
            report.warnings = drawing.warnings.clone();
            report.drawing = Some(*drawing);
            report
        }
        LoadedExemplar::Points(exemplar) => {
            let drawing = points_as_drawing(&exemplar);
            let repeat = RepeatReport::of(&exemplar, Known::Unasked, &budget)?;
            Report { drawing: Some(drawing), repeat, ..describe(input, "points", &exemplar) }
        }
        LoadedExemplar::Space(exemplar, warnings) => {
            let kind = if exemplar.curves.is_empty() { "points in space" } else { "curves in space" };
            Report {
                junctions: (!exemplar.curves.is_empty()).then(|| junctions(&exemplar)),
                warnings,
                ..describe(input, kind, &exemplar)
            }
        }
    };
    Ok(Report { work: budget.millions(), ..report })
}

fn layers(drawing: &Drawing) -> Vec<&'static str> {
    let job = &drawing.job;
    let found = [("Domain", job.domain.is_some()), ("Avoid", job.avoid.is_some()), ("Flow", !job.flow.is_empty())];
    found.into_iter().filter(|(_, present)| *present).map(|(name, _)| name).collect()
}

fn describe<const D: usize>(input: &Input, kind: &'static str, exemplar: &Exemplar<D>) -> Report {
    let elements = &exemplar.elements;
    let classes = exemplar.classes.iter().enumerate().map(|(k, class)| {
        let diameters: Vec<_> =
            elements.iter().filter(|e| e.class == k).map(|e| 2.0 * e.outline.radius(e.centre)).collect();
        let diameter = diameters.iter().sum::<f64>() / diameters.len().max(1) as f64;
        ClassReport { name: class.name.clone(), elements: diameters.len(), diameter }
    });
    let sources = elements.iter().filter(|e| e.role == Role::Source).count();
    let ball = if D == 3 { 4.0 / 3.0 * std::f64::consts::PI } else { std::f64::consts::PI };
    let spacing = spacing(exemplar);
    let drawn_with = |style: &usize| exemplar.curves.iter().any(|c| c.style == *style);
    Report {
        file: input.name().to_owned(),
        kind,
        elements: elements.len(),
        sources,
        cut_at_frame: elements.len() - sources,
        curves: exemplar.curves.len(),
        areas: exemplar.areas.len(),
        junctions: None,
        styles: (0..exemplar.styles.len()).filter(drawn_with).map(|style| describe_style(exemplar, style)).collect(),
        classes: classes.collect(),
        frame_min: exemplar.window.min.0.to_vec(),
        frame_size: exemplar.window.size().0.to_vec(),
        unit: None,
        unit_per_user: None,
        spacing,
        suggested_radius: spacing * (SUGGESTED_NEIGHBOURS / ball).powf(1.0 / D as f64),
        understood: Vec::new(),
        told: Vec::new(),
        repeat: None,
        layers: Vec::new(),
        warnings: Vec::new(),
        work: 0,
        drawing: None,
    }
}

fn describe_style<const D: usize>(exemplar: &Exemplar<D>, style: usize) -> StyleReport {
    let members: Vec<_> = exemplar.curves.iter().filter(|c| c.style == style).collect();
    let tolerance = 1e-3 * exemplar.window.size().norm();
    let inside = exemplar.window.grown(-tolerance);
    let open = members.iter().filter(|c| !c.path.closed);
    let ends = open.flat_map(|c| [c.path.start(), c.path.end()]).flatten().filter(|p| inside.contains(*p));
    StyleReport {
        name: exemplar.styles[style].name.clone(),
        curves: members.len(),
        closed: members.iter().filter(|c| c.path.closed).count(),
        ends: ends.count(),
        length: members.iter().map(|c| length(&c.path, tolerance)).sum(),
        width: members.first().map_or(0.0, |c| c.width),
    }
}

impl Report {
    /// A picture of what was understood: the exemplar faded, every outline in the colour of its class, every
    /// curve in that of its style, the frame, the centres and ends, and a cell of the repeat.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for points in space, and for formats other than SVG and PNG.
    pub fn picture(&self, format: Format, budget: &Budget) -> Result<Vec<u8>> {
        let unsupported = |what: &str| Error::Unsupported { what: what.into(), advice: "leave the picture out".into() };
        let drawing = self.drawing.as_ref().ok_or_else(|| unsupported("a picture of what lies in space"))?;
        let mut svg = write_survey(drawing);
        if let Some(repeat) = &self.repeat {
            svg = repeat.drawn_over(svg, drawing);
        }
        match format {
            Format::Svg => Ok(svg.into_bytes()),
            Format::Png => {
                let units = drawing.page.view.size().0;
                let job = RenderJob { svg: &svg, units, resolution: Resolution::default(), recipe: Some(NO_RECIPE) };
                write_png(&job, budget)
            }
            _ => Err(unsupported("a picture in this format")),
        }
    }
}
