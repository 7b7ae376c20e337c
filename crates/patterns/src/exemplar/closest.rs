//! How close elements of two classes come in the exemplar.

use std::collections::BTreeMap;

use arabesque_core::{Budget, GridIndex, Numbered, Result, Vector};

/// Nanoseconds that comparing two elements takes.
const PAIR: u64 = 5;

/// Up to so many classes there is an entry for every pair; of more, only for those that come close.
const TABLE: usize = 512;

/// Smallest distances between the centres of two classes, as far as anybody looked.
#[derive(Clone, Debug)]
pub(crate) struct ClosestDistances {
    classes: usize,
    /// Row by row, where there are few classes.
    table: Vec<f64>,
    /// For each class those that come close, by number, where there are many.
    rows: Numbered<Vec<(u32, f64)>>,
    /// Largest entry of each row.
    widest: Numbered<f64>,
    /// As far as anybody looked: the distance of classes that never come closer.
    most: f64,
}

impl ClosestDistances {
    /// Looks at all pairs no farther apart than `most`.
    pub(crate) fn new<const D: usize>(
        centre: &[Vector<D>],
        class: &[u32],
        classes: usize,
        (all, most): (&GridIndex<D>, f64),
        budget: &Budget,
    ) -> Result<Self> {
        let mut known = BTreeMap::<(u32, u32), f64>::new();
        let mut table = if classes <= TABLE { vec![most; classes * classes] } else { Vec::new() };
        let mut meter = budget.meter();
        for (i, &p) in centre.iter().enumerate() {
            let looked = all.within(p, most, |j, offset| {
                if i == j {
                    return;
                }
                let entry = match table.get_mut(class[i] as usize * classes + class[j] as usize) {
                    Some(entry) => entry,
                    None => known.entry((class[i], class[j])).or_insert(most),
                };
                *entry = entry.min(offset.norm());
            });
            meter.spend(looked * PAIR)?;
        }
        let mut rows = Numbered::filled(Vec::new(), if classes <= TABLE { 0 } else { classes });
        for ((a, b), distance) in known {
            rows[a].push((b, distance));
        }
        let mut closest = Self { classes, table, rows, widest: Numbered::new(), most };
        closest.widest = (0..classes as u32).map(|a| closest.widest_of(a)).collect();
        Ok(closest)
    }

    fn widest_of(&self, a: u32) -> f64 {
        match self.rows.get(a as usize) {
            Some(row) if row.len() < self.classes => self.most,
            Some(row) => row.iter().map(|r| r.1).fold(0.0, f64::max),
            None => (0..self.classes as u32).map(|b| self.of(a, b)).fold(0.0, f64::max),
        }
    }

    /// Smallest distance of two classes.
    #[inline]
    pub(crate) fn of(&self, a: u32, b: u32) -> f64 {
        if let Some(known) = self.table.get(a as usize * self.classes + b as usize) {
            return *known;
        }
        let row = &self.rows[a];
        row.binary_search_by_key(&b, |r| r.0).map_or(self.most, |k| row[k].1)
    }

    /// Largest of the distances of a class.
    pub(crate) fn widest(&self, a: u32) -> f64 {
        self.widest[a]
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Bounds, Domain, Stage, Stream};

    use super::*;

    #[test]
    fn many_classes_have_the_distances_that_few_would_have() {
        let mut random = Stream::new(3, Stage::TEST, 0);
        let centre: Vec<_> = (0..900).map(|_| Vector::xy(random.range(0.0, 9.0), random.range(0.0, 9.0))).collect();
        let all = GridIndex::new(&centre, 0.5, &Domain::Box(Bounds::around(centre.iter().copied())));
        let class: Vec<u32> = (0..900).map(|_| random.below(600) as u32).collect();
        let closest = ClosestDistances::new(&centre, &class, 600, (&all, 0.7), &Budget::default()).unwrap();
        assert!(closest.table.is_empty());
        for a in 0..20 {
            let mut widest = 0.0_f64;
            for b in 0..600 {
                let class = &class;
                let pairs = (0..900).filter(|&i| class[i] == a).flat_map(|i| (0..900).map(move |j| (i, j)));
                let near = pairs.filter(|&(i, j)| class[j] == b && i != j).map(|(i, j)| (centre[i] - centre[j]).norm());
                let want = near.filter(|d| *d <= 0.7).fold(0.7, f64::min);
                assert_eq!(closest.of(a, b), want);
                widest = widest.max(want);
            }
            assert_eq!(closest.widest(a), widest);
        }
    }
}
