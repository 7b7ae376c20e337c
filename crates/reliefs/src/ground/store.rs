//! The result while it grows: points in buckets of a regular grid, put in and taken out.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Vector};

use crate::sample::Sample;

/// Points by the cell they lie in.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    cell: f64,
    cells: BTreeMap<[i32; 3], Vec<Sample>>,
    count: usize,
}

impl Store {
    pub(crate) fn new(cell: f64) -> Self {
        Self { cell, cells: BTreeMap::new(), count: 0 }
    }

    fn of(&self, p: Vector<3>) -> [i32; 3] {
        // A cast of what is too large gives the largest number.
        p.0.map(|v| (v / self.cell).floor() as i32)
    }

    pub(crate) fn len(&self) -> usize {
        self.count
    }

    pub(crate) fn insert(&mut self, sample: Sample) {
        let cell = self.of(sample.at);
        self.cells.entry(cell).or_default().push(sample);
        self.count += 1;
    }

    /// All points, cell by cell.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Sample> {
        self.cells.values().flatten()
    }

    /// All points in the same order; what they lay in is let go cell by cell.
    pub(crate) fn into_all(self) -> impl Iterator<Item = Sample> {
        self.cells.into_values().flatten()
    }

    /// The keys of the cells that meet a box and hold points.
    fn meeting(&self, bounds: &Bounds<3>) -> Vec<[i32; 3]> {
        let (low, high) = (self.of(bounds.min), self.of(bounds.max));
        let mut keys = Vec::new();
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                keys.extend(self.cells.range([x, y, low[2]]..=[x, y, high[2]]).map(|(key, _)| *key));
            }
        }
        keys
    }

    /// Calls `visit` for the points in a box.
    pub(crate) fn within(&self, bounds: &Bounds<3>, mut visit: impl FnMut(&Sample)) {
        for key in self.meeting(bounds) {
            let bucket = self.cells.get(&key).map_or(&[][..], Vec::as_slice);
            bucket.iter().filter(|s| bounds.contains(s.at)).for_each(&mut visit);
        }
    }

    /// Takes the points out of a box for which `goes` holds.
    pub(crate) fn remove(&mut self, bounds: &Bounds<3>, mut goes: impl FnMut(&mut Sample) -> bool) {
        for key in self.meeting(bounds) {
            let Some(bucket) = self.cells.get_mut(&key) else { continue };
            let before = bucket.len();
            bucket.retain_mut(|s| !(bounds.contains(s.at) && goes(s)));
            self.count -= before - bucket.len();
            if bucket.is_empty() {
                self.cells.remove(&key);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_found_and_taken_out_where_they_are() {
        let mut store = Store::new(0.7);
        for k in 0..125_u32 {
            let at = Vector([f64::from(k % 5) - 2.0, f64::from(k / 5 % 5) - 2.0, f64::from(k / 25) - 2.0]);
            let normal = Vector([0.0, 0.0, 1.0]);
            store.insert(Sample { at, normal, source: k, ..Sample::default() });
        }
        let bounds = Bounds::new(Vector::splat(-1.0), Vector::splat(1.0));
        let mut found = 0;
        store.within(&bounds, |s| found += usize::from(bounds.contains(s.at)));
        assert_eq!((found, store.len()), (27, 125));
        store.remove(&bounds, |s| s.at[2] > 0.5);
        assert_eq!(store.len(), 116);
        assert_eq!(store.all().filter(|s| bounds.contains(s.at)).count(), 18);
    }
}
