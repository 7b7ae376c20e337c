//! The parts of a path inside something.

use crate::{curve::Measured, space::Vector};

/// Halvings with which a border is located on a path.
const HALVINGS: usize = 40;

/// Most places at which one path is looked at.
const MAX_STEPS: f64 = 100_000.0;

/// Arc lengths between which a path is inside what `holds` says; on a closed path the last stretch may end beyond its length.
/// The path is looked at in steps of about `step`: what is narrower may be overlooked. Works for any set of points in any dimension.
pub fn spans_inside<const D: usize>(
    measured: &Measured<D>,
    step: f64,
    holds: &dyn Fn(Vector<D>) -> bool,
) -> Vec<(f64, f64)> {
    let length = measured.length();
    let count = (length / step).ceil().clamp(1.0, MAX_STEPS) as usize;
    let arc = |k: usize| length * k as f64 / count as f64;
    let border = |k: usize, enters: bool| {
        let (mut a, mut b) = (arc(k - 1), arc(k));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            if holds(measured.point(middle)) == enters { b = middle } else { a = middle }
        }
        if enters { b } else { a }
    };
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut open = holds(measured.point(0.0)).then_some(0.0);
    for k in 1..=count {
        // The ends of a closed path are one point, whatever rounding makes of them.
        let at = if k == count && measured.is_closed() { 0.0 } else { arc(k) };
        match (open, holds(measured.point(at))) {
            (None, true) => open = Some(border(k, true)),
            (Some(a), false) => {
                spans.push((a, border(k, false)));
                open = None;
            }
            _ => {}
        }
    }
    spans.extend(open.map(|a| (a, length)));
    if measured.is_closed() && spans.len() > 1 && spans[0].0 <= 0.0 && spans.last().is_some_and(|s| s.1 >= length) {
        let first = spans.remove(0);
        if let Some(last) = spans.last_mut() {
            last.1 = length + first.1;
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Path;

    fn ring() -> Measured<2> {
        let corners: Vec<_> = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)]
            .iter()
            .map(|&(x, y)| Vector::xy(x, y))
            .collect();
        Measured::new(Path { closed: true, ..Path::polyline(&corners) }, 1e-3)
    }

    #[test]
    fn a_ring_cut_by_a_line_is_one_stretch_around_its_start() {
        let spans = spans_inside(&ring(), 0.1, &|p| p[0] < 1.0);
        assert_eq!(spans.len(), 1);
        assert!((spans[0].0 - 11.0).abs() < 1e-6 && (spans[0].1 - 17.0).abs() < 1e-6, "{spans:?}");
    }

    #[test]
    fn a_ring_in_two_bands_is_two_stretches() {
        let spans = spans_inside(&ring(), 0.1, &|p| p[0] > 3.0 || (p[0] > 1.0 && p[0] < 2.0));
        assert_eq!(spans.len(), 3, "{spans:?}");
    }
}
