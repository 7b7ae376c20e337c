//! Clips and masks that take nothing away: those as large as the frame, as drawing programs write around a whole page.

use std::rc::Rc;

use arabesque_core::{Bounds, Outline, Result};
use kurbo::Affine;

use crate::svg::{
    parse::{
        paint::{fraction, reference},
        scene::{Content, Node, build_definition},
        style::Property as P,
    },
    shape::{extent::longer, painted_area::Painter},
};

/// How far inside the frame such a clip may stay, as a share of the frame.
const WITHIN: f64 = 2e-3;

/// A node without the clips and masks in it that leave all of the frame visible.
///
/// # Errors
/// As for clips that cannot be read.
pub(crate) fn without_idle_clips(
    painter: &Painter<'_, '_>,
    node: &Rc<Node>,
    parent: Affine,
    frame: &Bounds<2>,
) -> Result<Rc<Node>> {
    let world = parent * node.transform;
    let mut own = None;
    if node.own.get("clip-path").is_some_and(|c| c != "none")
        && painter.clip(node, world)?.is_some_and(|clip| covers(&clip, frame))
    {
        own = Some(node.own.without("clip-path"));
    }
    if node.own.get("mask").is_some_and(|m| m != "none") && is_idle_mask(painter, node, world, frame)? {
        own = Some(own.as_ref().unwrap_or(&node.own).without("mask"));
    }
    let children = node.children();
    let inside = children.iter().map(|child| without_idle_clips(painter, child, world, frame));
    let inside = inside.collect::<Result<Vec<_>>>()?;
    let is_same = own.is_none() && inside.iter().zip(children).all(|(new, old)| Rc::ptr_eq(new, old));
    if is_same {
        return Ok(Rc::clone(node));
    }
    let content = match &node.content {
        Content::Group(_) => Content::Group(inside),
        Content::Shape(geometry) => Content::Shape(Rc::clone(geometry)),
    };
    Ok(Rc::new(Node { own: own.unwrap_or_else(|| node.own.clone()), content, ..(**node).clone() }))
}

/// Whether an area leaves all of the frame visible.
fn covers(area: &Outline<2>, frame: &Bounds<2>) -> bool {
    let inner = frame.grown(-WITHIN * longer(frame));
    let (a, b) = (inner.min, inner.max);
    let corners = [[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]].map(arabesque_core::Vector);
    let crosses = || area.edges().any(|(p, q)| inner.contains(p) || inner.contains(q));
    corners.iter().all(|&corner| area.contains(corner)) && !crosses()
}

/// Whether a mask is one white shape that covers the frame.
fn is_idle_mask(painter: &Painter<'_, '_>, node: &Node, world: Affine, frame: &Bounds<2>) -> Result<bool> {
    let source = painter.source;
    let Some(Ok((id, _))) = node.own.get("mask").and_then(reference) else { return Ok(false) };
    let Some(xml) = source.by_id(id).filter(|xml| xml.tag_name().name() == "mask") else { return Ok(false) };
    let Some(mask) = build_definition(source, xml, node.viewport)? else { return Ok(false) };
    let [only] = mask.children() else { return Ok(false) };
    let in_box = |name: &str| xml.attribute(name) == Some("objectBoundingBox");
    if in_box("maskContentUnits") || !matches!(only.content, Content::Shape(_)) {
        return Ok(false);
    }
    let is_white = only.style.get(P::Fill) == "#ffffff" && fraction(only.style.get(P::FillOpacity)) >= 1.0;
    let is_plain = only.own.get("opacity").is_none_or(|o| fraction(o) >= 1.0) && !only.own.has_effects();
    if !(is_white && is_plain) {
        return Ok(false);
    }
    let area = painter.painted(only, world * mask.transform)?.outline(source.budget)?;
    Ok(covers(&area, frame) && region_covers(xml, world, frame))
}

/// Whether the region of a mask, where the file states it in user units, holds the frame.
fn region_covers(xml: roxmltree::Node<'_, '_>, world: Affine, frame: &Bounds<2>) -> bool {
    if xml.attribute("maskUnits") != Some("userSpaceOnUse") {
        return true;
    }
    let number = |name: &str| xml.attribute(name)?.trim().parse::<f64>().ok();
    let (Some(x), Some(y), Some(width), Some(height)) = (number("x"), number("y"), number("width"), number("height"))
    else {
        // Percentages of the page.
        return true;
    };
    let region = world.transform_rect_bbox(kurbo::Rect::new(x, y, x + width, y + height));
    let near = WITHIN * longer(frame);
    let (low, high) = ([region.x0, region.y0], [region.x1, region.y1]);
    (0..2).all(|k| low[k] <= frame.min[k] + near && high[k] >= frame.max[k] - near)
}
