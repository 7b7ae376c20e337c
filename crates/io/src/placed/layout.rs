//! The elements of a result as its file has them, and what changes about them.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Bounds, Budget, Result, Similarity, Vector};

/// One element of a result.
#[derive(Clone, Debug, PartialEq)]
pub struct Item<const D: usize> {
    /// Its number, which it keeps while others come and go.
    pub id: usize,
    /// Index into [`Layout::classes`].
    pub class: usize,
    /// Which element of the exemplar it is a copy of, where the file says so.
    pub source: Option<usize>,
    /// From the coordinates of what it is a copy of to those of the page.
    pub place: Similarity<D>,
    /// Its centre, in the coordinates of the page.
    pub centre: Vector<D>,
    /// How far it reaches from its centre; 0 where the file does not say.
    pub reach: f64,
    /// Whether it is one that the user placed.
    pub kept: bool,
}

/// The elements of a result, in the order in which they are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout<const D: usize> {
    /// Each with a number of its own.
    pub items: Vec<Item<D>>,
    /// Names of the classes.
    pub classes: Vec<String>,
    /// The page, or the box around all of it.
    pub frame: Bounds<D>,
    /// Whether opposite sides of the page meet.
    pub is_tile: bool,
    /// Whether the file can say how elements are turned and scaled.
    pub turns: bool,
    /// Whether the file can say how they are painted.
    pub paints: bool,
    /// The number that the next new element gets.
    pub next: usize,
}

impl<const D: usize> Layout<D> {
    /// The element with that number.
    pub fn item(&self, id: usize) -> Option<&Item<D>> {
        // Numbers are places in the list until elements go.
        self.items.get(id).filter(|item| item.id == id).or_else(|| self.items.iter().find(|item| item.id == id))
    }

    /// Index of each element by its number.
    pub(crate) fn numbers(&self) -> BTreeMap<usize, usize> {
        self.items.iter().enumerate().map(|(n, item)| (item.id, n)).collect()
    }
}

/// A property of the paint and its new value.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Paint {
    /// `fill`, `stroke`, `stroke-width`, `opacity`, `fill-opacity` or `stroke-opacity`.
    pub property: String,
    /// The value, as the file has it.
    pub value: String,
}

/// What an element is from now on: `base`, moved, and painted.
#[derive(Clone, Debug, PartialEq)]
pub struct Replaced<const D: usize> {
    /// Number of the element that it is a copy of; most often itself.
    pub base: usize,
    /// From where `base` is, in the coordinates of the page.
    pub motion: Similarity<D>,
    /// What is painted in another way.
    pub paint: Vec<Paint>,
}

/// What changes in a file. All that is not named stays to the last bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes<const D: usize> {
    /// Elements that are replaced, by number.
    pub replaced: BTreeMap<usize, Replaced<D>>,
    /// Elements that are removed.
    pub removed: BTreeSet<usize>,
    /// Elements that are new, with their numbers.
    pub inserted: Vec<(usize, Replaced<D>)>,
}

/// A file of placed elements.
pub trait PlacedFile<const D: usize>: std::fmt::Debug + Send + Sync {
    /// The elements.
    fn layout(&self) -> &Layout<D>;

    /// The file with these changes, and with another recipe where it has one.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Input`] for changes of elements that are not there, [`arabesque_core::Error::Unsupported`] for what the
    /// file cannot say, [`arabesque_core::Error::Limit`] when the work is used up.
    fn rewritten(&self, changes: &Changes<D>, recipe: Option<&str>, budget: &Budget) -> Result<Vec<u8>>;
}

/// Work for one element that is read or written.
pub(crate) const PER_ITEM: u64 = 2000;
/// Work for each byte of a file.
pub(crate) const PER_BYTE: u64 = 10;
