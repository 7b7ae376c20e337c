//! Filled outlines that are really lines, as drawing programs make them by "stroke to path": taken for strokes where
//! they are too large for an element.

use std::{collections::BTreeSet, rc::Rc};

use arabesque_core::{Bounds, Error, Result};
use kurbo::Affine;

use crate::svg::{
    centreline::centrelines,
    parse::{
        notes::Note,
        paint::reference,
        scene::{Content, Node},
        source::Source,
        style::Property as P,
    },
    reason::Reason,
    shape::{extent::longer, painted_area::Painter},
    understand::{
        item::{Item, Kind, Origin},
        surroundings::Surroundings,
    },
};

/// How near to a side of the frame something reaches it, as a share of the frame.
const NEAR: f64 = 1e-3;

/// Finds the lines of outlines that are too large for elements, of what is painted like those, and of what is marked as
/// a curve.
///
/// # Errors
/// [`Error::Unsupported`] for something filled that is marked as a curve and has no lines of one width.
pub(crate) fn trace(source: &Source<'_>, items: &mut [Item], window: &Bounds<2>) -> Result<()> {
    let mut paints = BTreeSet::new();
    for item in items.iter_mut().filter(|item| item.kind == Kind::Large && is_plain_fill(item)) {
        if follow(source, item, window)? {
            paints.insert(item.painted.colours_key());
        }
    }
    for item in items.iter_mut().filter(|item| item.kind == Kind::Element && runs_through(item, window)) {
        if is_plain_fill(item) {
            follow(source, item, window)?;
        }
    }
    // Smaller pieces of the same paint are parts of the same net.
    for item in items.iter_mut().filter(|item| item.kind == Kind::Element && item.origin != Origin::Whole) {
        if paints.contains(&item.painted.colours_key()) && is_plain_fill(item) {
            follow(source, item, window)?;
        }
    }
    for item in items.iter_mut().filter(|item| item.kind == Kind::Curve && item.lines.is_none() && is_plain_fill(item))
    {
        if !follow(source, item, window)? {
            return Err(Error::Unsupported {
                what: format!(
                    "{}: {}, filled and marked as a curve but not the outline of lines of one width",
                    source.name,
                    item.name(source)
                ),
                advice: "give it a stroke and no fill, or mark it data-arabesque=\"element\"".into(),
            });
        }
    }
    Ok(())
}

/// Takes fills that run through the frame for areas.
pub(crate) fn take_areas(items: &mut [Item], window: &Bounds<2>) {
    let reaches_over = |item: &Item| {
        let b = item.outline.bounds();
        let near = NEAR * window.size().norm();
        let reaches =
            |k: usize| usize::from(b.min[k] <= window.min[k] + near) + usize::from(b.max[k] >= window.max[k] - near);
        reaches(0) + reaches(1) >= 2
    };
    for item in items.iter_mut().filter(|item| is_plain_fill(item)) {
        let is_area = match item.kind {
            Kind::Large => reaches_over(item),
            Kind::Element => runs_through(item, window),
            Kind::Curve | Kind::Area => false,
        };
        if !is_area {
            continue;
        }
        (item.kind, item.reason) = (Kind::Area, Reason::Area);
    }
}

/// Takes fills that cover the frame for areas too where others are painted alike: of a stack of waves, the lowest ones
/// show only between the border of the frame and the next.
///
/// # Errors
/// As [`Painter::painted`].
pub(crate) fn take_backgrounds(
    items: &mut Vec<Item>,
    background: &mut Vec<(Affine, Rc<Node>)>,
    painter: &Painter<'_, '_>,
) -> Result<()> {
    let areas = items.iter().filter(|item| item.kind == Kind::Area);
    let paints: BTreeSet<String> = areas.map(|item| item.painted.colours_key()).collect();
    if paints.is_empty() {
        return Ok(());
    }
    let (mut lowest, mut rest) = (Vec::new(), Vec::new());
    for (parent, node) in background.drain(..) {
        let taken = (Kind::Area, Origin::Fill, Reason::Area);
        let item = Item::taken(painter, &node, &Surroundings::new(parent), taken)?;
        match item.filter(|item| paints.contains(&item.painted.colours_key()) && is_plain_fill(item)) {
            Some(item) => lowest.push(item),
            None => rest.push((parent, node)),
        }
    }
    *background = rest;
    items.splice(0..0, lowest);
    Ok(())
}

/// Whether an item reaches from one side of the frame to the opposite one: a wave of one width.
fn runs_through(item: &Item, window: &Bounds<2>) -> bool {
    let (extent, near) = (item.outline.bounds(), NEAR * longer(window));
    (0..2).any(|k| extent.min[k] <= window.min[k] + near && extent.max[k] >= window.max[k] - near)
}

/// Makes an item a curve where it is the outline of lines.
fn follow(source: &Source<'_>, item: &mut Item, window: &Bounds<2>) -> Result<bool> {
    if item.lines.is_none() {
        item.lines = centrelines(&item.outline, Some(window), source.budget)?.map(Rc::new);
    }
    if item.lines.is_some() {
        (item.kind, item.reason) = (Kind::Curve, Reason::Traced);
        source.notes.add(Note::Traced, || item.name(source));
    }
    Ok(item.lines.is_some())
}

/// Whether everything in an item is filled with one colour, and nothing has a stroke.
fn is_plain_fill(item: &Item) -> bool {
    fn is_plain(node: &Node) -> bool {
        match &node.content {
            Content::Group(children) => children.iter().all(|child| is_plain(child)),
            // A gradient is stretched over the box of what it paints, which a straight stroke has not.
            Content::Shape(_) => {
                node.style.fills() && !node.style.strokes() && reference(node.style.get(P::Fill)).is_none()
            }
        }
    }
    item.origin != Origin::Whole && item.parts.iter().all(|(_, node)| is_plain(node))
}
