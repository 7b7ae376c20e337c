//! Markers: arrow heads and the like, which a line has at its ends and corners.

use arabesque_core::Result;
use kurbo::{Affine, BezPath, ParamCurve, ParamCurveDeriv, PathSeg, Point, Rect, Vec2};
use roxmltree::Node as Xml;
use svgtypes::{Length, PathParser};

use crate::svg::parse::{
    length::{self, Axis, Viewport},
    notes::Note,
    paint::reference,
    source::{Source, clip_text},
    style::Property,
};

/// Whether a shape of this tag may have markers.
pub(crate) fn may_have(tag: &str) -> bool {
    matches!(tag, "path" | "line" | "polyline" | "polygon")
}

/// Where on a line a marker stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spot {
    Start,
    Middle,
    End,
}

impl Spot {
    /// The property that names the marker for it.
    pub(crate) fn property(self) -> Property {
        match self {
            Self::Start => Property::MarkerStart,
            Self::Middle => Property::MarkerMid,
            Self::End => Property::MarkerEnd,
        }
    }
}

/// The markers that vertex `k` of `count` has.
pub(crate) fn spots(k: usize, count: usize) -> impl Iterator<Item = Spot> {
    let is_middle = k > 0 && k + 1 < count;
    let all = [(Spot::Start, k == 0), (Spot::Middle, is_middle), (Spot::End, k + 1 == count)];
    all.into_iter().filter(|(_, is_there)| *is_there).map(|(spot, _)| spot)
}

/// A corner or an end of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vertex {
    at: Point,
    /// The way that the line goes there, in radians: half-way between before and after in a corner.
    angle: f64,
}

/// The vertices of a path; of arcs, which stand as several curves in it, only those in the path data that they come from.
pub(crate) fn vertices(path: &BezPath, data: Option<&str>) -> Vec<Vertex> {
    let mut found = Vec::new();
    for elements in path.subpaths() {
        let segments: Vec<PathSeg> =
            BezPath::from_vec(elements.to_vec()).segments().filter(|s| s.start() != s.end()).collect();
        let (Some(first), Some(last)) = (segments.first(), segments.last()) else {
            found.extend(elements.first().and_then(|e| e.end_point()).map(|at| Vertex { at, angle: 0.0 }));
            continue;
        };
        let is_closed = first.start() == last.end();
        let (out, into) = (direction(first, 0.0), direction(last, 1.0));
        let joint = between(into, out);
        found.push(Vertex { at: first.start(), angle: if is_closed { joint } else { angle(out) } });
        for pair in segments.windows(2) {
            found
                .push(Vertex { at: pair[0].end(), angle: between(direction(&pair[0], 1.0), direction(&pair[1], 0.0)) });
        }
        found.push(Vertex { at: last.end(), angle: if is_closed { joint } else { angle(into) } });
    }
    let Some(data) = data.filter(|data| data.contains(['a', 'A'])) else { return found };
    let mut stated = ends(data).into_iter().peekable();
    let near = 1e-6 * (1.0 + path.control_box().width() + path.control_box().height());
    found.retain(|vertex| stated.next_if(|at| (*at - vertex.at).hypot() <= near).is_some());
    found
}

/// Where the segments of path data end.
fn ends(data: &str) -> Vec<Point> {
    use svgtypes::PathSegment as S;
    let (mut at, mut start, mut all) = (Point::ZERO, Point::ZERO, Vec::new());
    for segment in PathParser::from(data).map_while(|segment| segment.ok()) {
        let base = |abs: bool| if abs { Vec2::ZERO } else { at.to_vec2() };
        at = match segment {
            S::HorizontalLineTo { abs, x } => Point::new(base(abs).x + x, at.y),
            S::VerticalLineTo { abs, y } => Point::new(at.x, base(abs).y + y),
            S::ClosePath { .. } => start,
            S::MoveTo { abs, x, y }
            | S::LineTo { abs, x, y }
            | S::CurveTo { abs, x, y, .. }
            | S::SmoothCurveTo { abs, x, y, .. }
            | S::Quadratic { abs, x, y, .. }
            | S::SmoothQuadratic { abs, x, y }
            | S::EllipticalArc { abs, x, y, .. } => Point::new(x, y) + base(abs),
        };
        if matches!(segment, S::MoveTo { .. }) {
            start = at;
        }
        if all.last() != Some(&at) {
            all.push(at);
        }
    }
    all
}

/// The way that a segment goes at its start (0) or end (1), of length 1.
fn direction(segment: &PathSeg, t: f64) -> Vec2 {
    let derivative = match segment {
        PathSeg::Line(s) => s.deriv().eval(t).to_vec2(),
        PathSeg::Quad(s) => s.deriv().eval(t).to_vec2(),
        PathSeg::Cubic(s) => s.deriv().eval(t).to_vec2(),
    };
    // Where a handle has no length, the curve nearby tells.
    let nearby = || if t < 0.5 { segment.eval(1e-3) - segment.start() } else { segment.end() - segment.eval(0.999) };
    let way = if derivative.hypot() > 1e-9 * (segment.end() - segment.start()).hypot() { derivative } else { nearby() };
    if way.hypot() > 0.0 { way.normalize() } else { Vec2::new(1.0, 0.0) }
}

fn angle(way: Vec2) -> f64 {
    way.y.atan2(way.x)
}

fn between(a: Vec2, b: Vec2) -> f64 {
    let sum = a + b;
    if sum.hypot() > 1e-9 { angle(sum) } else { angle(a) + std::f64::consts::FRAC_PI_2 }
}

/// The marker that a property names.
pub(crate) fn find<'a>(source: &Source<'a>, value: &str) -> Option<Xml<'a, 'a>> {
    let id = match reference(value)? {
        Ok((id, _)) => id,
        Err(outside) => {
            source.notes.add(Note::External, || clip_text(outside, 60).to_owned());
            return None;
        }
    };
    let found = source.by_id(id).filter(|node| node.tag_name().name() == "marker");
    if found.is_none() {
        source.notes.add(Note::Missing, || format!("marker #{}", clip_text(id, 60)));
    }
    found
}

/// A marker at its place.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    /// From its content to the coordinates of the line.
    pub(crate) transform: Affine,
    /// What shows of it, in coordinates of its content.
    pub(crate) clip: Option<Rect>,
    /// What percentages in it refer to.
    pub(crate) viewport: Viewport,
}

/// The marker at a vertex of a line of some width; `None` where it has no size.
///
/// # Errors
/// As [`length::fit`].
pub(crate) fn placed(
    source: &Source<'_>,
    marker: Xml<'_, '_>,
    (vertex, spot): (&Vertex, Spot),
    width: f64,
    viewport: Viewport,
) -> Result<Option<Placed>> {
    let text = |name: &str| marker.attribute(name).map(str::trim);
    let number = |text: &str, axis: Axis, viewport: Viewport| {
        let length: Length = text.parse().ok()?;
        Some(viewport.resolve(length, axis, 16.0)).filter(|v| v.is_finite())
    };
    let size = |name, axis| text(name).and_then(|t| number(t, axis, viewport)).unwrap_or(3.0);
    let (w, h) = (size("markerWidth", Axis::X), size("markerHeight", Axis::Y));
    let scale = if text("markerUnits") == Some("userSpaceOnUse") { 1.0 } else { width };
    if w <= 0.0 || h <= 0.0 || scale <= 0.0 {
        return Ok(None);
    }
    let fit = length::fit(source, marker, w, h)?;
    let (shift, [sx, sy]) = (Vec2::new(fit.shift[0], fit.shift[1]), fit.scale);
    let shown = Rect::new(-shift.x / sx, -shift.y / sy, (w - shift.x) / sx, (h - shift.y) / sy);
    let side = |name, axis, ends: [f64; 2]| match text(name) {
        Some("left" | "top") => ends[0],
        Some("center") => 0.5 * (ends[0] + ends[1]),
        Some("right" | "bottom") => ends[1],
        other => other.and_then(|t| number(t, axis, fit.viewport)).unwrap_or(0.0),
    };
    let hold = Vec2::new(
        side("refX", Axis::X, [shown.x0, shown.x1]) * sx + shift.x,
        side("refY", Axis::Y, [shown.y0, shown.y1]) * sy + shift.y,
    );
    let turn = match text("orient") {
        Some("auto") => vertex.angle,
        Some("auto-start-reverse") if spot == Spot::Start => vertex.angle + std::f64::consts::PI,
        Some("auto-start-reverse") => vertex.angle,
        other => other.and_then(stated_angle).unwrap_or(0.0),
    };
    let transform = Affine::translate(vertex.at.to_vec2())
        * Affine::rotate(turn)
        * Affine::scale(scale)
        * Affine::translate(shift - hold)
        * Affine::scale_non_uniform(sx, sy);
    let overflow =
        text("overflow").or_else(|| text("style").and_then(|s| s.split_once("overflow:").map(|(_, v)| v.trim())));
    let is_open = overflow.is_some_and(|o| o.starts_with("visible") || o.starts_with("auto"));
    Ok(Some(Placed { transform, clip: (!is_open).then_some(shown), viewport: fit.viewport }))
}

/// An angle in radians: degrees where it has no unit.
fn stated_angle(text: &str) -> Option<f64> {
    let angle: svgtypes::Angle = text.parse().ok()?;
    Some(angle.to_degrees().to_radians()).filter(|a| a.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(data: &str) -> Vec<(f64, f64, f64)> {
        let path = BezPath::from_svg(data).unwrap();
        let round = |v: f64| (v * 10.0).round() / 10.0;
        vertices(&path, Some(data))
            .iter()
            .map(|v| (round(v.at.x), round(v.at.y), round(v.angle.to_degrees())))
            .collect()
    }

    #[test]
    fn lines_turn_at_corners_and_closed_ones_at_their_start() {
        assert_eq!(at("M0 0H10V10"), [(0.0, 0.0, 0.0), (10.0, 0.0, 45.0), (10.0, 10.0, 90.0)]);
        let square = at("M0 0H10V10H0Z");
        assert_eq!((square.len(), square[0], square[4]), (5, (0.0, 0.0, -45.0), (0.0, 0.0, -45.0)));
        assert_eq!(at("M0 0L10 10M20 0v5").len(), 4);
        assert_eq!(at("M3 4h0"), [(3.0, 4.0, 0.0)]);
    }

    #[test]
    fn arcs_have_markers_at_their_ends_alone_and_curves_follow_their_handles() {
        assert_eq!(at("M0 0A10 10 0 0 1 20 0H30"), [(0.0, 0.0, -90.0), (20.0, 0.0, 45.0), (30.0, 0.0, 0.0)]);
        assert_eq!(at("M0 0C0 0 0 10 10 10"), [(0.0, 0.0, 90.0), (10.0, 10.0, 0.0)]);
    }

    #[test]
    fn the_first_and_the_last_vertex_have_markers_of_their_own() {
        let all = |count| (0..count).flat_map(|k| spots(k, count)).collect::<Vec<_>>();
        assert_eq!(all(3), [Spot::Start, Spot::Middle, Spot::End]);
        assert_eq!(all(1), [Spot::Start, Spot::End]);
    }
}
