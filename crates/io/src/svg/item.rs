//! What the selection finds.

use std::rc::Rc;

use arabesque_core::Outline;
use kurbo::Affine;

use super::{ink::Ink, meta::Meta, scene::Node};
use crate::centreline::Centrelines;

/// What a selected item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// To be placed as a whole.
    Element,
    /// An open stroke, a closed one too large for an element or of the same net, or one marked as curve.
    Curve,
    /// A fill larger than half of the frame that is no background.
    Large,
}

/// How an item came to be, which decides what it may be joined with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
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
pub(super) struct Item {
    /// What draws it: nodes with the transforms from their parents to the root.
    pub(super) parts: Vec<(Affine, Rc<Node>)>,
    pub(super) meta: Rc<Meta>,
    pub(super) layer: Option<Rc<str>>,
    /// Opacity of the containers around it.
    pub(super) opacity: f64,
    pub(super) outline: Outline<2>,
    pub(super) ink: Ink,
    pub(super) kind: Kind,
    pub(super) origin: Origin,
    /// The lines whose outline it is, where it was found to be one.
    pub(super) lines: Option<Rc<Centrelines>>,
    /// What the clips of the containers around it leave visible.
    pub(super) clip: Option<Rc<Outline<2>>>,
    /// Whether that takes something away from it.
    pub(super) is_cut: bool,
}

/// Everything selected from a drawing.
#[derive(Debug, Default)]
pub(super) struct Selection {
    pub(super) items: Vec<Item>,
    pub(super) background: Vec<(Affine, Rc<Node>)>,
}
