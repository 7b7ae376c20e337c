//! Items: what the selection takes for one element, one set of strokes, or too large a fill, and how items are put
//! together.

use std::rc::Rc;

use arabesque_core::{Bounds, Budget, FillRule, Outline, Result};
use kurbo::Affine;

use crate::svg::{
    centreline::Centrelines,
    parse::{
        definitions::RepeatedGradient,
        meta::Meta,
        notes::Note,
        scene::{Content, Node},
        source::Source,
        style::Property as P,
    },
    reason::Reason,
    shape::{
        extent::{SoleShape, bounds, longer, sole_shape},
        flatten,
        painted_area::{PaintedArea, Painter},
    },
    understand::{compound::Compound, surroundings::Surroundings},
};

/// Share of the frame from which on something is too large for an element.
pub(crate) const HALF: f64 = 0.5;

/// What a selected item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// To be placed as a whole.
    Element,
    /// Strokes of a net, or marked as curves.
    Curve,
    /// A fill larger than half of the frame that is not a background.
    Large,
    /// A fill that runs through the frame, to be continued as it repeats.
    Area,
}

/// How an item came to be, which decides what it may be joined with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A group, `<use>`, anything marked by hand, or what was put together: never joined.
    Whole,
    /// A single filled shape.
    Fill,
    /// A single shape without a fill.
    Stroke,
    /// A piece of a compound path.
    Piece,
}

/// A selected item.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    /// What draws it: nodes with the transforms from their parents to the root.
    pub(crate) parts: Vec<(Affine, Rc<Node>)>,
    pub(crate) meta: Rc<Meta>,
    pub(crate) layer: Option<Rc<str>>,
    /// Opacity of the containers around it.
    pub(crate) opacity: f64,
    pub(crate) outline: Outline<2>,
    pub(crate) painted: PaintedArea,
    pub(crate) kind: Kind,
    pub(crate) origin: Origin,
    /// Why it was taken for that.
    pub(crate) reason: Reason,
    /// The lines whose outline it is, where it was found to be one.
    pub(crate) lines: Option<Rc<Centrelines>>,
    /// What the clips of the containers around it leave visible.
    pub(crate) clip: Option<Rc<Outline<2>>>,
    /// Whether that takes something away from it.
    pub(crate) is_cut: bool,
    /// What is painted over it and hides what lies below, where it is one of a stack.
    pub(crate) hidden: Option<Rc<Outline<2>>>,
    /// The gradient that paints it, and all like it, where it is an area.
    pub(crate) gradient: Option<Rc<RepeatedGradient>>,
    /// The compound path that it is made of, and which pieces of it, where these are several.
    pub(crate) compound: Option<(Rc<Compound>, Vec<usize>)>,
}

impl Item {
    /// A node as a whole; `None`, with a note, where nothing of it is seen.
    pub(crate) fn taken(
        painter: &Painter<'_, '_>,
        node: &Rc<Node>,
        at: &Surroundings,
        taken: (Kind, Origin, Reason),
    ) -> Result<Option<Self>> {
        let (kind, origin, reason) = taken;
        let budget = painter.source.budget;
        let painted = painter.painted(node, at.parent)?;
        let mut item = Self {
            parts: vec![(at.parent, Rc::clone(node))],
            meta: named(node),
            layer: at.layer.clone(),
            opacity: at.opacity,
            outline: painted.outline(budget)?,
            painted,
            kind,
            origin,
            reason,
            lines: None,
            clip: at.clip.clone(),
            is_cut: false,
            hidden: None,
            gradient: None,
            compound: None,
        };
        if let Some(clip) = &at.clip {
            let before = item.outline.area();
            item.outline = item.outline.try_intersection(clip, budget)?;
            item.is_cut = item.outline.area() < 0.999 * before;
        }
        let is_seen = !item.outline.rings.is_empty() && longer(&item.outline.bounds()) > painter.source.limits.extent;
        if !is_seen {
            item.note_unseen(painter);
        }
        Ok(is_seen.then_some(item))
    }

    /// Some pieces of a compound path.
    ///
    /// # Errors
    /// As [`Painter::painted`].
    pub(crate) fn of_pieces(
        compound: &Rc<Compound>,
        painter: &Painter<'_, '_>,
        which: Vec<usize>,
        frame: Bounds<2>,
    ) -> Result<Option<Self>> {
        let node = Rc::new(compound.node(&which));
        let share = bounds(&node, compound.context.parent).measure() / frame.measure();
        let (kind, reason) = size_of_fill(share, Reason::Piece);
        let item = Self::taken(painter, &node, &compound.context, (kind, Origin::Piece, reason))?;
        let compound = (which.len() > 1).then(|| (Rc::clone(compound), which));
        Ok(item.map(|item| Self { compound, ..item }))
    }

    /// The items of a group as one.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub(crate) fn merged(items: &[Self], group: &[usize], frame: Bounds<2>, budget: &Budget) -> Result<Self> {
        let mut all = items[group[0]].clone();
        if group.len() == 1 {
            return Ok(all);
        }
        for &i in &group[1..] {
            all.parts.extend(items[i].parts.iter().map(|(t, n)| (*t, Rc::clone(n))));
            all.painted.append(items[i].painted.clone());
            all.is_cut |= items[i].is_cut;
        }
        all.compound = None;
        let rings: Vec<_> = group.iter().flat_map(|&i| items[i].outline.rings.iter().cloned()).collect();
        all.outline = Outline::try_union(&rings, FillRule::NonZero, budget)?;
        let strokes = group.iter().any(|&i| items[i].kind == Kind::Curve);
        let large = all.outline.bounds().measure() >= 0.5 * frame.measure();
        all.kind = match (strokes, large) {
            (true, _) => Kind::Curve,
            (false, true) => Kind::Large,
            (false, false) => Kind::Element,
        };
        Ok(all)
    }

    /// Its outline as finely as the border of a domain is drawn: areas are drawn again from it, elements as they are in the file.
    ///
    /// # Errors
    /// As [`Outline::try_union`].
    pub(crate) fn fine_outline(&self, painter: &Painter<'_, '_>) -> Result<Outline<2>> {
        let budget = painter.source.budget;
        let mut rings = Vec::new();
        for (parent, node) in &self.parts {
            if !push_fine(painter, node, *parent, &mut rings)? {
                return Ok(self.outline.clone());
            }
        }
        let whole = Outline::try_union(&rings, FillRule::NonZero, budget)?;
        match &self.clip {
            Some(clip) => whole.try_intersection(clip, budget),
            None => Ok(whole),
        }
    }

    /// What messages call it: its label or id, else its place in the file.
    pub(crate) fn name(&self, source: &Source<'_>) -> String {
        let meta = &self.meta;
        let own = meta.label.as_ref().or(meta.id.as_ref()).map(|n| format!("\"{n}\""));
        let line = || source.xml.get_node(meta.xml).map(|xml| source.line(&xml));
        own.unwrap_or_else(|| format!("<{}> in line {}", meta.tag, line().unwrap_or(1)))
    }

    /// Says why nothing of it is seen.
    fn note_unseen(&self, painter: &Painter<'_, '_>) {
        let name = || self.meta.id.clone().unwrap_or_default();
        if self.parts.iter().any(|(_, node)| node.style.has_no_width()) {
            painter.source.notes.add(Note::NoWidth, name);
        }
        let is_drawn = self.parts.iter().any(|(parent, node)| !bounds(node, *parent).is_empty());
        if is_drawn && !self.is_cut {
            painter.source.notes.add(Note::ZeroSize, name);
        }
    }
}

/// What a fill is by its share of the frame.
pub(crate) fn size_of_fill(share: f64, small: Reason) -> (Kind, Reason) {
    if share < HALF { (Kind::Element, small) } else { (Kind::Large, Reason::Large) }
}

/// Adds what a node fills, as rings that turn alike; false where something else takes part in how it looks.
fn push_fine(
    painter: &Painter<'_, '_>,
    node: &Node,
    parent: Affine,
    rings: &mut Vec<arabesque_core::Ring<2>>,
) -> Result<bool> {
    let world = parent * node.transform;
    if painter.clip(node, world)?.is_some() {
        return Ok(false);
    }
    match &node.content {
        Content::Shape(geometry) => {
            let rule = flatten::fill_rule(node.style.get(P::FillRule));
            let path = world * geometry.path.clone();
            rings.extend(flatten::filled_finely(&path, rule, painter.source.budget)?.rings);
        }
        Content::Group(children) => {
            for child in children {
                if !push_fine(painter, child, world, rings)? {
                    return Ok(false);
                }
            }
        }
    }
    Ok(true)
}

/// The names of a node, completed by those of the only shape in it.
fn named(node: &Rc<Node>) -> Rc<Meta> {
    match sole_shape(node, Affine::IDENTITY) {
        Some(SoleShape { leaf, .. }) if !Rc::ptr_eq(leaf, node) => {
            let (outer, inner) = (&*node.meta, &*leaf.meta);
            Rc::new(Meta {
                class: outer.class.clone().or_else(|| inner.class.clone()),
                label: outer.label.clone().or_else(|| inner.label.clone()),
                kind: outer.kind.clone().or_else(|| inner.kind.clone()),
                shows: outer.shows.clone().or_else(|| inner.shows.clone()),
                ..outer.clone()
            })
        }
        _ => Rc::clone(&node.meta),
    }
}

/// Everything selected from a drawing.
#[derive(Debug, Default)]
pub(crate) struct Selection {
    pub(crate) items: Vec<Item>,
    pub(crate) background: Vec<(Affine, Rc<Node>)>,
    /// What is no part of the pattern: why, its name, its outline.
    pub(crate) left_out: Vec<(Reason, String, Outline<2>)>,
}
