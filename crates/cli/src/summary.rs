//! The machine-readable summary of `--json`.

use std::{collections::BTreeMap, io::Write};

use arabesque::Warning;
use serde::Serialize;

use crate::failure::Failure;

/// What a command made.
#[derive(Debug, Serialize)]
pub(crate) struct Summary {
    pub(crate) version: &'static str,
    pub(crate) outputs: Vec<Output>,
}

/// One file that was written.
#[derive(Debug, Serialize)]
pub(crate) struct Output {
    pub(crate) path: String,
    pub(crate) format: &'static str,
    pub(crate) seed: u64,
    pub(crate) elements: usize,
    pub(crate) classes: BTreeMap<String, usize>,
    pub(crate) curves: usize,
    pub(crate) styles: BTreeMap<String, usize>,
    /// Of a ribbon alone.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub(crate) ribbons: Option<Ribbons>,
    pub(crate) energy: Option<f64>,
    /// `finished`, `interrupted` or `time limit`.
    pub(crate) stopped: &'static str,
    pub(crate) seconds: f64,
    pub(crate) warnings: Vec<Message>,
}

/// What ribbons are made of.
#[derive(Debug, Serialize)]
pub(crate) struct Ribbons {
    pub(crate) ribbons: usize,
    pub(crate) pieces: usize,
    /// In 8-bit colour steps.
    pub(crate) cost: f64,
}

/// A warning.
#[derive(Debug, Serialize)]
pub(crate) struct Message {
    message: String,
    advice: String,
}

impl From<&Warning> for Message {
    fn from(w: &Warning) -> Self {
        Self { message: w.message.clone(), advice: w.advice.clone() }
    }
}

/// Writes `value` to standard output as JSON.
pub(crate) fn print(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(std::io::Error::from)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}")?;
    out.flush()?;
    Ok(())
}

/// Tells a machine about a failure, where it asked for JSON.
pub(crate) fn print_failure(failure: &Failure) {
    let value = serde_json::json!({ "error": { "code": failure.code(), "message": failure.message() } });
    // The failure itself is reported in any case.
    let _ = print(&value);
}
