//! The squared paper of an output, as far as it is drawn.

use std::collections::BTreeMap;

use arabesque_core::DisjointSets;

use crate::{
    orderly::ruled::{
        sheet::Sheet,
        star::{CROSSED, Look, Star, beside, opposite},
    },
    regular::grid::Grid,
    repeat::lattice::Node,
};

/// How far around a node others are compared.
pub(crate) const REACH: i64 = 3;

/// The nodes of an output and what is drawn at them.
pub(crate) struct Net<'a> {
    pub(crate) sheet: &'a Sheet,
    pub(crate) grid: &'a Grid,
    /// The nodes, row by row.
    pub(crate) nodes: Vec<Node>,
    number: BTreeMap<Node, usize>,
    pub(crate) stars: Vec<Star>,
    pub(crate) looks: Vec<Look>,
}

/// A node nearby that is decided in part.
#[derive(Clone, Copy)]
pub(crate) struct Near {
    pub(crate) offset: Node,
    pub(crate) look: Look,
}

impl<'a> Net<'a> {
    /// Nodes at which nothing is decided.
    pub(crate) fn new(sheet: &'a Sheet, grid: &'a Grid, mut nodes: Vec<Node>) -> Self {
        nodes.sort_by_key(|node| [node[1], node[0]]);
        let number = nodes.iter().enumerate().map(|(k, &n)| (n, k)).collect();
        let (stars, looks) = (vec![Star::default(); nodes.len()], vec![Look::default(); nodes.len()]);
        Self { sheet, grid, nodes, number, stars, looks }
    }

    /// The number of a node; around a tile, of the one that is the same.
    pub(crate) fn number(&self, node: Node) -> Option<usize> {
        self.number.get(&self.grid.wrap(node)).copied()
    }

    /// What is decided around a node, itself aside.
    pub(crate) fn near(&self, k: usize) -> Vec<Near> {
        let node = self.nodes[k];
        let around = (-REACH..=REACH).flat_map(|j| (-REACH..=REACH).map(move |i| [i, j]));
        around
            .filter(|offset| *offset != [0, 0])
            .filter_map(|offset| {
                let other = self.number([node[0] + offset[0], node[1] + offset[1]])?;
                let look = self.looks[other];
                (other != k && !look.is_open()).then_some(Near { offset, look })
            })
            .collect()
    }

    /// Draws at a node what is drawn at one of the exemplar: what is open, or all of it.
    pub(crate) fn copy(&mut self, k: usize, from: &Star, over: bool) {
        for way in 0..8 {
            if over || self.stars[k].steps[way].is_none() {
                self.set(k, way, from.steps[way].unwrap_or(0));
            }
        }
        if over || self.stars[k].thing.is_none() {
            self.stars[k].thing = from.thing;
        }
        self.look_again(k);
    }

    /// Draws one step, as seen from both of its ends.
    pub(crate) fn set(&mut self, k: usize, way: usize, curve: u32) {
        self.stars[k].steps[way] = Some(curve);
        if let Some(other) = self.number(beside(self.nodes[k], way)) {
            self.stars[other].steps[opposite(way)] = Some(curve);
            self.look_again(other);
        }
    }

    pub(crate) fn look_again(&mut self, k: usize) {
        self.looks[k] = Look::of(&self.stars[k], &self.sheet.styles, &self.sheet.classes);
    }

    /// Whether the slanted step that would cross the one from a node is drawn, if that is decided.
    pub(crate) fn crossing(&self, k: usize, way: usize) -> Option<bool> {
        let other = self.number(beside(self.nodes[k], CROSSED[way / 2].0))?;
        self.stars[other].steps[CROSSED[way / 2].1].map(|curve| curve > 0)
    }

    /// Whether a slanted step from a node crosses another.
    pub(crate) fn crosses(&self, k: usize) -> bool {
        let is_drawn = |way: usize| self.stars[k].steps[way].is_some_and(|curve| curve > 0);
        [1, 3, 5, 7].into_iter().any(|way| is_drawn(way) && self.crossing(k, way) == Some(true))
    }

    /// Whether every node around could still look like one of the exemplar if a star were copied to a node.
    pub(crate) fn leaves_room(&self, k: usize, from: &Star) -> bool {
        (0..8).filter(|&way| self.stars[k].steps[way].is_none()).all(|way| {
            let Some(other) = self.number(beside(self.nodes[k], way)) else { return true };
            let mut star = self.stars[other];
            star.steps[opposite(way)] = from.steps[way];
            let look = Look::of(&star, &self.sheet.styles, &self.sheet.classes);
            self.sheet.kinds.iter().any(|kind| !look.steps_differ(kind))
        })
    }

    /// The nodes at the other ends of the steps that copying a star would draw anew.
    pub(crate) fn new_ends(&self, k: usize, from: &Star) -> Vec<usize> {
        let open = (0..8).filter(|&way| self.stars[k].steps[way].is_none() && from.steps[way].is_some_and(|c| c > 0));
        open.filter_map(|way| self.number(beside(self.nodes[k], way))).collect()
    }

    /// Whether steps from a node to these would close a ring.
    pub(crate) fn would_close(&self, k: usize, ends: &[usize], sets: &mut DisjointSets) -> bool {
        let mut met = vec![sets.of(k)];
        for &end in ends {
            let set = sets.of(end);
            if met.contains(&set) {
                return true;
            }
            met.push(set);
        }
        false
    }
}
