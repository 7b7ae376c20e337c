//! Which points of the output are of one part: parts may touch and stay apart all the same.
//!
//! For each pair of neighbours there is evidence, as the logarithm of odds: how often pairs of the exemplar that lie and face alike are of one part,
//! and whether the windows that hold both see them as of one part there. Then the two sets of points with most evidence for being one are joined,
//! over and over, as long as there is more for it than against it [Keuper 2015]. One false link is outvoted by all others between two parts.

use std::collections::{BTreeMap, BinaryHeap};

use arabesque_core::{Budget, DisjointSets, Result, Vector};

use super::{
    finish::{Seen, seen},
    state::Output,
};
use crate::{
    each::each,
    energy::{
        level::{Level, Matches, Near},
        links::neighbours,
    },
    exemplar::pattern::Pattern,
};

/// Work for each site that a point is seen by, for each pair of points, and for each time that two sets of points are compared.
const SEEN: u64 = 60;
const PAIR: u64 = 40;
const COMPARED: u64 = 200;

/// Points of one part are no farther apart than this from the next, in spacings.
const PART: f64 = 2.2;
/// Pairs are told apart by their distance and by how they face, in so many steps each.
const STEPS: usize = 8;
/// Evidence of windows that all say the same.
const AGREED: f64 = 8.0;

/// What pairs of neighbours of the exemplar tell about pairs of the output that lie and face alike.
struct Habits([f64; STEPS * STEPS]);

impl Habits {
    fn new<const D: usize>(pattern: &Pattern<D>, parts: &[usize], budget: &Budget) -> Result<Self> {
        let mut counts = [[0.5_f64; STEPS * STEPS]; 2];
        let normals = pattern.points.normals.as_deref();
        let mut meter = budget.meter();
        for (i, &p) in pattern.points.positions.iter().enumerate() {
            let looked = pattern.index.within(p, PART * pattern.spacing, |j, r| {
                if j > i {
                    let facing = normals.map_or(0.0, |n| facing(r, n[i], n[j]));
                    counts[usize::from(parts[i] == parts[j])][cell(r.norm() / pattern.spacing, facing)] += 1.0;
                }
            });
            meter.spend(20 + PAIR * looked)?;
        }
        Ok(Self(std::array::from_fn(|n| (counts[1][n] / counts[0][n]).ln())))
    }

    /// The evidence that a pair so many spacings apart is of one part.
    fn evidence(&self, distance: f64, facing: f64) -> f64 {
        self.0[cell(distance, facing)]
    }
}

/// How far two directions part along the way from the one to the other: from -2 for those that face each other to 2.
fn facing<const D: usize>(way: Vector<D>, from: Vector<D>, to: Vector<D>) -> f64 {
    (to - from).dot(way.unit_or_zero())
}

/// Number of the kind of pair. The steps of how pairs face are finer about the middle.
fn cell(distance: f64, facing: f64) -> usize {
    let step = |share: f64| ((share * STEPS as f64) as usize).min(STEPS - 1);
    let turned = facing.abs().min(1.0).sqrt().copysign(facing);
    step(distance / PART) * STEPS + step(0.5 + 0.5 * turned)
}

/// The parts of the exemplar: points near each other that have one number.
fn parts_of_exemplar<const D: usize>(pattern: &Pattern<D>, groups: &[i32]) -> Vec<usize> {
    let mut sets = DisjointSets::new(groups.len());
    for (i, &p) in pattern.points.positions.iter().enumerate() {
        pattern.index.within(p, PART * pattern.spacing, |j, _| {
            if groups[i] == groups[j] {
                sets.join(i, j);
            }
        });
    }
    (0..groups.len()).map(|i| sets.of(i)).collect()
}

/// Numbers of the parts of the output, by first points.
pub(crate) fn groups<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    matches: &Matches<D>,
    budget: &Budget,
) -> Result<Option<Vec<i32>>> {
    let pattern = level.pattern;
    let Some(own) = &pattern.points.groups else { return Ok(None) };
    let parts = parts_of_exemplar(pattern, own);
    let habits = Habits::new(pattern, &parts, budget)?;
    let n = output.places.len();
    let cost = |i: usize| near.windows.of(i).len() as u64 * SEEN;
    let seen = each(n, budget, cost, |i| seen(level, output, near, matches, i))?;
    let scale = |i: usize| {
        let sites = near.windows.of(i);
        sites.iter().map(|&q| level.sites[q as usize].scale).sum::<f64>() / sites.len().max(1) as f64
    };
    let scales: Vec<f64> = (0..n).map(scale).collect();
    let largest = scales.iter().copied().fold(0.0, f64::max);
    let around = neighbours(&output.places, PART * pattern.spacing * largest, level.domain, budget)?;
    let directions = |i: usize| pattern.channels.direction(&output.weights[i]).unwrap_or(Vector::ZERO);
    let mut pairs = Vec::new();
    let mut meter = budget.meter();
    for i in 0..n {
        for &j in around.of(i) {
            let j = j as usize;
            let way = level.domain.offset(output.places[i], output.places[j]);
            let far = way.norm() / (pattern.spacing * scales[i]);
            if j > i && far <= PART {
                meter.spend(PAIR + seen[i].len() as u64)?;
                let habit = habits.evidence(far, facing(way, directions(i), directions(j)));
                pairs.push((i, j, habit + AGREED * agreement(&parts, &seen[i], &seen[j])));
            }
        }
    }
    let mut sets = joined(n, &pairs, budget)?;
    let mut number = BTreeMap::new();
    let mut numbered = |i: usize| {
        let next = number.len() as i32;
        *number.entry(sets.of(i)).or_insert(next)
    };
    Ok(Some((0..n).map(&mut numbered).collect()))
}

/// How far the windows that hold two points see them as of one part of the exemplar: from -1 to 1.
fn agreement(parts: &[usize], one: &[Seen], other: &[Seen]) -> f64 {
    let (mut votes, mut all, mut others) = (0.0, 1e-12, other.iter().peekable());
    for (q, weight, source) in one {
        while others.next_if(|s| s.0 < *q).is_some() {}
        if let Some((_, theirs, their_source)) = others.next_if(|s| s.0 == *q) {
            all += weight * theirs;
            votes += weight * theirs * if parts[*source] == parts[*their_source] { 1.0 } else { -1.0 };
        }
    }
    votes / all
}

/// Two sets that could be joined: the evidence for it, and their numbers. The most evident come first, of equal ones those of lower numbers.
struct Join(f64, usize, usize);

impl Ord for Join {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0).then((other.1, other.2).cmp(&(self.1, self.2)))
    }
}

impl PartialOrd for Join {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Join {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Join {}

/// Evidence between two sets: its sum over the pairs between them, and how many these are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Evidence(f64, f64);

impl Evidence {
    /// As much as it exceeds what chance makes of so many pairs: large sets would swallow all around them otherwise.
    fn strength(&self) -> f64 {
        self.0 / self.1.sqrt()
    }
}

/// Joins what has most evidence for being one, as long as there is any for it.
fn joined(count: usize, pairs: &[(usize, usize, f64)], budget: &Budget) -> Result<DisjointSets> {
    let mut evidence: Vec<BTreeMap<usize, Evidence>> = vec![BTreeMap::new(); count];
    for &(i, j, value) in pairs {
        evidence[i].insert(j, Evidence(value, 1.0));
        evidence[j].insert(i, Evidence(value, 1.0));
    }
    let mut joins: BinaryHeap<Join> =
        pairs.iter().filter(|p| p.2 > 0.0).map(|&(i, j, value)| Join(value, i, j)).collect();
    let mut sets = DisjointSets::new(count);
    let mut meter = budget.meter();
    while let Some(Join(value, i, j)) = joins.pop() {
        // Of sets that were joined since there are newer entries.
        if evidence[i].get(&j).is_none_or(|e| e.strength() != value) {
            continue;
        }
        let (stays, goes) = if evidence[i].len() >= evidence[j].len() { (i, j) } else { (j, i) };
        sets.join(i, j);
        let theirs = std::mem::take(&mut evidence[goes]);
        meter.spend(COMPARED * (1 + theirs.len() as u64))?;
        for (other, value) in theirs {
            evidence[other].remove(&goes);
            if other == stays {
                continue;
            }
            let sum = evidence[stays].entry(other).or_default();
            (sum.0, sum.1) = (sum.0 + value.0, sum.1 + value.1);
            let sum = *sum;
            evidence[other].insert(stays, sum);
            if sum.0 > 0.0 {
                joins.push(Join(sum.strength(), stays.min(other), stays.max(other)));
            }
        }
    }
    Ok(sets)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sets(count: usize, pairs: &[(usize, usize, f64)]) -> Vec<usize> {
        let mut sets = joined(count, pairs, &Budget::default()).unwrap();
        (0..count).map(|i| sets.of(i)).collect()
    }

    #[test]
    fn a_false_link_is_outvoted() {
        // Two squares beside each other: one of the two links between them is sure, the other one says more strongly that they are two.
        let square = |o: usize| [(o, o + 1, 3.0), (o + 1, o + 2, 3.0), (o + 2, o + 3, 3.0), (o, o + 3, 3.0)];
        let mut pairs: Vec<_> = square(0).into_iter().chain(square(4)).collect();
        pairs.extend([(1, 4, 2.0), (2, 7, -4.0)]);
        assert_eq!(sets(8, &pairs), [0, 0, 0, 0, 4, 4, 4, 4]);
        pairs[9].2 = -1.0;
        assert_eq!(sets(8, &pairs), [0; 8]);
    }

    #[test]
    fn no_evidence_joins_nothing() {
        assert_eq!(sets(3, &[(0, 1, 0.0), (1, 2, -1.0)]), [0, 1, 2]);
        assert_eq!(sets(3, &[]), [0, 1, 2]);
    }

    #[test]
    fn what_faces_each_other_is_told_from_what_stands_back_to_back() {
        let (left, right) = (Vector([-1.0, 0.0]), Vector([1.0, 0.0]));
        assert_eq!(facing(Vector([0.5, 0.0]), right, left), -2.0);
        assert_eq!(facing(Vector([0.5, 0.0]), left, right), 2.0);
        assert_eq!(facing(Vector([0.0, 0.5]), left, right), 0.0);
        assert!(cell(1.0, -2.0) < cell(1.0, 0.0) && cell(1.0, 0.0) < cell(1.0, 2.0));
        assert!(cell(9.0, 2.0) < STEPS * STEPS);
    }
}
