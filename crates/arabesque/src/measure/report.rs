//! What is asked of a measurement, and what is told.

use arabesque_io::svg::Drawing;
use schemars::JsonSchema;
use serde::Serialize;

use crate::recipe::{Input, Reading};

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
    /// Millions of units of work that reading and measuring took.
    pub work: u64,
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
    pub(super) drawing: Option<Box<Drawing>>,
}

impl Measurements {
    /// The JSON schema of what `measure --json` writes.
    pub fn schema() -> String {
        serde_json::to_string_pretty(&schemars::schema_for!(Self)).unwrap_or_default() + "\n"
    }
}
