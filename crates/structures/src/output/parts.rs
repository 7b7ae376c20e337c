//! Parts that touch and stay apart: which points of the output are of one part.
//!
//! Neighbours are of one part when the windows that see both see them as of one part of the exemplar. A single pair may be seen wrongly, which
//! would join two parts or tear one: pairs that are beyond doubt make pieces, and pieces are joined by what all pairs between them say.

use std::collections::{BTreeMap, HashMap};

use arabesque_core::{DisjointSets, Vector};

use crate::exemplar::pattern::Pattern;

/// Points of one part are no farther apart than this, in spacings.
pub(super) const REACH: f64 = 2.2;
/// Share of the votes by which a pair is of one part beyond doubt.
const SURE: f64 = 0.85;
/// Share of the votes between two pieces by which they are one.
const JOINED: f64 = 0.1;
/// No part is larger than the largest of the exemplar by more than this factor, where its parts end.
const LARGEST: f64 = 1.2;
/// Parts that are longer than this share of the exemplar may go on without an end.
const ENDLESS: f64 = 0.6;

/// A pair of neighbours: how much those say who see both as of one part, less the others, and all of them.
pub(super) type Pair = (usize, usize, f64, f64);

/// The parts of the exemplar: points near each other that have one number.
pub(super) struct Parts {
    /// For each point its part.
    pub(super) of: Vec<usize>,
    /// Points of the largest, where parts end within the exemplar.
    most: Option<f64>,
}

impl Parts {
    /// Of points with these numbers.
    pub(super) fn new<const D: usize>(pattern: &Pattern<D>, groups: &[i32]) -> Self {
        let mut sets = DisjointSets::new(groups.len());
        for (i, &p) in pattern.points.positions.iter().enumerate() {
            pattern.index.within(p, REACH * pattern.spacing, |j, _| {
                if groups[i] == groups[j] {
                    sets.join(i, j);
                }
            });
        }
        let of: Vec<usize> = (0..groups.len()).map(|i| sets.of(i)).collect();
        let mut extents: BTreeMap<usize, (usize, Vector<D>, Vector<D>)> = BTreeMap::new();
        for (&part, &p) in of.iter().zip(&pattern.points.positions) {
            let e = extents.entry(part).or_insert((0, p, p));
            e.0 += 1;
            for k in 0..D {
                (e.1[k], e.2[k]) = (e.1[k].min(p[k]), e.2[k].max(p[k]));
            }
        }
        let size = pattern.bounds.size();
        let is_long =
            |e: &(usize, Vector<D>, Vector<D>)| (0..D).any(|k| pattern.base[k] && e.2[k] - e.1[k] > ENDLESS * size[k]);
        let ends = !extents.values().any(is_long);
        let largest = extents.values().map(|e| e.0).max().unwrap_or(0);
        Self { of, most: ends.then_some(LARGEST * largest as f64) }
    }

    /// Numbers of the parts of `count` points, of which these are the pairs.
    pub(super) fn joined(&self, count: usize, pairs: &[Pair]) -> Vec<i32> {
        let mut sets = DisjointSets::new(count);
        for &(i, j, votes, all) in pairs {
            if votes > SURE * all {
                sets.join(i, j);
            }
        }
        while self.join(&mut sets, count, pairs) {}
        let mut number = HashMap::new();
        let mut numbered = |i: usize| {
            let next = number.len() as i32;
            *number.entry(sets.of(i)).or_insert(next)
        };
        (0..count).map(&mut numbered).collect()
    }

    /// Joins pieces, each with one other one at most, the surest first. Whether there were any.
    fn join(&self, sets: &mut DisjointSets, count: usize, pairs: &[Pair]) -> bool {
        let mut size = vec![0_usize; count];
        (0..count).for_each(|i| size[sets.of(i)] += 1);
        let mut between: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
        for &(i, j, votes, all) in pairs {
            let (a, b) = (sets.of(i), sets.of(j));
            if a != b {
                let sum = between.entry((a.min(b), a.max(b))).or_default();
                *sum = (sum.0 + votes, sum.1 + all);
            }
        }
        let mut order: Vec<(f64, usize, usize)> = between
            .into_iter()
            .filter(|(_, (votes, all))| *votes > JOINED * all)
            .map(|((a, b), (votes, _))| (votes, a, b))
            .filter(|(_, a, b)| self.most.is_none_or(|most| (size[*a] + size[*b]) as f64 <= most))
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut taken = vec![false; count];
        let mut any = false;
        for (_, a, b) in order {
            if !taken[a] && !taken[b] {
                (taken[a], taken[b], any) = (true, true, true);
                sets.join(a, b);
            }
        }
        any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of ten points side by side: neighbours in a row are of one part, those across are not.
    fn rows(doubt: impl Fn(usize, usize) -> Option<f64>) -> Vec<Pair> {
        let mut pairs = Vec::new();
        for i in 0..20_usize {
            for j in i + 1..20 {
                let (along, across) = ((i % 10).abs_diff(j % 10), i / 10 != j / 10);
                if along <= 2 {
                    let votes = doubt(i, j).unwrap_or(if across { -1.0 } else { 1.0 });
                    pairs.push((i, j, votes, 1.0));
                }
            }
        }
        pairs
    }

    fn parts(most: Option<f64>) -> Parts {
        Parts { of: Vec::new(), most }
    }

    fn two_rows() -> Vec<i32> {
        (0..20).map(|i| i / 10).collect()
    }

    #[test]
    fn a_pair_that_is_seen_wrongly_joins_and_tears_nothing() {
        // One pair across is sure of itself, and all pairs across the middle of the first row are in doubt.
        let wrong = |i: usize, j: usize| match (i, j) {
            (12, 3) | (3, 12) => Some(0.8),
            _ if j < 10 && i < 5 && j >= 5 => Some(0.3),
            _ => None,
        };
        assert_eq!(parts(None).joined(20, &rows(wrong)), two_rows());
    }

    #[test]
    fn no_part_is_larger_than_those_of_the_exemplar_where_these_end() {
        let unsure = |i: usize, j: usize| (i / 10 != j / 10).then_some(0.2);
        assert_eq!(parts(Some(12.0)).joined(20, &rows(unsure)), two_rows());
        assert_eq!(parts(None).joined(20, &rows(unsure)), vec![0; 20]);
    }
}
