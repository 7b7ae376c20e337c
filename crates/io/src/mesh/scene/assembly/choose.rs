//! Which branches of a tree are elements.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use arabesque_core::{Bounds, Budget, DisjointSets, Result, Similarity};

use super::tree::{Candidate, Tree};
use crate::mesh::scene::model::Scene;

/// Work of one node that is compared.
const PER_NODE: u64 = 300;
/// Places that differ by less than this share of an element are the same.
const SAME: f64 = 1e-3;
/// Parts that hang together are no farther apart than these shares of their usual size: of copies, and of what is merely alike.
const TOUCH: f64 = 0.05;
const NEAR: f64 = 0.25;
/// What is merely alike has no more parts of one kind.
const REPEATED: usize = 6;
/// Parts that one thing may have.
const PARTS: usize = 512;
/// So many alike are known as things by being smaller than this share of what they cover together.
const SEVERAL: usize = 4;
const SMALL: f64 = 0.34;
/// What stands beside elements is one if it is larger than they are by no more than this factor.
const LARGER: f64 = 2.0;

/// What the branches of a scene are looked at with.
pub(super) struct Look<'a> {
    pub(super) scene: &'a Scene,
    pub(super) tree: &'a Tree,
    pub(super) candidates: &'a [Candidate],
    /// The box around every node.
    pub(super) boxes: &'a [Bounds<3>],
    pub(super) budget: &'a Budget,
}

impl Look<'_> {
    /// Numbers of the candidates that are elements, none of them a part of another, in order.
    pub(super) fn chosen(&self) -> Result<Vec<usize>> {
        let mut choice = vec![false; self.candidates.len()];
        self.choose(&mut choice, |k| self.tree.branches[self.candidates[k].branch].is_element);
        let copies = self.copies()?;
        self.choose(&mut choice, |k| copies[k]);
        let alike = self.alike()?;
        self.choose(&mut choice, |k| alike[k]);
        self.choose_beside(&mut choice);
        Ok((0..choice.len()).filter(|&k| choice[k]).collect())
    }

    /// Adds what is wanted to what is chosen, the highest first: nothing that holds, or is held by, something that is chosen.
    fn choose(&self, choice: &mut [bool], wanted: impl Fn(usize) -> bool) {
        let mut holds = vec![false; choice.len()];
        for k in (0..choice.len()).rev() {
            if let Some(above) = self.candidates[k].above {
                holds[above] |= choice[k] || holds[k];
            }
        }
        let mut held = vec![false; choice.len()];
        for k in 0..choice.len() {
            held[k] = self.candidates[k].above.is_some_and(|above| choice[above] || held[above]);
            // What one node shows many times is no element.
            choice[k] |= !held[k] && !holds[k] && self.candidates[k].units.len() > 1 && wanted(k);
        }
    }

    /// Which candidates are the same meshes, in the same places to one another, as others, or the same meshes in other places.
    fn copies(&self) -> Result<Vec<bool>> {
        let mut found = vec![false; self.candidates.len()];
        let by_meshes = self.sorted_by(|c| c.meshes.clone());
        let siblings = self.siblings(&by_meshes);
        for members in by_meshes.values().filter(|members| members.len() > 1) {
            let area = self.area(members);
            let (mut variants, is_mixed) = (Vec::<Vec<usize>>::new(), self.is_mixed(members[0]));
            for &k in members {
                self.budget.spend(PER_NODE * (self.candidates[k].nodes.len() * (1 + variants.len().min(8))) as u64)?;
                // Whoever varies everything shows no copies.
                let known = variants.iter_mut().take(8).find(|known| self.are_copies(known[0], k));
                match known {
                    Some(known) => known.push(k),
                    None => variants.push(vec![k]),
                }
            }
            for variant in variants {
                let count = variant.len();
                for k in variant {
                    let siblings = siblings[k];
                    found[k] = if count > 1 {
                        let touches = self.hangs_together(k, TOUCH);
                        // A row of many alike is no element, however often it comes.
                        let is_small = is_mixed || touches && self.candidates[k].nodes.len() <= REPEATED;
                        is_small && siblings < if touches { count } else { 2 }.max(2)
                    } else {
                        is_mixed && siblings < 2 && (self.is_one_thing(k) || self.is_small(k, area))
                    };
                }
            }
        }
        Ok(found)
    }

    /// Which candidates have names like others: their own and those of their parts.
    fn alike(&self) -> Result<Vec<bool>> {
        let mut found = vec![false; self.candidates.len()];
        let by_names = self.sorted_by(|c| c.names.clone());
        let siblings = self.siblings(&by_names);
        self.budget.spend(PER_NODE * self.candidates.len() as u64)?;
        for members in by_names.values().filter(|members| members.len() > 1) {
            let kinds: BTreeSet<&String> = self.candidates[members[0]].names.1.iter().collect();
            let area = self.area(members);
            for &k in members.iter().filter(|_| kinds.len() > 1) {
                found[k] = siblings[k] < 2 && (self.is_one_thing(k) || self.is_small(k, area));
            }
        }
        Ok(found)
    }

    /// What stands beside elements, holds none of them and is not much larger, is one too.
    fn choose_beside(&self, choice: &mut [bool]) {
        let mut largest: BTreeMap<Option<usize>, f64> = BTreeMap::new();
        for k in (0..choice.len()).filter(|&k| choice[k]) {
            let above = self.tree.branches[self.candidates[k].branch].above;
            let size = self.size(&self.candidates[k].nodes);
            largest.entry(above).and_modify(|most| *most = most.max(size)).or_insert(size);
        }
        let is_beside = |k: usize| {
            let above = self.tree.branches[self.candidates[k].branch].above;
            let is_small = |most: &f64| self.size(&self.candidates[k].nodes) <= LARGER * most;
            largest.get(&above).is_some_and(is_small) && self.is_one_thing(k)
        };
        self.choose(choice, is_beside);
    }

    fn sorted_by<K: Ord>(&self, key: impl Fn(&Candidate) -> K) -> BTreeMap<K, Vec<usize>> {
        let mut sorted: BTreeMap<K, Vec<usize>> = BTreeMap::new();
        self.candidates.iter().enumerate().for_each(|(k, c)| sorted.entry(key(c)).or_default().push(k));
        sorted
    }

    /// How many candidates of one kind hang directly below each candidate, at most.
    fn siblings<K>(&self, kinds: &BTreeMap<K, Vec<usize>>) -> Vec<usize> {
        let mut most = vec![0; self.candidates.len()];
        for members in kinds.values() {
            let mut below: BTreeMap<usize, usize> = BTreeMap::new();
            members.iter().filter_map(|&m| self.candidates[m].above).for_each(|k| *below.entry(k).or_default() += 1);
            below.into_iter().for_each(|(k, count)| most[k] = most[k].max(count));
        }
        // A candidate with few parts has no many of them.
        (0..most.len()).map(|k| if self.candidates[k].nodes.len() < 4 { 0 } else { most[k] }).collect()
    }

    /// Whether two candidates of the same meshes have them in the same places, seen from the first.
    fn are_copies(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|k| placed(self.scene, &self.candidates[k]));
        let seen = |list: &[(usize, Similarity<3>)], k: usize| list[0].1.inverse().after(&list[k].1);
        let reach = (0..a.len()).map(|k| seen(&a, k).translation.norm()).fold(0.0, f64::max);
        let mesh = &self.scene.meshes[a[0].0].mesh;
        let size = reach.max(mesh.bounds().size().norm());
        (0..a.len()).all(|k| {
            let [p, q] = [seen(&a, k), seen(&b, k)];
            let turned = (0..9).map(|n| (p.rotation.0[n / 3][n % 3] - q.rotation.0[n / 3][n % 3]).abs());
            a[k].0 == b[k].0
                && (p.translation - q.translation).norm() <= SAME * size
                && (p.scale - q.scale).abs() <= SAME * p.scale
                && turned.fold(0.0, f64::max) <= SAME
        })
    }

    fn is_mixed(&self, k: usize) -> bool {
        let meshes = &self.candidates[k].meshes;
        meshes.first() != meshes.last()
    }

    /// Whether a candidate may be one thing though no other is a copy of it.
    fn is_one_thing(&self, k: usize) -> bool {
        self.most_of_one_kind(k) <= REPEATED && self.hangs_together(k, NEAR)
    }

    /// How far several alike reach together; nothing where there are few.
    fn area(&self, members: &[usize]) -> f64 {
        let around = |all: Bounds<3>, k: &usize| all.union(&self.around(&self.candidates[*k].nodes));
        if members.len() < SEVERAL { 0.0 } else { members.iter().fold(Bounds::EMPTY, around).size().norm() }
    }

    /// Whether a candidate of few parts is small beside what all that are like it cover, whatever is between its parts.
    fn is_small(&self, k: usize, area: f64) -> bool {
        self.most_of_one_kind(k) <= REPEATED && self.size(&self.candidates[k].nodes) <= SMALL * area
    }

    fn most_of_one_kind(&self, k: usize) -> usize {
        self.candidates[k].meshes.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(0)
    }

    /// Whether the parts of a candidate are one group of boxes no farther apart than a share of their usual size.
    fn hangs_together(&self, k: usize, share: f64) -> bool {
        if self.candidates[k].units.len() > PARTS {
            return false;
        }
        let units: Vec<Bounds<3>> = self.candidates[k].units.iter().map(|unit| self.around(unit)).collect();
        let mut sizes: Vec<f64> = units.iter().map(|unit| unit.size().0.into_iter().fold(0.0, f64::max)).collect();
        sizes.sort_by(f64::total_cmp);
        let slack = 0.5 * share * sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        let grown: Vec<Bounds<3>> = units.iter().map(|unit| unit.grown(slack)).collect();
        let mut sets = DisjointSets::new(units.len());
        for (i, a) in grown.iter().enumerate() {
            (0..i).filter(|&j| a.intersects(&grown[j])).collect::<Vec<_>>().into_iter().for_each(|j| sets.join(i, j));
        }
        (0..units.len()).all(|i| sets.of(i) == 0)
    }

    fn around(&self, nodes: &Range<usize>) -> Bounds<3> {
        self.boxes[nodes.clone()].iter().fold(Bounds::EMPTY, |all, own| all.union(own))
    }

    fn size(&self, nodes: &Range<usize>) -> f64 {
        self.around(nodes).size().norm()
    }
}

/// The meshes of a candidate and where they stand, by their numbers.
pub(super) fn placed(scene: &Scene, candidate: &Candidate) -> Vec<(usize, Similarity<3>)> {
    let mut list: Vec<_> = scene.nodes[candidate.nodes.clone()].iter().map(|n| (n.mesh, n.transform)).collect();
    list.sort_by_key(|(mesh, _)| *mesh);
    list
}
