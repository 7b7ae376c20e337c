//! The frame of an exemplar, and what lies on it.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Outline, Role, Vector};
use kurbo::{Affine, BezPath, ParamCurve as _};

use crate::svg::{
    parse::{
        scene::{Content, Node},
        style::Property as P,
    },
    shape::{
        extent::{longer, outline_bounds},
        stroke::growth,
        subpath::{has_no_length, is_closed},
    },
    understand::{
        item::{HALF, Item, Kind},
        parts::bands::length_in,
    },
};

/// Share of its diagonal that an element has along the frame when it is cut there.
const CUT: f64 = 0.15;
/// How far from the frame a cut may be, as a share of the diagonal of the element.
const NEAR: f64 = 0.002;
/// The same two for edges that lie on the frame as exactly as numbers are written: no whole element has such edges by
/// chance. A ring at the end of a long line has two short ones, where the frame has cut it.
const EXACT_CUT: f64 = 0.008;
const EXACTLY_NEAR: f64 = 1e-5;

/// How near to a side of the frame a stroke ends that is cut there, as a share of the frame.
const ENDS_NEAR: f64 = 1e-4;

/// How near to a side of the frame something reaches it, as a share of the frame.
const REACHES: f64 = 1e-3;

/// Sizes that differ by less than this share of the frame are the same.
const SAME_SIZE: f64 = 2e-4;

/// A box is thin when its shorter side is less than this share of the longer one.
const THIN: f64 = 0.03;

/// Whether an element is whole, or cut by a clip or at the frame; `frame` is `None` where the file states none.
pub(crate) fn role(item: &Item, frame: Option<&Bounds<2>>) -> Role {
    let is_cut = item.is_cut || frame.is_some_and(|frame| is_cut_along(&item.outline, frame) || ends_on(item, frame));
    if is_cut { Role::Context } else { Role::Source }
}

/// Whether each item is whole. What lies along a side of the frame but is as large and as coloured as something that lies
/// away from the sides across that axis is a tile that ends there, not a larger thing that is cut.
pub(crate) fn roles(items: &[Item], frame: Option<&Bounds<2>>) -> Vec<Role> {
    let mut roles: Vec<Role> = items.iter().map(|item| role(item, frame)).collect();
    let Some(frame) = frame else { return roles };
    let unit = SAME_SIZE * longer(frame);
    let key = |item: &Item| {
        let size = item.outline.bounds().size();
        let side = (item.outline.area() / unit).round() as i64;
        ((size[0] / unit).round() as i64, (size[1] / unit).round() as i64, side, item.painted.colours_key())
    };
    if roles.iter().all(|role| *role == Role::Source) {
        return roles;
    }
    let near = NEAR * longer(frame);
    let away = |item: &Item| {
        let extent = item.outline.bounds();
        [0, 1].map(|k| extent.min[k] > frame.min[k] + near && extent.max[k] < frame.max[k] - near)
    };
    let mut whole: BTreeMap<_, [bool; 2]> = BTreeMap::new();
    for (item, role) in items.iter().zip(&roles).filter(|(item, _)| !item.is_cut) {
        let (whole, away) = (whole.entry(key(item)).or_default(), away(item));
        (0..2).for_each(|k| whole[k] |= away[k] || *role == Role::Source);
    }
    for (item, role) in items.iter().zip(&mut roles) {
        let (whole, away) = (whole.get(&key(item)).copied().unwrap_or_default(), away(item));
        if *role == Role::Context && !item.is_cut && (0..2).all(|k| whole[k] || away[k]) {
            *role = Role::Source;
        }
    }
    roles
}

/// Whether a good part of the outline runs exactly along a side of the frame and nothing reaches over that side.
fn is_cut_along(outline: &Outline<2>, frame: &Bounds<2>) -> bool {
    let extent = outline.bounds();
    let diagonal = extent.size().norm();
    let length = |k: usize, side: f64, near: f64| -> f64 {
        let on_side = |v: f64| (v - side).abs() <= near * diagonal;
        let along = outline.edges().filter(|(a, b)| on_side(a[k]) && on_side(b[k]));
        along.map(|(a, b)| (a[1 - k] - b[1 - k]).abs()).sum()
    };
    let sides = (0..2).flat_map(|k| [(k, frame.min[k], extent.min[k]), (k, frame.max[k], extent.max[k])]);
    sides.filter(|(_, side, reach)| (side - reach).abs() <= NEAR * diagonal).any(|(k, side, _)| {
        length(k, side, NEAR) >= CUT * diagonal || length(k, side, EXACTLY_NEAR) >= EXACT_CUT * diagonal
    })
}

/// Whether a stroke ends on a side of the frame, or runs along it, as one does that a file has cut there, and nothing of
/// the item reaches over that side. A copy by `<use>` is as whole as what it shows, and what is too large for an element
/// but taken for one is asked for.
fn ends_on(item: &Item, frame: &Bounds<2>) -> bool {
    let extent = item.outline.bounds();
    if (0..2).any(|k| extent.size()[k] >= HALF * frame.size()[k]) {
        return false;
    }
    let mut all: Vec<(Affine, &Node)> = item.parts.iter().map(|(parent, node)| (*parent, &**node)).collect();
    let mut cut = [false; 4];
    let mut width = 0.0_f64;
    while let Some((parent, node)) = all.pop() {
        let world = parent * node.transform;
        match &node.content {
            _ if node.meta.tag == "use" => {}
            Content::Group(children) => all.extend(children.iter().map(|child| (world, &**child))),
            Content::Shape(geometry) if node.style.strokes() => {
                width = width.max(growth(world) * node.style.number(P::StrokeWidth));
                cut_sides(&(world * geometry.path.clone()), frame, &mut cut);
            }
            Content::Shape(_) => {}
        }
    }
    let over = [
        frame.min[0] - extent.min[0],
        extent.max[0] - frame.max[0],
        frame.min[1] - extent.min[1],
        extent.max[1] - frame.max[1],
    ];
    cut.iter().zip(over).any(|(cut, over)| *cut && over <= width)
}

/// Marks the sides of the frame (left, right, top, bottom) on which a path ends or along which it runs.
fn cut_sides(path: &BezPath, frame: &Bounds<2>, cut: &mut [bool; 4]) {
    let near = ENDS_NEAR * longer(frame);
    let sides = |p: kurbo::Point| -> [bool; 4] {
        let p = [p.x, p.y];
        let within = (0..2).all(|k| (frame.min[k] - near..=frame.max[k] + near).contains(&p[k]));
        let at = |k: usize, side: f64| within && (p[k] - side).abs() <= near;
        [at(0, frame.min[0]), at(0, frame.max[0]), at(1, frame.min[1]), at(1, frame.max[1])]
    };
    let mut mark = |found: [bool; 4]| cut.iter_mut().zip(found).for_each(|(cut, found)| *cut |= found);
    for elements in path.subpaths() {
        let is_dot = has_no_length(&BezPath::from_vec(elements.to_vec()));
        if is_closed(elements) || is_dot {
            continue;
        }
        let ends = [elements.first(), elements.last()].map(|e| e.and_then(kurbo::PathEl::end_point));
        ends.into_iter().flatten().for_each(|end| mark(sides(end)));
    }
    for segment in path.segments() {
        let (from, to) = (segment.start(), segment.end());
        if from.distance(to) > 10.0 * near {
            let (a, b) = (sides(from), sides(to));
            mark(std::array::from_fn(|k| a[k] && b[k]));
        }
    }
}

/// Whether a box is so thin that what it holds tells nothing about a second direction.
pub(crate) fn is_thin(extent: &Bounds<2>) -> bool {
    let size = extent.size();
    !extent.is_empty() && size[0].min(size[1]) < THIN * longer(extent)
}

/// How many sides of the frame an item reaches.
pub(crate) fn reaches(item: &Item, window: &Bounds<2>) -> usize {
    let (b, near) = (item.outline.bounds(), REACHES * window.size().norm());
    let sides =
        |k: usize| usize::from(b.min[k] <= window.min[k] + near) + usize::from(b.max[k] >= window.max[k] - near);
    sides(0) + sides(1)
}

/// Whether some of an item lies in the frame, not only of the box around it.
pub(crate) fn shows(item: &Item, window: &Bounds<2>) -> bool {
    let outline = &item.outline;
    outline.bounds().intersects(window)
        && (reaches(item, window) < 2
            || outline.edges().any(|edge| length_in(edge, window) > 0.0)
            || outline.contains(window.centre()))
}

/// Whether an item reaches from one side of the frame to the opposite one: a wave of one width.
pub(crate) fn runs_through(item: &Item, window: &Bounds<2>) -> bool {
    let (extent, near) = (item.outline.bounds(), REACHES * longer(window));
    (0..2).any(|k| extent.min[k] <= window.min[k] + near && extent.max[k] >= window.max[k] - near)
}

/// The square around the centre of a box, as wide as the longer side.
fn square(extent: &Bounds<2>) -> Bounds<2> {
    let (centre, half) = (extent.centre(), 0.5 * longer(extent));
    Bounds::new(centre - Vector::xy(half, half), centre + Vector::xy(half, half))
}

/// The box around all items, with half the usual gap around it: the frame that the artist had in mind. Curves end at
/// it.
pub(crate) fn around(items: &[Item]) -> Bounds<2> {
    let tight = items.iter().fold(Bounds::EMPTY, |all, item| all.union(&item.outline.bounds()));
    if is_thin(&tight) {
        return square(&tight);
    }
    if items.len() < 2 || items.iter().any(|item| item.kind == Kind::Curve) {
        return tight;
    }
    let spacing = (tight.measure() / items.len() as f64).sqrt();
    let diameter = items.iter().map(|item| item.outline.bounds().measure().sqrt()).sum::<f64>() / items.len() as f64;
    tight.grown((0.5 * (spacing - diameter)).max(0.0))
}

/// The box of a rectangle called "frame".
pub(crate) fn frame_mark(node: &Node, parent: Affine) -> Option<Bounds<2>> {
    let world = parent * node.transform;
    if is_called_frame(node) {
        return Some(outline_bounds(node, parent)).filter(|b| b.measure() > 0.0);
    }
    node.children().iter().find_map(|child| frame_mark(child, world))
}

fn is_called_frame(node: &Node) -> bool {
    let names = [&node.meta.label, &node.meta.id];
    node.meta.tag == "rect" && names.iter().any(|n| n.as_ref().is_some_and(|n| n.eq_ignore_ascii_case("frame")))
}

/// Whether an item is the rectangle that states the frame.
pub(crate) fn is_frame_mark(item: &Item) -> bool {
    item.parts.len() == 1 && item.parts.iter().all(|(_, node)| is_called_frame(node))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[(f64, f64)]) -> Outline<2> {
        Outline { rings: vec![corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect()] }
    }

    fn is_cut(corners: &[(f64, f64)]) -> bool {
        is_cut_along(&polygon(corners), &Bounds::new(Vector::ZERO, Vector::xy(10.0, 10.0)))
    }

    #[test]
    fn a_half_disc_on_the_frame_is_cut_and_a_disc_that_touches_is_not() {
        let arc = |from: f64, to: f64| -> Vec<(f64, f64)> {
            let at = |k: u32| (from + (to - from) * f64::from(k) / 30.0).sin_cos();
            (0..=30).map(at).map(|(s, c)| (s, 5.0 + c)).collect()
        };
        let half = std::f64::consts::PI;
        assert!(is_cut(&arc(0.0, half)));
        let disc: Vec<_> = arc(0.0, 2.0 * half).iter().map(|(x, y)| (x + 1.0, *y)).collect();
        assert!(!is_cut(&disc));
        assert!(is_cut(&[(2.0, 0.0), (3.0, 0.0), (5.0, 9.0), (1.0, 9.0)]), "only the tip is cut off");
        let over: Vec<_> = arc(0.0, 2.0 * half);
        assert!(!is_cut(&over));
        // A fork whose tips lie on the frame: half of a ring at the end of a long line.
        let fork = [(0.0, 5.0), (0.2, 5.1), (9.0, 5.1), (9.0, 5.2), (0.2, 5.2), (0.0, 5.3), (0.0, 5.25), (0.2, 5.15)];
        let fork = [&fork[..], &[(0.0, 5.05)]].concat();
        assert!(is_cut(&fork), "two tips of a twentieth each");
    }

    #[test]
    fn a_straight_line_has_no_frame_of_its_own() {
        let line = Bounds::new(Vector::xy(0.0, 5.0), Vector::xy(10.0, 5.1));
        assert!(is_thin(&line) && !is_thin(&square(&line)) && !is_thin(&Bounds::EMPTY));
        assert_eq!(square(&line).size(), Vector::xy(10.0, 10.0));
    }
}
