//! The output between two levels: items at places, and the edges that are known.

use arabesque_core::{Matrix, Vector};

/// One output element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Item<const D: usize> {
    /// Exemplar element drawn here.
    pub(crate) source: u32,
    /// Its centre.
    pub(crate) position: Vector<D>,
    /// What the user placed here, which must not change.
    pub(crate) frozen: Option<Frozen>,
}

/// What the user placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frozen {
    /// An element: index into the frozen placements of the request.
    Element(u32),
    /// A sample of one of the frozen curves.
    Stroke,
}

/// Items with their turns.
pub(crate) type Items<const D: usize> = Vec<(Item<D>, Matrix<D>)>;

/// What is handed from level to level.
#[derive(Clone, Debug)]
pub(crate) struct Draft<const D: usize> {
    pub(crate) items: Items<D>,
    /// Pairs of items, curve samples both, that an edge joins.
    pub(crate) links: Vec<(u32, u32)>,
}

impl<const D: usize> Default for Draft<D> {
    fn default() -> Self {
        Self { items: Vec::new(), links: Vec::new() }
    }
}
