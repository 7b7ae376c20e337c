//! What was understood of an exemplar.

use arabesque_core::{Error, Exemplar, Limits, Result, Role, Warning};
use arabesque_io::{
    png::{Plate, Resolution, write_png},
    svg::{Drawing, write_survey},
};
use serde::Serialize;

use crate::{Format, Input, Subject, recipe::Method, size::unit_name, subject::dots};

/// What was understood of an exemplar.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name of the file.
    pub file: String,
    /// `drawing`, `points` or `points in space`.
    pub kind: &'static str,
    /// Number of elements, context included.
    pub elements: usize,
    /// How many of them may be copied.
    pub sources: usize,
    /// How many are cut at the frame and serve as context only.
    pub cut_at_frame: usize,
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
    /// Mean distance of elements, in user units.
    pub spacing: f64,
    /// Neighbourhood radius that a run would use by default on its finest level, in user units.
    pub suggested_radius: f64,
    /// Layers that make the file a whole job.
    pub layers: Vec<&'static str>,
    /// What was noticed while reading.
    pub warnings: Vec<WarningReport>,
    /// The picture of what was understood.
    #[serde(skip)]
    drawing: Option<Drawing>,
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

/// A warning.
#[derive(Clone, Debug, Serialize)]
pub struct WarningReport {
    /// What was noticed.
    pub message: String,
    /// What to do about it.
    pub advice: String,
}

impl From<&Warning> for WarningReport {
    fn from(w: &Warning) -> Self {
        Self { message: w.message.clone(), advice: w.advice.clone() }
    }
}

/// Neighbours that a neighbourhood of the suggested radius holds on average.
const SUGGESTED_NEIGHBOURS: f64 = 12.0;

/// Reads an exemplar and says what was understood.
///
/// # Errors
/// As [`Subject::read`] and [`Input::read`].
pub fn inspect(input: &Input, method: Method) -> Result<Report> {
    let limits = Limits::default();
    let bytes = input.read(None, &limits)?;
    Ok(match Subject::read(input, &bytes, method, &limits)? {
        Subject::Drawing(drawing) => {
            let mut report = describe(input, "drawing", &drawing.exemplar);
            report.unit = Some(unit_name(drawing.page.unit));
            report.unit_per_user = Some(drawing.page.unit_per_user);
            report.layers = layers(&drawing);
            report.warnings = drawing.warnings.iter().map(WarningReport::from).collect();
            report.drawing = Some(*drawing);
            report
        }
        Subject::Points(exemplar) => {
            let drawing = dots(&exemplar);
            Report { drawing: Some(drawing), ..describe(input, "points", &exemplar) }
        }
        Subject::Space(exemplar) => describe(input, "points in space", &exemplar),
    })
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
    let spacing = exemplar.spacing();
    Report {
        file: input.name().to_owned(),
        kind,
        elements: elements.len(),
        sources,
        cut_at_frame: elements.len() - sources,
        classes: classes.collect(),
        frame_min: exemplar.window.min.0.to_vec(),
        frame_size: exemplar.window.size().0.to_vec(),
        unit: None,
        unit_per_user: None,
        spacing,
        suggested_radius: spacing * (SUGGESTED_NEIGHBOURS / ball).powf(1.0 / D as f64),
        layers: Vec::new(),
        warnings: Vec::new(),
        drawing: None,
    }
}

impl Report {
    /// A picture of what was understood: the exemplar faded, every outline in the colour of its class, the frame, the centres.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for points in space, and for formats other than SVG and PNG.
    pub fn picture(&self, format: Format) -> Result<Vec<u8>> {
        let unsupported =
            |what: &str| Error::Unsupported { what: what.into(), advice: "leave the picture away".into() };
        let drawing = self.drawing.as_ref().ok_or_else(|| unsupported("a picture of points in space"))?;
        let svg = write_survey(drawing);
        match format {
            Format::Svg => Ok(svg.into_bytes()),
            Format::Png => {
                let units = drawing.page.view.size().0;
                let plate = Plate { svg: &svg, units, resolution: Resolution::default(), recipe: None };
                write_png(&plate, &Limits::default())
            }
            Format::Json | Format::Csv | Format::Toml => Err(unsupported("a picture in this format")),
        }
    }
}
