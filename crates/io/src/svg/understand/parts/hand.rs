//! Filled bands with edges as a hand draws them: about as wide all along, but neither straight nor parallel. They are
//! continued as lines of their mean width, which wander as the middle between both edges does.
//!
//! The two edges are looked at along the main direction of the band. Several bands of one paint make a family, which is
//! drawn with one width: they are meant to be alike, and each may stand in for another.

use std::{collections::BTreeMap, rc::Rc};

use arabesque_core::{Bounds, Cubic, Outline, Path, Result, Vector, ring};

use crate::svg::{
    centreline::Centrelines,
    parse::source::Source,
    reason::Reason,
    shape::extent::longer,
    understand::{
        frame::reaches,
        item::{Item, Kind, Origin},
        outlined_lines::is_plain_fill,
    },
};

/// How near to the frame an end may be, as a share of the frame.
const NEAR: f64 = 2e-3;
/// Widest band, as a share of the shorter side of the frame.
const WIDEST: f64 = 0.45;
/// Shortest band: in widths, and as a share of the shorter side of the frame.
const LENGTH: f64 = 3.0;
const THROUGH: f64 = 0.5;
/// Largest difference between the first and the last decile of the widths of a band, and between its width and that of
/// its family, as shares.
const SPREAD: f64 = 0.5;
const APART: f64 = 0.35;
/// What is narrower than this share of the width belongs to an end.
const TAPER: f64 = 0.6;
/// Least distance of places along a band, in widths; and the mean distance below which the edges are drawn with curves,
/// which are looked at in such steps.
const STEP: f64 = 0.15;
const FINE: f64 = 0.6;
/// Fewest bands of a family.
const FEWEST: usize = 2;
/// Work for each corner.
const CORNER: u64 = 60;

/// The middle of a band.
struct Band {
    points: Vec<Vector<2>>,
    width: f64,
    is_smooth: bool,
    /// Whether it is long enough to found a family; shorter ones only cut off a corner of the frame.
    is_long: bool,
}

/// Makes strokes of the families of hand-drawn bands among `items`.
///
/// # Errors
/// As [`arabesque_core::Budget::spend`].
pub(crate) fn follow_by_hand(source: &Source<'_>, items: &mut [Item], frame: &Bounds<2>) -> Result<()> {
    let mut families: BTreeMap<String, Vec<(usize, Band)>> = BTreeMap::new();
    for (i, item) in items.iter().enumerate().filter(|(_, item)| may_be_band(item) && reaches(item, frame) >= 2) {
        source.budget.spend(CORNER * item.outline.points().count() as u64)?;
        if let Some(band) = band(&item.outline, frame) {
            families.entry(item.painted.colours_key()).or_default().push((i, band));
        }
    }
    for family in families.into_values() {
        let is_done = family.iter().all(|(i, _)| items[*i].kind == Kind::Curve);
        if family.iter().filter(|(_, band)| band.is_long).count() < FEWEST || is_done {
            continue;
        }
        let width = middle(family.iter().map(|(_, band)| band.width).collect());
        for (i, band) in family.into_iter().filter(|(_, band)| (band.width - width).abs() <= APART * width) {
            let path = if band.is_smooth { smooth(&band.points) } else { Path::polyline(&band.points) };
            items[i].lines = Some(Rc::new(Centrelines { paths: vec![path], width, spread: 0.0 }));
            (items[i].kind, items[i].reason) = (Kind::Curve, Reason::HandBand);
        }
    }
    Ok(())
}

/// Whether an item is a fill that nothing is decided about, or the outline of one line.
fn may_be_band(item: &Item) -> bool {
    let is_open = matches!(item.kind, Kind::Element | Kind::Large) && item.lines.is_none();
    let is_line = item.kind == Kind::Curve
        && item.reason == Reason::Traced
        && item.lines.as_ref().is_some_and(|lines| lines.paths.len() == 1);
    (is_open || is_line) && item.origin != Origin::Whole && !item.is_cut && is_plain_fill(item)
}

/// The band of which an outline is the border.
fn band(outline: &Outline<2>, frame: &Bounds<2>) -> Option<Band> {
    let [ring] = outline.rings.as_slice() else { return None };
    if ring.len() < 4 || ring::area(ring).abs() <= 0.0 {
        return None;
    }
    let (centre, way) = main_direction(ring)?;
    let normal = Vector::xy(-way[1], way[0]);
    let flat: Vec<[f64; 2]> = ring.iter().map(|&p| [(p - centre).dot(way), (p - centre).dot(normal)]).collect();
    let [left, right] = edges(&flat)?;
    let mut stations: Vec<f64> = left.iter().chain(&right).map(|p| p[0]).collect();
    stations.sort_by(f64::total_cmp);
    let gap = |s: f64| Some((at(&left, s)? - at(&right, s)?).abs());
    let rough = middle(stations.iter().filter_map(|&s| gap(s)).collect());
    // Near the ends, too, where the corners of the edges may be far away.
    let (first, last) = (stations.first().copied()?, stations.last().copied()?);
    stations.extend([0.2, 0.5].into_iter().flat_map(|share| [first + share * rough, last - share * rough]));
    stations.retain(|s| (first..=last).contains(s));
    stations.sort_by(f64::total_cmp);
    stations.dedup_by(|next, last| *next - *last < STEP * rough);
    let place = |s: f64| Some(centre + way * s + normal * (0.5 * (at(&left, s)? + at(&right, s)?)));
    let mut line: Vec<(Vector<2>, f64)> = stations.iter().filter_map(|&s| Some((place(s)?, gap(s)?))).collect();
    let wide = TAPER * rough;
    let first = line.iter().position(|(_, gap)| *gap >= wide)?;
    let last = line.iter().rposition(|(_, gap)| *gap >= wide)?;
    let ends = [line[..first].len(), line[last + 1..].len()];
    line = line[first..=last].to_vec();
    let points: Vec<Vector<2>> = line.iter().map(|(p, _)| *p).collect();
    if points.len() < 2 {
        return None;
    }
    let width = even_width(&line, way, frame)?;
    let inside: f64 =
        points.windows(2).filter(|w| frame.contains(w[0]) || frame.contains(w[1])).map(|w| (w[1] - w[0]).norm()).sum();
    let shorter = frame.size()[0].min(frame.size()[1]);
    let near = NEAR * longer(frame) + if ends == [0, 0] { 0.0 } else { width };
    let is_through = [points[0], points[points.len() - 1]].iter().all(|&end| frame.signed_distance(end) <= near);
    let is_band = is_through && width <= WIDEST * shorter;
    let is_long = inside >= (LENGTH * width).max(THROUGH * shorter);
    let length: f64 = points.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let is_smooth = length / (points.len() as f64) < FINE * width;
    let points = if is_smooth { thinned(&points, FINE * width) } else { points };
    is_band.then(|| Band { points: lengthened(points, width), width, is_smooth, is_long })
}

/// The width of a band where it is about the same all along.
fn even_width(line: &[(Vector<2>, f64)], way: Vector<2>, frame: &Bounds<2>) -> Option<f64> {
    let mut widths: Vec<f64> = Vec::new();
    for step in line.windows(2) {
        let slant = (step[1].0 - step[0].0).unit_or_zero().dot(way).abs();
        if frame.contains(step[0].0) || frame.contains(step[1].0) {
            widths.push(0.5 * (step[0].1 + step[1].1) * slant);
        }
    }
    widths.sort_by(f64::total_cmp);
    let width = middle(widths.clone());
    let decile = |k: usize| widths.get(k * widths.len().saturating_sub(1) / 10).copied().unwrap_or(0.0);
    (width > 0.0 && decile(9) - decile(1) <= SPREAD * width).then_some(width)
}

/// The middle one of some values.
fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The centre of a ring, and the direction in which it is longest.
fn main_direction(ring: &[Vector<2>]) -> Option<(Vector<2>, Vector<2>)> {
    let closed = || ring.iter().zip(ring.iter().cycle().skip(1));
    let length: f64 = closed().map(|(a, b)| (*b - *a).norm()).sum();
    if length <= 0.0 {
        return None;
    }
    let weighted = |(a, b): (&Vector<2>, &Vector<2>)| ((*a + *b) * 0.5, (*b - *a).norm() / length);
    let centre = closed().map(weighted).fold(Vector::ZERO, |sum, (p, share)| sum + p * share);
    let mut moments = [0.0; 3];
    for (p, share) in closed().map(weighted) {
        let d = p - centre;
        moments[0] += d[0] * d[0] * share;
        moments[1] += d[0] * d[1] * share;
        moments[2] += d[1] * d[1] * share;
    }
    let angle = 0.5 * (2.0 * moments[1]).atan2(moments[0] - moments[2]);
    Some((centre, Vector::xy(angle.cos(), angle.sin())))
}

/// The two edges from the first to the last point along the main direction; `None` where one of them turns back.
fn edges(flat: &[[f64; 2]]) -> Option<[Vec<[f64; 2]>; 2]> {
    let n = flat.len();
    let first = (0..n).min_by(|&i, &j| flat[i][0].total_cmp(&flat[j][0]))?;
    let last = (0..n).max_by(|&i, &j| flat[i][0].total_cmp(&flat[j][0]))?;
    let slack = 1e-2 * (flat[last][0] - flat[first][0]);
    let edge = |step: usize| {
        let mut edge: Vec<[f64; 2]> = vec![flat[first]];
        let mut i = first;
        while i != last {
            i = (i + step) % n;
            let reached = edge.last().map_or(f64::NEG_INFINITY, |p| p[0]);
            if flat[i][0] < reached - slack {
                return None;
            }
            if flat[i][0] >= reached {
                edge.push(flat[i]);
            }
        }
        Some(edge)
    };
    Some([edge(1)?, edge(n - 1)?])
}

/// How far off the axis an edge is at a place along it.
fn at(edge: &[[f64; 2]], s: f64) -> Option<f64> {
    let k = edge.partition_point(|p| p[0] <= s);
    let (before, after) = (edge.get(k.checked_sub(1)?)?, edge.get(k));
    let Some(after) = after else { return Some(before[1]) };
    Some(before[1] + (after[1] - before[1]) * (s - before[0]) / (after[0] - before[0]))
}

/// Points of a line that are at least so far apart, with both ends.
fn thinned(points: &[Vector<2>], apart: f64) -> Vec<Vector<2>> {
    let mut kept: Vec<Vector<2>> = Vec::new();
    for &p in points {
        if kept.last().is_none_or(|&last| (p - last).norm() >= apart) {
            kept.push(p);
        }
    }
    match (points.last(), kept.len()) {
        (Some(&end), n @ 2..) => kept[n - 1] = end,
        (Some(&end), 1) if points.len() > 1 => kept.push(end),
        _ => {}
    }
    kept
}

/// A line that is a width longer at both ends, which lie at the frame.
fn lengthened(mut points: Vec<Vector<2>>, by: f64) -> Vec<Vector<2>> {
    let n = points.len();
    let (start, end) = ((points[0] - points[1]).unit_or_zero(), (points[n - 1] - points[n - 2]).unit_or_zero());
    points[0] += start * by;
    points[n - 1] += end * by;
    points
}

/// A smooth line through points.
fn smooth(points: &[Vector<2>]) -> Path<2> {
    let n = points.len();
    let slope = |k: usize| (points[(k + 1).min(n - 1)] - points[k.saturating_sub(1)]) * (1.0 / 6.0);
    let cubic =
        |k: usize| -> Cubic<2> { [points[k], points[k] + slope(k), points[k + 1] - slope(k + 1), points[k + 1]] };
    Path { cubics: (0..n.saturating_sub(1)).map(cubic).collect(), closed: false }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    fn frame() -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(100.0, 80.0))
    }

    /// A band from x = -5 to 105 with edges that wander by `off` about y = 20 and y = 26.
    fn wobbly(off: f64, from: f64) -> Outline<2> {
        let wave = |k: i32| off * (f64::from(k * k % 7) / 3.0 - 1.0);
        let upper = (0..=11).map(|k| Vector::xy(from + 10.0 * f64::from(k), 20.0 + wave(k)));
        let lower = (0..=11).rev().map(|k| Vector::xy(from + 10.0 * f64::from(k), 26.0 + wave(k + 3)));
        Outline { rings: vec![upper.chain(lower).collect()] }
    }

    #[test]
    fn a_band_with_wobbly_edges_is_a_line_of_its_mean_width() {
        let found = band(&wobbly(0.8, -5.0), &frame()).unwrap();
        assert!((found.width - 6.0).abs() < 0.6, "{}", found.width);
        assert!(found.points.iter().all(|p| (p[1] - 23.0).abs() < 1.0), "{:?}", found.points);
        assert!(found.points[0][0] < -5.0 || found.points[0][0] > 105.0);
    }

    #[test]
    fn a_thinned_line_keeps_both_ends() {
        let line = [0.0, 0.1, 0.2].map(|x| Vector::xy(x, 0.0));
        assert_eq!(thinned(&line, 5.0), [line[0], line[2]]);
        assert_eq!(thinned(&line[..1], 5.0).len(), 1);
    }

    #[test]
    fn what_ends_inside_or_is_of_all_widths_is_no_band() {
        assert!(band(&wobbly(0.8, 15.0), &frame()).is_none());
        assert!(band(&wobbly(4.0, -5.0), &frame()).is_none());
    }
}
