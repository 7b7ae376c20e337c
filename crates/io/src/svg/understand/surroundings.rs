//! What holds for everything inside a container of a drawing.

use std::rc::Rc;

use arabesque_core::Outline;
use kurbo::Affine;

use crate::svg::parse::meta::{Mark, Meta};

/// What holds for everything inside a container.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    /// From the parent to the root.
    pub(crate) parent: Affine,
    pub(crate) layer: Option<Rc<str>>,
    pub(crate) opacity: f64,
    pub(crate) clip: Option<Rc<Outline<2>>>,
    pub(crate) mark: Option<Mark>,
    /// Names of items that are left out.
    pub(crate) without: Rc<[String]>,
}

impl Surroundings {
    /// Nothing but the transform from the parent to the root.
    pub(crate) fn new(parent: Affine) -> Self {
        Self { parent, layer: None, opacity: 1.0, clip: None, mark: None, without: Rc::default() }
    }

    /// The same, except for the items of those names.
    pub(crate) fn without(self, names: &[String]) -> Self {
        Self { without: names.into(), ..self }
    }

    /// Whether something is left out by its name.
    pub(crate) fn excludes(&self, meta: &Meta) -> bool {
        let named = |name: &Option<String>| name.as_ref().is_some_and(|name| self.without.contains(name));
        named(&meta.id) || named(&meta.label)
    }
}
