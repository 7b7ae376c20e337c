//! Strokes that the border of the domain, or something in the way, cuts off [Tu 2020 §4.3.1].

use arabesque_core::{Border, Bounds, Drawn, Measured, Vector, spans_inside};

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
    if !extent.has_obstacles() && lies_within(&stroke, extent, margin + 0.1 * unit) {
        return vec![stroke];
    }
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

/// Whether a stroke is at least so far inside everywhere, as a ball around its points tells at once.
fn lies_within<const D: usize>(stroke: &Drawn<D>, extent: &Extent<'_, D>, margin: f64) -> bool {
    let points = || stroke.path.cubics.iter().flatten().copied();
    let bounds = Bounds::around(points());
    let middle = bounds.centre();
    let radius = points().map(|p| (p - middle).norm()).fold(0.0, f64::max);
    !stroke.path.cubics.is_empty() && extent.depth(middle) >= margin.max(0.0) + radius
}
