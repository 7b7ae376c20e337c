//! A report as a picture: the result in pale, with its worst places marked and numbered.

use arabesque_core::{Error, Outline, Result, Vector};
use arabesque_io::svg::{MarkedPlace, MarkedSheet, PanelLine, write_marked};
use arabesque_measure::{Family, Fault, Mark, Verdict};

use super::{
    report::MeasureReport,
    text::{range, short},
};

/// Places of one fault that are marked.
const MOST: usize = 6;

/// Colours of faults, told apart by people with any colour vision.
fn colour(fault: Fault) -> &'static str {
    match fault {
        Fault::Hole => "#d55e00",
        Fault::Clump => "#0072b2",
        Fault::Overlap => "#b0307a",
        Fault::Broken => "#000000",
        Fault::Turned => "#a07000",
        Fault::LooseEnd => "#007a5a",
        Fault::Copy => "#4a90c8",
    }
}

fn colour_of(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "#2a9d5c",
        Verdict::Watch => "#e69f00",
        Verdict::Bad => "#c8281e",
    }
}

impl MeasureReport {
    /// The result in pale, the worst holes, clumps, overlaps, copies and strange elements marked and numbered, with a legend.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for what lies in space.
    pub fn picture(&self) -> Result<Vec<u8>> {
        let drawing = self.drawing.as_ref().ok_or_else(|| Error::Unsupported {
            what: "a picture of what lies in space".into(),
            advice: "leave the picture out".into(),
        })?;
        let marks = self.marks();
        let places: Vec<MarkedPlace> = marks.iter().enumerate().map(|(k, mark)| place(mark, k + 1)).collect();
        let mut lines = self.verdicts();
        if !marks.is_empty() {
            lines.push(PanelLine { dot: None, text: "Worst places".into(), is_heading: true });
        }
        for (k, mark) in marks.iter().enumerate() {
            let dot = Some((colour(mark.fault), Some(k + 1)));
            lines.push(PanelLine { dot, text: format!("{}: {}", mark.fault.name(), mark.says), is_heading: false });
        }
        // Large copies lie below what is marked in them.
        let mut below: Vec<MarkedPlace> = places;
        below.sort_by(|a, b| b.radius.total_cmp(&a.radius).then(a.number.cmp(&b.number)));
        Ok(write_marked(&MarkedSheet { drawing, places: &below, lines: &lines }).into_bytes())
    }

    /// The marks that are drawn: some of each fault, the worst first; none of a family that is good, where single ones are natural.
    fn marks(&self) -> Vec<&Mark> {
        let mut kept: Vec<&Mark> = Vec::new();
        let is_good =
            |family: Family| self.report.families.iter().any(|f| f.family == family && f.verdict == Verdict::Good);
        for mark in self.report.marks.iter().filter(|mark| !is_good(mark.fault.family())) {
            if kept.iter().filter(|k| k.fault == mark.fault).count() < MOST {
                kept.push(mark);
            }
        }
        kept
    }

    /// Families with their verdicts, and the measures that are not good.
    fn verdicts(&self) -> Vec<PanelLine> {
        let line = |text: String| PanelLine { dot: None, text, is_heading: false };
        let mut lines = vec![PanelLine { text: self.heading(), is_heading: true, ..line(String::new()) }];
        for family in &self.report.families {
            let text = format!("{}: {}", family.family.name(), family.verdict.name());
            lines.push(PanelLine { dot: Some((colour_of(family.verdict), None)), text, is_heading: true });
            let members = self.report.measures.iter().filter(|m| m.family == family.family);
            for m in members.filter(|m| m.verdict != Verdict::Good) {
                let about = m.about.as_ref().map(|about| format!(" ({about})")).unwrap_or_default();
                let (value, natural) = (short(m.result), range(m));
                lines.push(line(format!("{}{about}: {value} {}, natural {natural}. {}", m.name, m.unit, m.means)));
            }
        }
        lines
    }
}

fn place(mark: &Mark, number: usize) -> MarkedPlace {
    let at = |k: usize| mark.at.get(k).copied().unwrap_or(0.0);
    let rings = mark.outline.iter().map(|ring| ring.iter().map(|&[x, y]| Vector::xy(x, y)).collect()).collect();
    MarkedPlace {
        at: Vector::xy(at(0), at(1)),
        radius: mark.radius,
        outline: Outline { rings },
        colour: colour(mark.fault),
        number,
        title: format!("{}: {}", mark.fault.name(), mark.says),
    }
}
