//! Filled bands that run through the frame, as strokes: stripes, chevrons, the bands of a plaid.
//!
//! The two sides of a band are parallel, piece by piece, at one distance; its ends lie on the frame or beyond it. The
//! line runs exactly through the middle, and its corners are where those of both sides meet. Bands of one width and
//! paint that run from one side of the frame to another make a family, which shorter ones belong to that only cut off a
//! corner. A tile of a checkerboard has its ends inside, and is none.

use std::rc::Rc;

use arabesque_core::{Bounds, FillRule, Path, Result, Ring, Vector, ring, segment};
use kurbo::{BezPath, PathEl};

use crate::svg::{
    centreline::Centrelines,
    parse::{geometry::Painted, scene::Content, source::Source, style::Property as P},
    reason::Reason,
    shape::extent::{longer, sole_shape},
    understand::item::{Item, Kind, Origin},
};

/// How near to the frame an end may be, as a share of the frame.
const NEAR: f64 = 1e-3;
/// Most corners of a band.
const CORNERS: usize = 600;
/// Largest angle between its sides, as a sine.
const SKEW: f64 = 0.01;
/// Largest difference of widths.
const UNEVEN: f64 = 0.02;
/// Widest band, as a share of the shorter side of the frame.
const WIDEST: f64 = 0.45;
/// Shortest band that makes a family: in widths, and as a share of the shorter side of the frame.
const LENGTH: f64 = 2.0;
const THROUGH: f64 = 0.5;
/// Work for each pair of corners.
const CORNER: u64 = 20;

/// The middle of a band.
struct Band {
    points: Vec<Vector<2>>,
    width: f64,
}

/// Makes strokes of the bands among `items`.
///
/// # Errors
/// As [`arabesque_core::Budget::spend`].
pub(crate) fn follow_bands(source: &Source<'_>, items: &mut [Item], frame: &Bounds<2>) -> Result<()> {
    let mut found: Vec<(usize, Band, String)> = Vec::new();
    for (i, item) in items.iter().enumerate().filter(|(_, item)| may_be_band(item)) {
        let Some(corners) = corners(item) else { continue };
        source.budget.spend(CORNER * (corners.len() * corners.len()) as u64)?;
        if let Some(band) = band(&corners, frame) {
            found.push((i, band, item.painted.colours_key()));
        }
    }
    let shorter = frame.size()[0].min(frame.size()[1]);
    let inside = |band: &Band| -> f64 { band.points.windows(2).map(|w| length_in((w[0], w[1]), frame)).sum() };
    let founds_family =
        |band: &Band| inside(band) >= (LENGTH * band.width).max(THROUGH * shorter) && band.width <= WIDEST * shorter;
    let families: Vec<(f64, Vector<2>, String)> = found
        .iter()
        .filter(|(_, band, _)| founds_family(band))
        .map(|(_, band, paint)| (band.width, direction(band), paint.clone()))
        .collect();
    source.budget.spend(CORNER * (families.len() * found.len()) as u64)?;
    for (i, band, paint) in found {
        let way = direction(&band);
        let is_of = |(width, other, colours): &(f64, Vector<2>, String)| {
            colours == &paint && (width - band.width).abs() <= UNEVEN * width && way.cross(*other).abs() <= SKEW
        };
        if founds_family(&band) || families.iter().any(is_of) {
            let lines = Centrelines { paths: vec![Path::polyline(&band.points)], width: band.width, spread: 0.0 };
            let item = &mut items[i];
            item.lines = Some(Rc::new(lines));
            (item.kind, item.reason) = (Kind::Curve, Reason::Band);
        }
    }
    Ok(())
}

/// The direction of the first stretch of a band, whichever way it is drawn.
fn direction(band: &Band) -> Vector<2> {
    match band.points.as_slice() {
        [a, b, ..] => (*b - *a).unit(),
        _ => Vector::ZERO,
    }
}

/// Whether an item is one filled shape in a plain colour that nothing is decided about.
fn may_be_band(item: &Item) -> bool {
    let is_free =
        matches!(item.kind, Kind::Element | Kind::Large) && matches!(item.origin, Origin::Fill | Origin::Piece);
    let [(_, node)] = item.parts.as_slice() else { return false };
    let Some(only) = sole_shape(node, kurbo::Affine::IDENTITY) else { return false };
    let style = &only.leaf.style;
    is_free && item.lines.is_none() && !item.is_cut && !style.strokes() && !style.get(P::Fill).starts_with("url(")
}

/// The corners of the only ring of an item, as exactly as the file has them.
fn corners(item: &Item) -> Option<Ring<2>> {
    let (parent, node) = item.parts.first()?;
    let only = sole_shape(node, *parent)?;
    let Content::Shape(geometry) = &only.leaf.content else { return None };
    if geometry.paint != Painted::Style || item.outline.rings.len() != 1 {
        return None;
    }
    let path: BezPath = (only.parent * only.leaf.transform) * geometry.path.clone();
    if path.subpaths().count() != 1 || path.elements().len() > CORNERS + 2 {
        return None;
    }
    let at = |p: kurbo::Point| Vector::xy(p.x, p.y);
    let mut ring: Ring<2> = Vec::new();
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(p) | PathEl::LineTo(p) => ring.push(at(p)),
            PathEl::ClosePath => {}
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => return None,
        }
    }
    let size = Bounds::around(ring.iter().copied()).size().norm();
    let ring = straightened(ring, 1e-6 * size);
    let covered = arabesque_core::Outline::union(std::slice::from_ref(&ring), FillRule::NonZero).area();
    ((4..=CORNERS).contains(&ring.len()) && (ring::area(&ring).abs() - covered).abs() <= 1e-3 * covered).then_some(ring)
}

/// A ring without points on the line between their neighbours.
fn straightened(ring: Ring<2>, off: f64) -> Ring<2> {
    let mut out: Ring<2> = Vec::new();
    for p in ring {
        while let [.., a, b] = out.as_slice() {
            if segment::distance((*a, p), *b) > off {
                break;
            }
            out.pop();
        }
        if out.last().is_none_or(|&last| (last - p).norm() > off) {
            out.push(p);
        }
    }
    let mut at = 0;
    while out.len() > 3 && at < 2 {
        let n = out.len();
        let is_double = (out[0] - out[n - 1]).norm() <= off;
        if is_double || segment::distance((out[n - 2], out[0]), out[n - 1]) <= off {
            out.pop();
        } else if segment::distance((out[n - 1], out[1]), out[0]) <= off {
            out.remove(0);
        } else {
            at = 2;
        }
    }
    out
}

/// The band whose border is a ring: the longest, where its ends could be found in several ways.
fn band(ring: &[Vector<2>], frame: &Bounds<2>) -> Option<Band> {
    let n = ring.len();
    if !n.is_multiple_of(2) {
        return None;
    }
    let half = n / 2;
    let length = |band: &Band| band.points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    let bands = (0..half).filter_map(|k| {
        let ends = [(ring[k], ring[(k + 1) % n]), (ring[(k + half) % n], ring[(k + half + 1) % n])];
        if !ends.iter().all(|&end| is_outside(end, frame)) {
            return None;
        }
        // From one end to the other, on both sides.
        let left: Vec<_> = (0..half).map(|i| ring[(k + 1 + i) % n]).collect();
        let right: Vec<_> = (0..half).map(|i| ring[(k + n - i) % n]).collect();
        middle(&left, &right, frame)
    });
    bands.max_by(|a, b| length(a).total_cmp(&length(b)))
}

/// Whether an end of a band lies on one side of the frame or beyond it.
fn is_outside((a, b): (Vector<2>, Vector<2>), frame: &Bounds<2>) -> bool {
    let near = NEAR * longer(frame);
    (0..2).any(|k| a[k].max(b[k]) <= frame.min[k] + near || a[k].min(b[k]) >= frame.max[k] - near)
}

/// The line in the middle of two sides that run along one another at one distance.
fn middle(left: &[Vector<2>], right: &[Vector<2>], frame: &Bounds<2>) -> Option<Band> {
    let mut widths = Vec::new();
    for (l, r) in left.windows(2).zip(right.windows(2)) {
        let (way, other) = ((l[1] - l[0]).unit(), (r[1] - r[0]).unit());
        if way.cross(other).abs() > SKEW || way.dot(other) <= 0.0 {
            return None;
        }
        widths.push(way.cross(r[0] - l[0]).abs());
    }
    let (least, most) =
        (widths.iter().copied().fold(f64::INFINITY, f64::min), widths.iter().copied().fold(0.0, f64::max));
    if !(least > 0.0 && most.is_finite() && most - least <= UNEVEN * most) {
        return None;
    }
    let mut points: Vec<Vector<2>> = left.iter().zip(right).map(|(&l, &r)| (l + r) * 0.5).collect();
    let n = points.len();
    if n < 2 {
        return None;
    }
    // A slanted end reaches farther on one side: the line covers both.
    for (end, next, sides) in [(0, 1, [left[0], right[0]]), (n - 1, n - 2, [left[n - 1], right[n - 1]])] {
        let way = (points[end] - points[next]).unit();
        let reach = sides.iter().map(|&side| way.dot(side - points[end])).fold(0.0, f64::max);
        points[end] += way * if reach > 1e-9 * longer(frame) { reach } else { 0.0 };
    }
    Some(Band { points, width: 0.5 * (least + most) })
}

/// Length of the part of a line that lies in the frame.
pub(crate) fn length_in((a, b): (Vector<2>, Vector<2>), frame: &Bounds<2>) -> f64 {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let way = b[k] - a[k];
        if way == 0.0 {
            if a[k] < frame.min[k] || a[k] > frame.max[k] {
                return 0.0;
            }
            continue;
        }
        let cuts = [(frame.min[k] - a[k]) / way, (frame.max[k] - a[k]) / way];
        from = from.max(cuts[0].min(cuts[1]));
        to = to.min(cuts[0].max(cuts[1]));
    }
    (to - from).max(0.0) * (b - a).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(100.0, 80.0))
    }

    fn of(corners: &[(f64, f64)]) -> Option<Band> {
        band(&corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect::<Vec<_>>(), &frame())
    }

    #[test]
    fn a_stripe_has_its_line_exactly_in_the_middle() {
        let band = of(&[(10.0, -5.0), (16.0, -5.0), (16.0, 85.0), (10.0, 85.0)]).unwrap();
        assert_eq!(band.width, 6.0);
        assert_eq!(band.points, [Vector::xy(13.0, -5.0), Vector::xy(13.0, 85.0)]);
        assert_eq!(
            of(&[(10.0, 0.0), (16.0, 0.0), (16.0, 80.0), (10.0, 80.0)]).unwrap().points[1],
            Vector::xy(13.0, 80.0)
        );
    }

    #[test]
    fn a_chevron_keeps_its_corners() {
        let band =
            of(&[(-10.0, 40.0), (50.0, 20.0), (110.0, 40.0), (110.0, 50.0), (50.0, 30.0), (-10.0, 50.0)]).unwrap();
        assert_eq!(band.points.len(), 3);
        assert_eq!(band.points[1], Vector::xy(50.0, 25.0));
        assert!((band.width - 10.0 * (60.0_f64 / 4000.0_f64.sqrt())).abs() < 1e-9);
    }

    #[test]
    fn what_ends_inside_or_varies_in_width_is_no_band() {
        assert!(of(&[(10.0, 5.0), (16.0, 5.0), (16.0, 85.0), (10.0, 85.0)]).is_none(), "ends inside");
        assert!(of(&[(10.0, -5.0), (16.0, -5.0), (19.0, 85.0), (10.0, 85.0)]).is_none(), "a wedge");
        assert!(of(&[(-5.0, -5.0), (20.0, -5.0), (20.0, 20.0), (-5.0, 20.0)]).is_none(), "a tile in the corner");
    }

    #[test]
    fn a_slanted_stripe_covers_its_corners() {
        let band = of(&[(-20.0, -20.0), (-10.0, -20.0), (110.0, 100.0), (100.0, 100.0)]).unwrap();
        assert!((band.width - 50.0_f64.sqrt()).abs() < 1e-9);
        let reach = (band.points[0] - Vector::xy(-15.0, -20.0)).norm();
        assert!((reach - 12.5_f64.sqrt()).abs() < 1e-9, "{reach}");
    }

    #[test]
    fn the_part_of_a_line_in_the_frame_is_measured() {
        assert_eq!(length_in((Vector::xy(-10.0, 10.0), Vector::xy(200.0, 10.0)), &frame()), 100.0);
        assert_eq!(length_in((Vector::xy(-10.0, 90.0), Vector::xy(200.0, 90.0)), &frame()), 0.0);
    }
}
