//! A list whose entries go by number.
//!
//! Elements, samples, nodes, lines and classes are numbers of 32 bits wherever they are stored, since there are many of
//! them in the inner loops. This list is looked up by such numbers, so that the conversion to a place in memory stands
//! here alone.

use std::ops::{Deref, DerefMut, Index, IndexMut};

/// What an entry may be looked up by.
pub trait Number {
    /// Place in the list.
    fn place(self) -> usize;
}

impl Number for u32 {
    #[inline]
    fn place(self) -> usize {
        self as usize
    }
}

impl Number for usize {
    #[inline]
    fn place(self) -> usize {
        self
    }
}

/// Entries by number, from 0 without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbered<T>(Vec<T>);

impl<T> Numbered<T> {
    /// A list without entries.
    pub const fn new() -> Self {
        Self(Vec::new())
    }

    /// The numbers of all entries.
    pub fn numbers(&self) -> std::ops::Range<u32> {
        0..self.0.len() as u32
    }

    /// Appends an entry, and returns its number.
    pub fn push(&mut self, entry: T) -> u32 {
        self.0.push(entry);
        self.0.len() as u32 - 1
    }

    /// Forgets all entries, keeping their memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl<T: Clone> Numbered<T> {
    /// `count` times the same entry.
    pub fn filled(entry: T, count: usize) -> Self {
        Self(vec![entry; count])
    }

    /// Sets the length and every entry, keeping the memory.
    pub fn refill(&mut self, entry: T, count: usize) {
        self.0.clear();
        self.0.resize(count, entry);
    }
}

impl<T> Default for Numbered<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> From<Vec<T>> for Numbered<T> {
    fn from(entries: Vec<T>) -> Self {
        Self(entries)
    }
}

impl<T> FromIterator<T> for Numbered<T> {
    fn from_iter<I: IntoIterator<Item = T>>(entries: I) -> Self {
        Self(entries.into_iter().collect())
    }
}

impl<T> Extend<T> for Numbered<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, entries: I) {
        self.0.extend(entries);
    }
}

impl<T> IntoIterator for Numbered<T> {
    type Item = T;
    type IntoIter = std::vec::IntoIter<T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a, T> IntoIterator for &'a Numbered<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut Numbered<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter_mut()
    }
}

impl<T> Deref for Numbered<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T> DerefMut for Numbered<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

impl<T, I: Number> Index<I> for Numbered<T> {
    type Output = T;

    #[inline]
    fn index(&self, number: I) -> &T {
        &self.0[number.place()]
    }
}

impl<T, I: Number> IndexMut<I> for Numbered<T> {
    #[inline]
    fn index_mut(&mut self, number: I) -> &mut T {
        &mut self.0[number.place()]
    }
}
