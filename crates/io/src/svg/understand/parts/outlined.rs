//! Filled bands with an outline: what runs through the frame has no end at which its outline could close, so fill and
//! outline are continued each by itself, one over the other.

use std::rc::Rc;

use arabesque_core::{Bounds, Outline, Result, Vector};

use crate::svg::{
    parse::{
        geometry::Painted,
        scene::{Content, Node},
        style::{ComputedStyle, Property as P},
    },
    reason::Reason,
    shape::{
        extent::{longer, sole_shape},
        painted_area::Painter,
    },
    understand::{
        frame::{reaches, runs_through},
        item::{Item, Kind, Origin},
        parts::bands::follow_bands,
        surroundings::Surroundings,
    },
};

/// How near to a side of the frame something ends there, as a share of the frame.
const NEAR: f64 = 1e-3;

/// Takes fills with an outline that run through the frame for two things, where the fill is a band; or `as_areas`, whatever
/// its shape.
///
/// # Errors
/// As [`Painter::painted`].
pub(crate) fn part_outlined(
    items: &mut Vec<Item>,
    painter: &Painter<'_, '_>,
    frame: &Bounds<2>,
    as_areas: bool,
) -> Result<()> {
    let mut which = Vec::new();
    let mut fills = Vec::new();
    for (i, item) in items.iter().enumerate().filter(|(_, item)| may_be_parted(item) && reaches(item, frame) >= 2) {
        let Some(fill) = restyled(item, painter, None, &ComputedStyle::unstroked)? else { continue };
        which.push(i);
        fills.push(fill);
    }
    follow_bands(painter.source, &mut fills, frame)?;
    let mut parted = which.into_iter().zip(fills).peekable();
    let mut all = Vec::with_capacity(items.len());
    for (i, item) in std::mem::take(items).into_iter().enumerate() {
        let fill = parted.next_if(|(which, _)| *which == i).map(|(_, fill)| fill);
        let is_through = |fill: &Item| fill.kind == Kind::Large || runs_through(fill, frame);
        match fill.filter(|fill| fill.kind == Kind::Curve || as_areas && is_through(fill)) {
            Some(fill) => push_both(&mut all, &item, fill, painter, frame)?,
            None => all.push(item),
        }
    }
    *items = all;
    Ok(())
}

/// The fill and the outline of something that covers the frame; the thing itself where it has not both.
///
/// # Errors
/// As [`Painter::painted`].
pub(crate) fn parted(item: Item, painter: &Painter<'_, '_>, frame: &Bounds<2>) -> Result<Vec<Item>> {
    let fill = if may_be_parted(&item) { restyled(&item, painter, None, &ComputedStyle::unstroked)? } else { None };
    let mut all = Vec::new();
    match fill {
        Some(fill) => push_both(&mut all, &item, fill, painter, frame)?,
        None => all.push(item),
    }
    Ok(all)
}

/// Adds fill and outline in the order in which they are painted.
fn push_both(all: &mut Vec<Item>, item: &Item, fill: Item, painter: &Painter<'_, '_>, frame: &Bounds<2>) -> Result<()> {
    let clip = inside(&fill.outline.bounds(), frame);
    let line = restyled(item, painter, Some(clip), &ComputedStyle::unfilled)?;
    let line = line.map(|line| Item {
        kind: Kind::Curve,
        origin: Origin::Stroke,
        reason: Reason::BandOutline,
        is_cut: false,
        ..line
    });
    if item.parts.iter().any(|(_, node)| node.style.get(P::PaintOrder).starts_with("stroke")) {
        all.extend(line);
        all.push(fill);
    } else {
        all.push(fill);
        all.extend(line);
    }
    Ok(())
}

/// The part of the plane in which the outline of something is seen: little more than the frame, for how it closes beyond that
/// says nothing; and less of it where the thing ends on a side of the frame, for the outline along that side is not part of
/// the pattern either.
fn inside(extent: &Bounds<2>, frame: &Bounds<2>) -> Outline<2> {
    let near = NEAR * longer(frame);
    let side = |at: f64, side: f64, outwards: f64| {
        if (at - side).abs() <= near { side - 0.5 * near * outwards } else { side + near * outwards }
    };
    let low: [f64; 2] = std::array::from_fn(|k| side(extent.min[k], frame.min[k], -1.0));
    let high: [f64; 2] = std::array::from_fn(|k| side(extent.max[k], frame.max[k], 1.0));
    let corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])];
    Outline { rings: vec![corners.iter().map(|&(x, y)| Vector::xy(x, y)).collect()] }
}

/// Whether an item is one opaque shape with a fill and a stroke that nothing is decided about.
fn may_be_parted(item: &Item) -> bool {
    let [(parent, node)] = item.parts.as_slice() else { return false };
    let Some(only) = sole_shape(node, *parent) else { return false };
    let Content::Shape(geometry) = &only.leaf.content else { return false };
    let style = &only.leaf.style;
    matches!(item.kind, Kind::Element | Kind::Large | Kind::Area)
        && item.origin == Origin::Fill
        && geometry.paint == Painted::Style
        && style.fills()
        && style.strokes()
        && !style.has_markers()
        && item.opacity >= 1.0
        && has_no_opacity(node)
}

/// Whether fill and stroke of a node can be drawn one after the other with the same result.
fn has_no_opacity(node: &Node) -> bool {
    node.own.get("opacity").is_none() && !node.own.has_effects() && node.children().iter().all(|n| has_no_opacity(n))
}

/// An item painted in another style, within `clip`; `None` where nothing of it is seen.
fn restyled(
    item: &Item,
    painter: &Painter<'_, '_>,
    clip: Option<Outline<2>>,
    style: &dyn Fn(&ComputedStyle) -> ComputedStyle,
) -> Result<Option<Item>> {
    let [(parent, node)] = item.parts.as_slice() else { return Ok(None) };
    let node = Rc::new(with_style(node, style));
    let clip = match (clip, &item.clip) {
        (Some(a), Some(b)) => Some(Rc::new(a.try_intersection(b, painter.source.budget)?)),
        (a, b) => a.map(Rc::new).or_else(|| b.clone()),
    };
    let at = Surroundings { layer: item.layer.clone(), opacity: item.opacity, clip, ..Surroundings::new(*parent) };
    Item::taken(painter, &node, &at, (item.kind, item.origin, item.reason))
}

fn with_style(node: &Node, style: &dyn Fn(&ComputedStyle) -> ComputedStyle) -> Node {
    let content = match &node.content {
        Content::Group(children) => {
            Content::Group(children.iter().map(|child| Rc::new(with_style(child, style))).collect())
        }
        Content::Shape(geometry) => Content::Shape(Rc::clone(geometry)),
    };
    Node { style: Rc::new(style(&node.style)), content, ..node.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_is_seen_in_the_frame_and_not_along_the_sides_where_the_fill_ends() {
        let at = |a: (f64, f64), b: (f64, f64)| Bounds::new(Vector::xy(a.0, a.1), Vector::xy(b.0, b.1));
        let frame = at((0.0, 0.0), (100.0, 80.0));
        let seen = inside(&at((0.0, 20.0), (120.0, 30.0)), &frame).bounds();
        assert!(seen.min[0] > 0.0 && seen.max[0] > 100.0 && seen.max[0] < 101.0, "{seen:?}");
        assert!(seen.min[1] < 0.0 && seen.max[1] > 80.0, "{seen:?}");
    }
}
