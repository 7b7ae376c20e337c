//! What the selection finds.

use std::rc::Rc;

use arabesque_core::{Outline, Result};
use kurbo::Affine;

use crate::svg::{
    centreline::Centrelines,
    parse::{meta::Meta, notes::Note, scene::Node},
    shape::{
        extent::{bounds, longer, sole_shape},
        painted_area::{Ink, Inker},
    },
    understand::{compound::Compound, surroundings::Context},
};

/// What a selected item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// To be placed as a whole.
    Element,
    /// An open stroke, a closed one too large for an element or of the same net, or one marked as curve.
    Curve,
    /// A fill larger than half of the frame that is no background.
    Large,
}

/// How an item came to be, which decides what it may be joined with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A group, `<use>`, or anything marked by hand: never joined.
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
    pub(crate) ink: Ink,
    pub(crate) kind: Kind,
    pub(crate) origin: Origin,
    /// The lines whose outline it is, where it was found to be one.
    pub(crate) lines: Option<Rc<Centrelines>>,
    /// What the clips of the containers around it leave visible.
    pub(crate) clip: Option<Rc<Outline<2>>>,
    /// Whether that takes something away from it.
    pub(crate) is_cut: bool,
    /// The compound path that it is made of, and which pieces of it, where these are several.
    pub(crate) compound: Option<(Rc<Compound>, Vec<usize>)>,
}

impl Item {
    /// A node as a whole; `None`, with a note, where nothing of it is seen.
    pub(crate) fn taken(
        inker: &Inker<'_, '_>,
        node: &Rc<Node>,
        at: &Context,
        kind: Kind,
        origin: Origin,
    ) -> Result<Option<Self>> {
        let ink = inker.ink(node, at.parent)?;
        let mut item = Self {
            parts: vec![(at.parent, Rc::clone(node))],
            meta: named(node),
            layer: at.layer.clone(),
            opacity: at.opacity,
            outline: ink.outline(),
            ink,
            kind,
            origin,
            lines: None,
            clip: at.clip.clone(),
            is_cut: false,
            compound: None,
        };
        if let Some(clip) = &at.clip {
            let before = item.outline.area();
            item.outline = item.outline.intersection(clip);
            item.is_cut = item.outline.area() < 0.999 * before;
        }
        let is_seen = !item.outline.rings.is_empty() && longer(&item.outline.bounds()) > inker.source.limits.extent;
        if !is_seen {
            item.note_unseen(inker);
        }
        Ok(is_seen.then_some(item))
    }

    /// Says why nothing of it is seen.
    fn note_unseen(&self, inker: &Inker<'_, '_>) {
        let name = || self.meta.id.clone().unwrap_or_default();
        if self.parts.iter().any(|(_, node)| node.style.has_no_width()) {
            inker.source.notes.add(Note::NoWidth, name);
        }
        let is_drawn = self.parts.iter().any(|(parent, node)| !bounds(node, *parent).is_empty());
        if is_drawn && !self.is_cut {
            inker.source.notes.add(Note::ZeroSize, name);
        }
    }
}

/// The names of a node, completed by those of the only shape in it.
fn named(node: &Rc<Node>) -> Rc<Meta> {
    match sole_shape(node, Affine::IDENTITY) {
        Some((leaf, _)) if !Rc::ptr_eq(leaf, node) => {
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
}
