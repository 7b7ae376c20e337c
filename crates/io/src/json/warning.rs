//! Warnings as JSON has them, in every kind of document.

use arabesque_core::Warning;
use serde::Serialize;

/// A warning.
#[derive(Serialize)]
pub(crate) struct WarningRecord<'a> {
    message: &'a str,
    advice: &'a str,
}

/// All warnings of a result.
pub(crate) fn warning_records(warnings: &[Warning]) -> Vec<WarningRecord<'_>> {
    warnings.iter().map(|w| WarningRecord { message: &w.message, advice: &w.advice }).collect()
}
