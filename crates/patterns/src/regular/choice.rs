//! Which cell of the exemplar each cell of the output is made from.
//!
//! Where all cells look the same, any will do. Where they differ, by hand or in what lies at their places, each is
//! chosen to agree with the cells around it as much as cells of the exemplar agree with their neighbours, and no more:
//! random colours stay random, and a quilt of several blocks keeps what goes beside what.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Exemplar, Result, Stage, Stream, Vector};

use crate::repeat::{
    lattice::Node,
    looks::{ALIKE, looks},
    orbits::Orbit,
};

/// Draws of this module.
const CHOOSE: Stage = Stage::new(5);

/// Cells tried for each cell of the output, beside those that go on with a neighbour.
const TRIES: usize = 8;

/// Neighbours that are compared: half of the eight, the others are their opposites.
const WAYS: [Node; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// Agreement of neighbours that is no more than chance, as a share of what chance gives.
const CHANCE: f64 = 0.1;

/// Pairs of cells from which it is learnt how much neighbours agree.
const PAIRS: usize = 400;

/// Costs that differ by less than this are equal.
const NOISE: f64 = 0.05;

/// What it costs to go on copying where a neighbour stopped.
const COPY: f64 = 0.15;

/// Work for each cell that is made.
const CHOICE: u64 = 300;

/// Work for comparing two cells, for each place.
const COMPARE: u64 = 10;

/// The cells of an exemplar in which every place is taken.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    /// For each cell, the instance at each orbit.
    content: BTreeMap<Node, Vec<u32>>,
    nodes: Vec<Node>,
    /// How much each way of being neighbours tells, 0 where it tells nothing.
    coupling: [f64; 4],
    /// Whether all cells look the same.
    is_uniform: bool,
    /// Residual and kind of each instance of each orbit.
    features: Vec<Vec<(usize, Vector<2>)>>,
    /// Scale of residuals.
    unit: f64,
}

impl Cells {
    /// Learns from the instances of the orbits. `unit`: how much residuals must differ to count as much as another kind.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, orbits: &[Orbit], unit: f64, budget: &Budget) -> Result<Self> {
        let looks = looks(exemplar, ALIKE, budget)?;
        let kind =
            |e: u32| looks.as_ref().map_or_else(|| exemplar.elements[e as usize].class, |l| l[e as usize] as usize);
        let features: Vec<Vec<_>> = orbits
            .iter()
            .map(|orbit| orbit.instances.iter().map(|i| (kind(i.element), i.residual)).collect())
            .collect();
        let mut content: BTreeMap<Node, Vec<u32>> = BTreeMap::new();
        for (o, orbit) in orbits.iter().enumerate() {
            for (k, instance) in (0..).zip(&orbit.instances) {
                // Of what has no instance at an earlier orbit, the cell is not whole.
                let cell = content.entry(instance.node).or_default();
                if cell.len() == o {
                    cell.push(k);
                }
            }
        }
        content.retain(|_, cell| cell.len() == orbits.len());
        let nodes: Vec<Node> = content.keys().copied().collect();
        let mut cells = Self { content, nodes, coupling: [0.0; 4], is_uniform: false, features, unit };
        cells.learn(budget)?;
        Ok(cells)
    }

    fn learn(&mut self, budget: &Budget) -> Result<()> {
        budget.spend(COMPARE * (PAIRS * 9 * self.features.len()) as u64)?;
        let mut random = Stream::new(0, CHOOSE, u64::MAX);
        let count = self.nodes.len();
        let pairs: Vec<_> = (0..PAIRS.min(4 * count * count))
            .map(|_| (self.nodes[random.below(count)], self.nodes[random.below(count)]))
            .collect();
        let by_chance = mean(pairs.iter().map(|(a, b)| self.apart(a, b)));
        self.is_uniform = by_chance < 1e-3;
        if !self.is_uniform {
            self.coupling = WAYS.map(|way| self.coupling_of(way, &pairs, by_chance));
        }
        Ok(())
    }

    fn apart(&self, a: &Node, b: &Node) -> f64 {
        self.difference(&self.content[a], &self.content[b])
    }

    /// How much more alike the neighbours of cells are where the cells themselves are alike.
    fn coupling_of(&self, way: Node, pairs: &[(Node, Node)], by_chance: f64) -> f64 {
        let beside = |node: &Node| self.content.get(&[node[0] + way[0], node[1] + way[1]]);
        let mut alike = Vec::new();
        for (a, b) in pairs {
            if let (Some(p), Some(q), true) = (beside(a), beside(b), a != b && self.apart(a, b) < 0.5 * by_chance) {
                alike.push(self.difference(p, q));
            }
        }
        let gain = if alike.len() < 8 { 0.0 } else { 1.0 - mean(alike.into_iter()) / by_chance };
        if gain > CHANCE { gain } else { 0.0 }
    }

    /// Mean difference of two cells, place by place: 1 for another kind.
    fn difference(&self, a: &[u32], b: &[u32]) -> f64 {
        let each = self.features.iter().zip(a.iter().zip(b)).map(|(orbit, (&a, &b))| {
            let ((kind, off), (other, off_other)) = (orbit[a as usize], orbit[b as usize]);
            let moved = ((off - off_other).norm() / self.unit).min(1.0);
            if kind == other { 0.5 * moved } else { 1.0 }
        });
        mean(each)
    }

    /// The instance at each orbit for each of the `nodes`, which are in the order in which they are made. `beside`
    /// tells which of them is the neighbour of a node, around the back on a tile.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn choose(
        &self,
        nodes: &[Node],
        beside: &dyn Fn(Node) -> Option<usize>,
        seed: u64,
        budget: &Budget,
    ) -> Result<Vec<Vec<u32>>> {
        let mut meter = budget.meter();
        let mut made: Vec<Option<Node>> = vec![None; nodes.len()];
        let mut chosen = Vec::with_capacity(nodes.len());
        for (k, &node) in nodes.iter().enumerate() {
            meter.spend(CHOICE)?;
            let mut random = Stream::new(seed, CHOOSE, k as u64);
            if self.nodes.is_empty() {
                chosen.push(self.features.iter().map(|orbit| random.below(orbit.len()) as u32).collect());
                continue;
            }
            let source = if self.is_uniform {
                self.nodes[random.below(self.nodes.len())]
            } else {
                meter.spend(COMPARE * (TRIES * 8 * self.features.len()) as u64)?;
                self.best(node, &made, beside, &mut random)
            };
            made[k] = Some(source);
            chosen.push(self.content[&source].clone());
        }
        Ok(chosen)
    }

    /// The cell that agrees best with what is made around `node`.
    fn best(
        &self,
        node: Node,
        made: &[Option<Node>],
        beside: &dyn Fn(Node) -> Option<usize>,
        random: &mut Stream,
    ) -> Node {
        let step = |node: Node, way: Node, sign: i64| [node[0] + sign * way[0], node[1] + sign * way[1]];
        let around: Vec<(Node, i64, f64, Node)> = WAYS
            .iter()
            .zip(self.coupling)
            .filter(|(_, coupling)| *coupling > 0.0)
            .flat_map(|(&way, coupling)| [1, -1].map(|sign| (way, sign, coupling)))
            .filter_map(|(way, sign, coupling)| {
                let there = beside(step(node, way, sign))?;
                Some((way, sign, coupling, made[there]?))
            })
            .collect();
        let mut tried: Vec<(Node, f64)> =
            (0..TRIES).map(|_| (self.nodes[random.below(self.nodes.len())], 0.0)).collect();
        tried.extend(around.iter().map(|&(way, sign, _, source)| (step(source, way, -sign), COPY)));
        let mut best: Option<(f64, Node)> = None;
        for (candidate, extra) in tried {
            if !self.content.contains_key(&candidate) {
                continue;
            }
            let cost: f64 = around
                .iter()
                .map(|&(way, sign, coupling, source)| {
                    let wanted = self.content.get(&step(candidate, way, sign));
                    coupling * wanted.map_or(0.5, |wanted| self.difference(wanted, &self.content[&source]))
                })
                .sum();
            let cost = cost + extra + NOISE * random.unit();
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, candidate));
            }
        }
        best.map_or(self.nodes[0], |(_, node)| node)
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
