//! Filled outlines that are really lines, as drawing programs make them by "stroke to path": taken for strokes where
//! they are too large for an element.

use std::{collections::BTreeSet, rc::Rc};

use arabesque_core::{Bounds, Error, Result};

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
    shape::painted_area::Painter,
    understand::{
        frame::{reaches, runs_through},
        item::{Item, Kind, Origin, Selection},
        parts::outlined::parted,
        surroundings::Surroundings,
    },
};

/// Things that run through the frame before they are no things: one may be.
const SEVERAL: usize = 2;

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

/// Takes fills that run through the frame for areas; and `all_alike`, pieces of compound paths that reach its sides too, and what
/// else is painted like one of these.
pub(crate) fn take_areas(items: &mut [Item], window: &Bounds<2>, all_alike: bool) {
    let mut paints = BTreeSet::new();
    for item in items.iter_mut().filter(|item| is_plain_fill(item)) {
        let is_area = match item.kind {
            Kind::Large => reaches(item, window) >= 2,
            Kind::Element => runs_through(item, window),
            Kind::Curve | Kind::Area => continue,
        };
        if all_alike && (is_area || item.origin == Origin::Piece && reaches(item, window) > 0) {
            paints.insert(item.painted.colours_key());
        }
        if is_area {
            (item.kind, item.reason) = (Kind::Area, Reason::Area);
        }
    }
    let may_be = |item: &&mut Item| matches!(item.kind, Kind::Large | Kind::Element) && is_plain_fill(item);
    for item in items.iter_mut().filter(may_be).filter(|item| paints.contains(&item.painted.colours_key())) {
        (item.kind, item.reason) = (Kind::Area, Reason::AreaAlike);
    }
}

/// Takes fills that cover the frame for areas too where others are painted alike: of a stack of waves, the lowest ones
/// show only between the border of the frame and the next.
///
/// # Errors
/// As [`Painter::painted`].
pub(crate) fn take_backgrounds(found: &mut Selection, painter: &Painter<'_, '_>, window: &Bounds<2>) -> Result<()> {
    let Selection { items, background, left_out } = found;
    let areas = items.iter().filter(|item| item.kind == Kind::Area);
    let paints: BTreeSet<String> = areas.map(|item| item.painted.colours_key()).collect();
    if paints.is_empty() {
        return Ok(());
    }
    let (mut lowest, mut rest, mut is_taken) = (Vec::new(), Vec::new(), Vec::new());
    for (parent, node) in background.drain(..) {
        let taken = (Kind::Area, Origin::Fill, Reason::Area);
        let item = Item::taken(painter, &node, &Surroundings::new(parent), taken)?;
        let parts = item.map_or_else(|| Ok(Vec::new()), |item| parted(item, painter, window))?;
        let is_like = |item: &Item| paints.contains(&item.painted.colours_key()) && is_plain_fill(item);
        is_taken.push(parts.iter().any(|item| item.kind == Kind::Area && is_like(item)));
        if is_taken.last() == Some(&true) {
            lowest.extend(parts);
        } else {
            rest.push((parent, node));
        }
    }
    *background = rest;
    // What is left out for being a background is listed in the same order.
    let mut is_taken = is_taken.into_iter();
    left_out.retain(|(reason, ..)| *reason != Reason::Background || is_taken.next() != Some(true));
    items.splice(0..0, lowest);
    Ok(())
}

/// Refuses fills that run through the frame and are neither areas nor lines: copied as things they would end in the middle
/// of the page.
///
/// # Errors
/// [`Error::Unsupported`] where there are several.
pub(crate) fn refuse_through(source: &Source<'_>, items: &[Item], window: &Bounds<2>) -> Result<()> {
    let is_open = |item: &&Item| {
        matches!(item.kind, Kind::Element | Kind::Large)
            && matches!(item.origin, Origin::Fill | Origin::Piece)
            && !item.is_cut
            && runs_through(item, window)
    };
    let through: Vec<&Item> = items.iter().filter(is_open).collect();
    if through.len() < SEVERAL {
        return Ok(());
    }
    let named: Vec<_> = through.iter().take(3).map(|item| item.name(source)).collect();
    let more = if through.len() > named.len() { ", ..." } else { "" };
    let (why, advice) = if through.iter().any(|item| !has_plain_paints(item)) {
        (
            " with gradients or effects",
            "paint them in plain colours, or mark them data-arabesque=\"element\" to have them copied as they are",
        )
    } else {
        (
            ", which neither repeat nor are bands of one width",
            "show two whole periods of what repeats, draw bands as strokes, or mark them data-arabesque=\"element\" to have \
             them copied as they are",
        )
    };
    Err(Error::Unsupported {
        what: format!(
            "{}: going on with {} fills that run through the frame ({}{more}){why}",
            source.name,
            through.len(),
            named.join(", ")
        ),
        advice: advice.into(),
    })
}

/// Whether everything in an item is painted in plain colours.
fn has_plain_paints(item: &Item) -> bool {
    fn is_plain(node: &Node) -> bool {
        let is_colour = |paint: P| reference(node.style.get(paint)).is_none();
        match &node.content {
            Content::Group(children) => children.iter().all(|child| is_plain(child)),
            Content::Shape(_) => is_colour(P::Fill) && is_colour(P::Stroke),
        }
    }
    item.parts.iter().all(|(_, node)| is_plain(node))
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
pub(crate) fn is_plain_fill(item: &Item) -> bool {
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
