//! A report as lines of text.

use arabesque_core::rounded;
use arabesque_measure::{Measure, Verdict};

use super::report::MeasureReport;

impl MeasureReport {
    /// What it is in one line.
    pub fn heading(&self) -> String {
        let report = &self.report;
        let count = |[own, found]: [usize; 2], what: &str| format!("{found} {what} (exemplar: {own})");
        let mut parts = Vec::new();
        if report.elements.iter().any(|n| *n > 0) {
            parts.push(count(report.elements, "elements"));
        }
        if report.strokes.iter().any(|n| *n > 0) {
            parts.push(count(report.strokes, "strokes"));
        }
        let verdict = report.verdict.name();
        format!("{}: {verdict}, fault {:.2}; {}", self.file, report.fault, parts.join(", "))
    }

    /// The table: a line for each family and each measure, with its meaning below where it is not good, or `with_all` of them.
    pub fn lines(&self, with_all: bool) -> Vec<String> {
        let mut lines = vec![format!("{}; spacing {}", self.heading(), rounded(self.report.spacing))];
        for family in &self.report.families {
            lines.push(format!("  {:9} {:5} {:.2}", family.family.name(), family.verdict.name(), family.fault));
            for measure in self.report.measures.iter().filter(|m| m.family == family.family) {
                lines.push(format!("    {:5} {}", measure.verdict.name(), told(measure)));
                if with_all || measure.verdict != Verdict::Good {
                    lines.push(format!("          {}", measure.means));
                }
            }
        }
        lines.extend(self.report.notes.iter().map(|note| format!("  not measured: {note}")));
        lines
    }
}

/// A measure in one line.
pub(super) fn told(measure: &Measure) -> String {
    let about = measure.about.as_ref().map(|about| format!(" ({about})")).unwrap_or_default();
    let name = format!("{}{about}", measure.name);
    format!(
        "{name:34} {:>7} {}; exemplar {}, natural {}",
        short(measure.result),
        measure.unit,
        short(measure.exemplar),
        range(measure)
    )
}

/// The natural range in words.
pub(super) fn range(measure: &Measure) -> String {
    // No count, length or share is below nothing.
    let low = measure.low.filter(|low| *low > 0.0).map(short);
    match (low, measure.high.map(short)) {
        (Some(low), Some(high)) => format!("{low} to {high}"),
        (Some(low), None) => format!("from {low}"),
        (None, Some(high)) => format!("up to {high}"),
        (None, None) => "any".to_owned(),
    }
}

/// A figure with two or three digits that matter.
pub(super) fn short(value: f64) -> String {
    let digits = match value.abs() {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        v if v >= 0.0995 || v == 0.0 => 2,
        _ => 3,
    };
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short() {
        assert_eq!([0.0, 0.0123, 0.5, 12.345, 123.4].map(short), ["0.00", "0.012", "0.50", "12.3", "123"]);
    }
}
