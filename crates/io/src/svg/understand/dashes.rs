//! The dashes of a stroke as strokes of their own: each lies where the pattern has it, however long the stroke is.

use arabesque_core::{Measured, Path, Result};

use crate::svg::{
    drawing::Stroke,
    parse::{guard::over, source::Source},
};

/// Dashes of no length are drawn this long, in widths: their caps are all that is seen of them.
const DOT: f64 = 1e-3;

/// A line is flattened to this share of a period to measure its length.
const FLAT: f64 = 1e-3;

/// Work for each dash, and for each point of a line.
const WORK: (u64, u64) = (300, 20);

/// Where a stroke is drawn and where not, in turn.
#[derive(Clone, Debug)]
pub(crate) struct DashPattern {
    /// Lengths of dashes and gaps; an even number of them.
    lengths: Vec<f64>,
    /// Where in them a line begins.
    offset: f64,
    width: f64,
}

impl DashPattern {
    /// That of a stroke, which is without it then.
    pub(crate) fn taken_from(stroke: &mut Stroke) -> Self {
        let mut lengths = std::mem::take(&mut stroke.dashes);
        if lengths.len() % 2 == 1 {
            lengths.extend_from_within(..);
        }
        Self { lengths, offset: std::mem::take(&mut stroke.dash_offset), width: stroke.width }
    }

    /// The dashes along a line.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] for too many.
    pub(crate) fn dashes(&self, line: &Path<2>, source: &Source<'_>) -> Result<Vec<Path<2>>> {
        let period: f64 = self.lengths.iter().sum();
        if !(period.is_finite() && period > source.limits.extent) {
            return Ok(vec![line.clone()]);
        }
        let measured = Measured::new(line.clone(), FLAT * period);
        let length = measured.length();
        let count = (length / period + 1.0) * 0.5 * self.lengths.len() as f64;
        if count > source.limits.elements as f64 {
            let what = format!("{}: dashes of a stroke", source.name);
            return Err(over(what, format!("{count:.0}"), ("elements", source.limits.elements)));
        }
        source.budget.spend(WORK.0 * count as u64 + WORK.1 * measured.points().len() as u64)?;
        let mut dashes = Vec::new();
        let mut at = -self.offset.rem_euclid(period);
        while at < length {
            for pair in self.lengths.chunks_exact(2) {
                let end = at + pair[0].max(DOT * self.width);
                let (from, to) = (at.max(0.0), end.min(length));
                let path = if to > from { measured.part(from, to) } else { Path { cubics: Vec::new(), closed: false } };
                if !path.is_empty() {
                    dashes.push(Path { closed: false, ..path });
                }
                at += pair[0] + pair[1];
            }
        }
        Ok(dashes)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use crate::svg::{Dashes, LargeFills, ReadOptions, read_exemplar};

    fn read(attributes: &str, dashes: Dashes) -> Vec<(f64, f64)> {
        let lines: String = (1..5).map(|k| format!("<path d='M-10 {}H110' {attributes}/>", 20 * k)).collect();
        let text =
            format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 100'><g stroke='#000'>{lines}</g></svg>");
        let options = ReadOptions { dashes, large_fills: LargeFills::Areas, ..ReadOptions::new("d.svg") };
        let exemplar = read_exemplar(&text, &options).unwrap().exemplar;
        let rounded = |x: f64| (x * 1e4).round() / 1e4;
        let ends = exemplar.curves.iter().map(|c| [c.path.start().unwrap()[0], c.path.end().unwrap()[0]].map(rounded));
        ends.map(|[a, b]| (a, b)).collect()
    }

    #[test]
    fn dashes_apart_lie_where_the_stroke_has_them() {
        assert_eq!(read("stroke-dasharray='8 6'", Dashes::OfStroke)[0], (-10.0, 110.0));
        let apart = read("stroke-dasharray='8 6'", Dashes::Apart);
        // The first of them ends at -2, beside the frame.
        assert_eq!(apart[..2], [(4.0, 12.0), (18.0, 26.0)]);
        let shifted = read("stroke-dasharray='8 6' stroke-dashoffset='3'", Dashes::Apart);
        assert_eq!(shifted[..2], [(1.0, 9.0), (15.0, 23.0)]);
    }
}
