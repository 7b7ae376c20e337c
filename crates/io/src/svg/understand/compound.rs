//! A compound path and its connected pieces: those that a fill has, or the subpaths of a stroke.

use std::{ops::Range, rc::Rc};

use arabesque_core::{Bounds, Result};
use kurbo::BezPath;

use crate::svg::{
    parse::{
        geometry::Geometry,
        meta::Meta,
        notes::Note,
        paint::fraction,
        scene::{Content, Node},
        style::Property as P,
    },
    shape::{
        extent::{SoleShape, bounds},
        flatten,
        painted_area::Painter,
    },
    understand::{
        pieces::{self, Piece},
        surroundings::Surroundings,
    },
};

/// A path of several pieces.
#[derive(Debug)]
pub(crate) struct Compound {
    /// The shape without its own clip and without the groups around it.
    bare: Node,
    /// What these and the containers around them do.
    pub(crate) context: Surroundings,
    pub(crate) pieces: Vec<Piece>,
    /// Which elements of the path each subpath is.
    subpaths: Vec<Range<usize>>,
    /// Box around each piece.
    pub(crate) boxes: Vec<Bounds<2>>,
    /// Name of a group around it whose effects its pieces go without.
    effects: Option<String>,
}

impl Compound {
    /// The compound path that a node is or wraps; `None` where it has one piece only or is too tangled, with a note, to
    /// be taken apart.
    ///
    /// # Errors
    /// As for clips that cannot be read.
    pub(crate) fn new(
        painter: &Painter<'_, '_>,
        node: &Rc<Node>,
        only: &SoleShape<'_>,
        at: &Surroundings,
    ) -> Result<Option<Self>> {
        let leaf = only.leaf;
        let Content::Shape(geometry) = &leaf.content else { return Ok(None) };
        if geometry.path.subpaths().count() < 2 {
            return Ok(None);
        }
        let rule = flatten::fill_rule(leaf.style.get(P::FillRule));
        let Some(pieces) = pieces::pieces(&geometry.path, rule, painter.source.budget)? else {
            painter.source.notes.add(Note::TooTangled, || node.meta.id.clone().unwrap_or_default());
            return Ok(None);
        };
        Self::of(painter, node, only, at, pieces)
    }

    /// The subpaths of a stroke that a node is or wraps, each a piece; `None` where there is one only.
    ///
    /// # Errors
    /// As for clips that cannot be read.
    pub(crate) fn of_stroke(
        painter: &Painter<'_, '_>,
        node: &Rc<Node>,
        only: &SoleShape<'_>,
        at: &Surroundings,
    ) -> Result<Option<Self>> {
        let Content::Shape(geometry) = &only.leaf.content else { return Ok(None) };
        let pieces = (0..geometry.path.subpaths().count()).map(|k| Piece { subpaths: vec![k], within: None });
        Self::of(painter, node, only, at, pieces.collect())
    }

    fn of(
        painter: &Painter<'_, '_>,
        node: &Rc<Node>,
        only: &SoleShape<'_>,
        at: &Surroundings,
        pieces: Vec<Piece>,
    ) -> Result<Option<Self>> {
        let &SoleShape { leaf, parent } = only;
        let Content::Shape(geometry) = &leaf.content else { return Ok(None) };
        if pieces.len() < 2 {
            return Ok(None);
        }
        let mut context = at.clone();
        let effects = unwrap(painter, node, leaf, &mut context)?;
        context.parent = parent;
        let nameless = Meta { class: None, label: None, kind: None, shows: None, ..(*leaf.meta).clone() };
        let bare = Node { own: leaf.own.without("clip-path"), meta: Rc::new(nameless), ..(**leaf).clone() };
        let subpaths = geometry.path.subpaths().scan(0, |at, elements| {
            let from = std::mem::replace(at, *at + elements.len());
            Some(from..*at)
        });
        let subpaths = subpaths.collect();
        let mut compound = Self { bare, context, pieces, subpaths, boxes: Vec::new(), effects };
        let box_of = |k: usize| bounds(&compound.node(&[k]), parent);
        compound.boxes = (0..compound.pieces.len()).map(box_of).collect();
        Ok(Some(compound))
    }

    /// All its pieces.
    pub(crate) fn all(self: Rc<Self>) -> (Rc<Self>, Vec<usize>) {
        let all = (0..self.pieces.len()).collect();
        (self, all)
    }

    /// What draws some of the pieces.
    pub(crate) fn node(&self, which: &[usize]) -> Node {
        let Content::Shape(geometry) = &self.bare.content else { return self.bare.clone() };
        let subpaths = which.iter().flat_map(|&k| &self.pieces[k].subpaths);
        let ranges = subpaths.filter_map(|&k| self.subpaths.get(k).cloned());
        let elements = ranges.filter_map(|range| geometry.path.elements().get(range)).flatten();
        let chosen = Geometry::from_path(BezPath::from_vec(elements.copied().collect()));
        Node { content: Content::Shape(Rc::new(chosen)), ..self.bare.clone() }
    }

    /// Notes what is lost when its pieces become separate.
    pub(crate) fn note_losses(&self, painter: &Painter<'_, '_>) {
        let notes = &painter.source.notes;
        let painted = if self.bare.style.fills() { P::Fill } else { P::Stroke };
        if self.bare.style.get(painted).starts_with("url(") {
            notes.add(Note::SplitGradient, || self.bare.meta.id.clone().unwrap_or_default());
        }
        if let Some(name) = &self.effects {
            notes.add(Note::ContainerEffect, || name.clone());
        }
    }
}

/// Puts what a shape's clip and the groups around it do into the context; the name of a group whose effects are lost.
fn unwrap(
    painter: &Painter<'_, '_>,
    node: &Rc<Node>,
    leaf: &Rc<Node>,
    inside: &mut Surroundings,
) -> Result<Option<String>> {
    let mut effects = None;
    let mut at = node;
    let mut world = inside.parent;
    loop {
        world *= at.transform;
        if let Some(clip) = painter.clip(at, world)? {
            let both = match &inside.clip {
                Some(outer) => outer.try_intersection(&clip, painter.source.budget)?,
                None => clip,
            };
            inside.clip = Some(Rc::new(both));
        }
        if Rc::ptr_eq(at, leaf) {
            return Ok(effects);
        }
        inside.opacity *= at.own.get("opacity").map_or(1.0, fraction);
        if at.own.has_effects() {
            effects = Some(at.meta.id.clone().unwrap_or_default());
        }
        let [child] = at.children() else { return Ok(effects) };
        at = child;
    }
}
