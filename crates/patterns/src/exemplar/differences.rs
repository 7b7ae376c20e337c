//! Differences of the attributes of elements, worked out once.
//!
//! Two elements of one class are compared for every pair of every neighbourhood that is priced. Most exemplars have few elements that
//! differ, or few elements; then a table answers. Where there are too many, their attributes are compared each time.

use std::collections::BTreeMap;

use arabesque_core::Numbered;

use crate::exemplar::features::Feature;

/// Most entries of the table.
const MOST: usize = 1 << 21;

/// No row of the table.
const NONE: u32 = u32::MAX;

/// How elements of one class differ.
#[derive(Clone, Debug)]
pub(crate) struct Differences {
    feature: Numbered<Feature>,
    /// Which of the different ones of its class each element is.
    column: Numbered<u32>,
    /// Where the row of each element starts.
    row: Numbered<u32>,
    table: Vec<f32>,
}

impl Differences {
    /// Compares the members of each class.
    pub(crate) fn new<'m>(feature: Numbered<Feature>, classes: impl Iterator<Item = &'m [u32]>) -> Self {
        let mut column = Numbered::filled(0, feature.len());
        let mut row = Numbered::filled(NONE, feature.len());
        let mut table: Vec<f32> = Vec::new();
        for members in classes {
            let mut known = BTreeMap::new();
            let mut shown: Vec<u32> = Vec::new();
            for &e in members {
                column[e] = *known.entry(feature[e].key()).or_insert_with(|| {
                    shown.push(e);
                    shown.len() as u32 - 1
                });
            }
            if table.len() + shown.len() * shown.len() > MOST {
                continue;
            }
            let start = table.len();
            for a in &shown {
                table.extend(shown.iter().map(|b| feature[*a].distance2(&feature[*b])));
            }
            members.iter().for_each(|&e| row[e] = start as u32 + column[e] * shown.len() as u32);
        }
        Self { feature, column, row, table }
    }

    /// Where an element stands among those of its class, for [`Differing::at`].
    pub(crate) fn column(&self, e: u32) -> u32 {
        self.column[e]
    }

    /// An element, ready to be compared with others of its class.
    #[inline]
    pub(crate) fn from(&self, a: u32) -> Differing<'_> {
        let row = self.row[a];
        Differing { differences: self, element: a, row: if row == NONE { &[] } else { &self.table[row as usize..] } }
    }

    /// Squared difference of the attributes of two elements of one class.
    #[inline]
    pub(crate) fn of(&self, a: u32, b: u32) -> f32 {
        let row = self.row[a];
        if row == NONE {
            return self.feature[a].distance2(&self.feature[b]);
        }
        self.table[(row + self.column[b]) as usize]
    }
}

/// One element with its row of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Differing<'a> {
    differences: &'a Differences,
    element: u32,
    /// Empty where there is none.
    row: &'a [f32],
}

impl Differing<'_> {
    /// What [`Differences::of`] says of it and another.
    #[inline]
    pub(crate) fn of(&self, other: u32) -> f32 {
        self.at(self.differences.column[other], || other)
    }

    /// The same where it is known in which [column](Differences::column) the other is; without a table, `other` is asked for.
    #[inline]
    pub(crate) fn at(&self, column: u32, other: impl FnOnce() -> u32) -> f32 {
        match self.row.get(column as usize) {
            Some(&known) => known,
            None => self.differences.of(self.element, other()),
        }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Element, Outline, Role, Similarity, Vector};

    use super::*;

    fn features(sizes: &[f64]) -> Numbered<Feature> {
        let of = |&size: &f64| {
            let ring = [(0.0, 0.0), (size, 0.0), (0.0, size)].map(|(x, y)| Vector::xy(x, y)).to_vec();
            let element = Element {
                class: 0,
                centre: Vector::ZERO,
                pose: Similarity::identity(),
                outline: Outline { rings: vec![ring] },
                colour: [0.0; 3],
                lean: [Vector::ZERO; 3],
                role: Role::Source,
            };
            Feature::of(&element, 1.0)
        };
        sizes.iter().map(of).collect()
    }

    #[test]
    fn the_table_says_what_a_comparison_would() {
        let feature = features(&[1.0, 2.0, 1.0, 5.0, 3.0, 1.5]);
        let classes: [&[u32]; 2] = [&[0, 2, 5, 1], &[3, 4]];
        let differences = Differences::new(feature.clone(), classes.into_iter());
        assert_eq!(differences.table.len(), 3 * 3 + 2 * 2);
        for members in classes {
            for (&a, &b) in members.iter().flat_map(|a| members.iter().map(move |b| (a, b))) {
                assert_eq!(differences.of(a, b), feature[a].distance2(&feature[b]));
                assert_eq!(differences.from(a).of(b), differences.of(a, b));
            }
        }
    }

    #[test]
    fn of_too_many_different_ones_each_pair_is_compared() {
        let feature = features(&(0..1500).map(f64::from).collect::<Vec<_>>());
        let members: Vec<u32> = (0..1500).collect();
        let differences = Differences::new(feature.clone(), [&members[..]].into_iter());
        assert!(differences.table.is_empty());
        assert_eq!(differences.of(3, 1400), feature[3_u32].distance2(&feature[1400_u32]));
        assert_eq!(differences.from(3).of(1400), differences.of(3, 1400));
    }
}
