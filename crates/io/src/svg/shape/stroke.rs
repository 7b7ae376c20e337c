//! Strokes as areas: widths, caps, joins, dashes.

use arabesque_core::{Budget, FillRule, Outline, Result};
use kurbo::{Affine, BezPath, Cap, Join, PathEl, Shape as _, Stroke, StrokeOpts};

use crate::svg::{
    parse::{
        scene::Node,
        style::{ComputedStyle, Property as P},
    },
    shape::flatten::{DEVIATION, FINEST, control_box, covered, rings},
};

/// Longest spike of a join, in stroke widths.
const MAX_MITER: f64 = 100.0;

/// Dashes of one stroke beyond which it is taken as unbroken.
const DASHES: f64 = 20_000.0;

/// Mean factor by which a transform enlarges lengths.
pub(crate) fn growth(transform: Affine) -> f64 {
    transform.determinant().abs().sqrt()
}

/// The area that the stroke of a shape covers.
///
/// # Errors
/// As [`Outline::try_union`].
pub(crate) fn stroked(node: &Node, path: &BezPath, world: Affine, budget: &Budget) -> Result<Outline<2>> {
    let style = &node.style;
    let width = style.number(P::StrokeWidth);
    let scale = growth(world);
    // A stroke that does not scale has its width in user units of the root.
    let fixed = node.own.get("vector-effect") == Some("non-scaling-stroke") && scale > 0.0;
    let (path, world) = if fixed { (world * path.clone(), Affine::IDENTITY) } else { (path.clone(), world) };
    let extent = path.control_box();
    let tolerance = (DEVIATION * (extent.width().hypot(extent.height()) + width)).min(0.1 * width).max(FINEST);
    let pen = pen(style, width, &path);
    let mut outline = BezPath::new();
    for elements in path.subpaths() {
        match dot(elements, &pen) {
            Some(dot) => outline.extend(dot),
            None => outline.extend(kurbo::stroke(elements.iter().copied(), &pen, &StrokeOpts::default(), tolerance)),
        }
    }
    if !outline.is_finite() {
        return Ok(Outline::default());
    }
    let rings = rings(&(world * outline));
    covered(&rings, FillRule::NonZero, budget)
}

fn pen(style: &ComputedStyle, width: f64, path: &BezPath) -> Stroke {
    let cap = match style.get(P::StrokeLinecap) {
        "round" => Cap::Round,
        "square" => Cap::Square,
        _ => Cap::Butt,
    };
    let join = match style.get(P::StrokeLinejoin) {
        "round" => Join::Round,
        "bevel" => Join::Bevel,
        _ => Join::Miter,
    };
    let pen = Stroke::new(width)
        .with_caps(cap)
        .with_join(join)
        .with_miter_limit(style.number(P::StrokeMiterlimit).min(MAX_MITER));
    let dashes: Vec<f64> = style.get(P::StrokeDasharray).split(' ').filter_map(|n| n.parse().ok()).collect();
    let period: f64 = dashes.iter().sum();
    if dashes.is_empty() || period <= 0.0 || rough_length(path) / period * dashes.len() as f64 > DASHES {
        return pen;
    }
    // A dash of no length still shows its caps.
    let dashes = dashes.into_iter().map(|d| if d == 0.0 { 1e-3 * width } else { d });
    let dashes: Vec<f64> = dashes.collect();
    let doubled = if dashes.len() % 2 == 1 { [dashes.clone(), dashes].concat() } else { dashes };
    pen.with_dashes(style.number(P::StrokeDashoffset), doubled)
}

/// Length of the control polygon: no less than the length of the path.
fn rough_length(path: &BezPath) -> f64 {
    let ends = |s: kurbo::PathSeg| s.to_cubic();
    path.segments().map(ends).map(|c| (c.p1 - c.p0).hypot() + (c.p2 - c.p1).hypot() + (c.p3 - c.p2).hypot()).sum()
}

/// What a subpath of no length shows: a dot with round caps, a square with square ones, nothing with butt ones.
fn dot(elements: &[PathEl], pen: &Stroke) -> Option<BezPath> {
    let extent = control_box(elements);
    if elements.len() < 2 || extent.width() > 0.0 || extent.height() > 0.0 {
        return None;
    }
    let (centre, half) = (extent.origin(), 0.5 * pen.width);
    Some(match pen.start_cap {
        Cap::Round => kurbo::Circle::new(centre, half).to_path(0.01 * half),
        Cap::Square => kurbo::Rect::from_center_size(centre, (pen.width, pen.width)).to_path(0.1),
        Cap::Butt => BezPath::new(),
    })
}
