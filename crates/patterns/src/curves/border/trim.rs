//! Strokes that the border of the domain, or something in the way, cuts off [Tu 2020 §4.3.1].

use arabesque_core::{Border, Drawn, Measured, Vector, spans_inside};

use crate::border::Extent;

/// Scraps that the border leaves of a stroke are dropped when they are shorter than this many widths.
const SCRAP: f64 = 0.5;

/// Cuts a stroke where the border of the domain or something in the way asks for it. `width`: that of the stroke,
/// `unit`: its scale in the output, by which it is flattened.
pub(crate) fn at_border<const D: usize>(
    stroke: Drawn<D>,
    extent: &Extent<'_, D>,
    width: f64,
    unit: f64,
) -> Vec<Drawn<D>> {
    if stroke.frozen.is_some() || (extent.is_endless() && !extent.has_obstacles()) {
        return vec![stroke];
    }
    let margin = match extent.rule() {
        Border::Clip => 0.0,
        Border::Inside | Border::Turn => 0.5 * width * stroke.scale,
        Border::Cross => f64::NEG_INFINITY,
    };
    let holds = |p: Vector<D>| extent.depth(p) >= margin && !extent.is_blocked(p, 0.5 * width * stroke.scale);
    let measured = Measured::new(stroke.path.clone(), 0.02 * unit);
    let spans = spans_inside(&measured, 0.1 * unit, &holds);
    if matches!(spans.as_slice(), [(a, b)] if *a <= 0.0 && *b >= measured.length()) {
        return vec![stroke];
    }
    let part = |(a, b): (f64, f64)| Drawn { path: measured.part(a, b), ..stroke.clone() };
    // What the border leaves of a stroke is more than a dot.
    let least = (SCRAP * width * stroke.scale).max(1e-3 * unit);
    spans.into_iter().filter(|(a, b)| b - a > least).map(part).filter(|d| !d.path.is_empty()).collect()
}
