//! Filled paths as polygons.

use arabesque_core::{Budget, FillRule, Outline, Result, Ring, Vector, ring};
use kurbo::{Affine, BezPath, PathEl};

/// Largest deviation of a flattened outline, as a share of the diagonal of its subpath.
pub(crate) const DEVIATION: f64 = 0.002;

/// How much finer the border of a domain is flattened.
const FINE: f64 = 0.04;

/// Smallest deviation that is asked for, in user units: less would only count digits.
pub(crate) const FINEST: f64 = 1e-10;

/// The fill rule of that name.
pub(crate) fn fill_rule(name: &str) -> FillRule {
    if name == "evenodd" { FillRule::EvenOdd } else { FillRule::NonZero }
}

/// The area that a filled path covers.
///
/// # Errors
/// As [`Outline::try_union`].
pub(crate) fn filled(path: &BezPath, world: Affine, rule: FillRule, budget: &Budget) -> Result<Outline<2>> {
    covered(&rings(&(world * path.clone())), rule, budget)
}

/// The union of rings under a rule, with a short cut for one plain ring.
pub(crate) fn covered(rings: &[Ring<2>], rule: FillRule, budget: &Budget) -> Result<Outline<2>> {
    match rings {
        [] => Ok(Outline::default()),
        [ring] if ring::is_convex(ring) => {
            let mut ring = ring.clone();
            if ring::area(&ring) < 0.0 {
                ring.reverse();
            }
            Ok(Outline { rings: vec![ring] })
        }
        _ if rings.iter().any(|ring| is_thin(ring)) => {
            let thick: Vec<_> = rings.iter().filter(|ring| !is_thin(ring)).cloned().collect();
            Outline::try_union(&thick, rule, budget)
        }
        _ => Outline::try_union(rings, rule, budget),
    }
}

/// Whether all points lie on a line except for rounding: such rings enclose nothing, and cost a union dearly.
fn is_thin(ring: &[Vector<2>]) -> bool {
    let n = ring.len().max(1) as f64;
    let mean = ring.iter().fold(Vector::ZERO, |sum, &p| sum + p) * (1.0 / n);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &p in ring {
        let d = p - mean;
        xx += d[0] * d[0];
        xy += d[0] * d[1];
        yy += d[1] * d[1];
    }
    let half = 0.5 * (xx + yy);
    let along = half + (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    // The product of the two principal moments is the determinant; the smaller one itself would be lost in rounding.
    let across = (xx * yy - xy * xy) / along.max(f64::MIN_POSITIVE);
    across <= 1e-14 * along
}

/// The area of a domain, whose border is drawn as it is and must not show its edges.
pub(crate) fn filled_finely(path: &BezPath, rule: FillRule, budget: &Budget) -> Result<Outline<2>> {
    let fine = |elements: &[PathEl]| flattened_to(elements, FINE * DEVIATION);
    let rings: Vec<_> = path.subpaths().map(fine).filter(|ring| ring.len() >= 3).collect();
    covered(&rings, rule, budget)
}

/// The subpaths of a path as polygons, as fine as their size deserves.
pub(crate) fn rings(path: &BezPath) -> Vec<Ring<2>> {
    path.subpaths().map(flattened).filter(|ring| ring.len() >= 3).collect()
}

/// A subpath as polyline; a closing point that repeats the first is dropped.
pub(crate) fn flattened(elements: &[PathEl]) -> Ring<2> {
    flattened_to(elements, DEVIATION)
}

/// The same with another share of the diagonal.
fn flattened_to(elements: &[PathEl], share: f64) -> Ring<2> {
    let mut points: Ring<2> = Vec::new();
    let extent = control_box(elements);
    let tolerance = (share * extent.width().hypot(extent.height())).max(FINEST);
    kurbo::flatten(elements.iter().copied(), tolerance, |element| {
        if let PathEl::MoveTo(p) | PathEl::LineTo(p) = element {
            let p = Vector::xy(p.x, p.y);
            if points.last() != Some(&p) {
                points.push(p);
            }
        }
    });
    while points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    points
}

/// Box around the control points.
pub(crate) fn control_box(elements: &[PathEl]) -> kurbo::Rect {
    let mut extent: Option<kurbo::Rect> = None;
    let mut add = |p: kurbo::Point| {
        let at = kurbo::Rect::from_points(p, p);
        extent = Some(extent.map_or(at, |e| e.union(at)));
    };
    for element in elements {
        match *element {
            PathEl::MoveTo(p) | PathEl::LineTo(p) => add(p),
            PathEl::QuadTo(a, p) => [a, p].into_iter().for_each(&mut add),
            PathEl::CurveTo(a, b, p) => [a, b, p].into_iter().for_each(&mut add),
            PathEl::ClosePath => {}
        }
    }
    extent.unwrap_or_default()
}
