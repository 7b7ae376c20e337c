//! What holds for everything inside a container of a drawing.

use std::rc::Rc;

use arabesque_core::Outline;
use kurbo::Affine;

use super::meta::{Mark, Meta};

/// What holds for everything inside a container.
#[derive(Clone, Debug)]
pub(super) struct Context {
    /// From the parent to the root.
    pub(super) parent: Affine,
    pub(super) layer: Option<Rc<str>>,
    pub(super) opacity: f64,
    pub(super) clip: Option<Rc<Outline<2>>>,
    pub(super) mark: Option<Mark>,
    /// Names of items that are left out.
    pub(super) without: Rc<[String]>,
}

impl Context {
    /// Nothing but the transform from the parent to the root.
    pub(super) fn new(parent: Affine) -> Self {
        Self { parent, layer: None, opacity: 1.0, clip: None, mark: None, without: Rc::default() }
    }

    /// The same, but for the items of those names.
    pub(super) fn without(self, names: &[String]) -> Self {
        Self { without: names.into(), ..self }
    }

    /// Whether something is left out by its name.
    pub(super) fn excludes(&self, meta: &Meta) -> bool {
        let named = |name: &Option<String>| name.as_ref().is_some_and(|name| self.without.contains(name));
        named(&meta.id) || named(&meta.label)
    }
}
