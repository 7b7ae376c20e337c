//! The output while it is made: elements at places, quick to look up.

use arabesque_core::{Buckets, Domain, Numbered, Vector};

use crate::output::draft::Item;

/// Output elements with an index by place.
#[derive(Clone, Debug)]
pub(crate) struct Canvas<const D: usize> {
    pub(crate) items: Numbered<Item<D>>,
    buckets: Buckets<D>,
    domain: Domain<D>,
}

impl<const D: usize> Canvas<D> {
    pub(crate) fn new(domain: &Domain<D>, margin: f64, cell: f64) -> Self {
        Self { items: Numbered::new(), buckets: Buckets::new(domain, margin, cell), domain: domain.clone() }
    }

    pub(crate) fn push(&mut self, item: Item<D>) {
        let position = self.domain.wrap(item.position);
        self.buckets.insert(self.items.len() as u32, position);
        self.items.push(Item { position, ..item });
    }

    /// Calls `visit(i, offset)` for the items within `radius` of `p`. Returns how many items and cells were looked at.
    pub(crate) fn within(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(usize, Vector<D>)) -> u64 {
        self.buckets.near(p, radius, |i| {
            let offset = self.domain.offset(p, self.items[i].position);
            if offset.norm2() <= radius * radius {
                visit(i as usize, offset);
            }
        })
    }
}
