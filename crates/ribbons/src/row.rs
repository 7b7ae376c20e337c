//! One row of the dynamic programme: the cheapest path to every position of a piece [Zhou 2013 §1.4, eq. 1].
//!
//! P\[i, u\] is the smallest P\[i-1, v\] + D(v + R, u + L) over all v, plus what re-use and variety add. Left columns are compared
//! sixteen at a time. Right columns lie in a tree of boxes; a box is left out when the cost of the cheapest path into it and a lower
//! bound on D are together above the best that all sixteen have. The bound is exact, so the result is that of [`exhaustive`].

use std::sync::Arc;

use rayon::prelude::*;

use crate::{
    cluster::{Node, Tree},
    columns::{Bundle, Columns, LANES, Lanes, Summary, column_cost},
    reuse::{Reuse, Trail},
    valid::Position,
};

/// No earlier position.
pub(crate) const NONE: u32 = u32::MAX;

/// Share of a lower bound that is believed, for the rounding of sums.
const TRUST: f64 = 0.9995;
/// Right columns in the smallest boxes.
const LEAF: usize = 8;

/// The cheapest paths to the positions of one piece.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) positions: Arc<Vec<Position>>,
    /// P\[i, u\].
    pub(crate) cost: Vec<f64>,
    /// The position before, an index into the row before; [`NONE`] in the first row.
    pub(crate) back: Vec<u32>,
    /// The position that the path began with, an index into the first row.
    pub(crate) start: Vec<u32>,
}

impl Row {
    /// The first row, which nothing goes before.
    pub(crate) fn first(positions: Arc<Vec<Position>>, reuse: &Reuse) -> Self {
        let n = positions.len();
        let cost = positions.iter().map(|p| reuse.taste(0, p.x)).collect();
        Self { cost, back: vec![NONE; n], start: (0..n as u32).collect(), positions }
    }

    /// The position with the cheapest path; the first of equal ones.
    pub(crate) fn best(&self) -> usize {
        (0..self.cost.len()).fold(0, |best, k| if self.cost[k] < self.cost[best] { k } else { best })
    }
}

/// What leads from one row to the next.
pub(crate) struct Step<'a> {
    pub(crate) before: &'a Row,
    /// What the paths into the row before have shown.
    pub(crate) trails: &'a [Trail],
    /// Right edges of the piece before.
    pub(crate) right: &'a Columns,
    /// Valid positions of this piece.
    pub(crate) positions: Arc<Vec<Position>>,
    /// Left edges of this piece.
    pub(crate) left: &'a Columns,
    /// From a position of this piece to the one before that it goes on from most naturally.
    pub(crate) natural: (i64, i64),
    pub(crate) reuse: &'a Reuse,
    /// Which piece this is.
    pub(crate) piece: usize,
}

/// The cheapest way to one position.
#[derive(Clone, Copy, Debug)]
struct Best {
    cost: f64,
    from: u32,
}

impl Best {
    const NONE: Self = Self { cost: f64::INFINITY, from: NONE };

    /// Takes the cheaper one, of equal ones the first: whatever the order of the search.
    fn offer(&mut self, cost: f64, from: u32) {
        if cost < self.cost || (cost == self.cost && from < self.from) {
            *self = Self { cost, from };
        }
    }
}

impl Step<'_> {
    /// The next row, by bounds.
    pub(crate) fn bounded(&self) -> Row {
        let (right, left) = rayon::join(|| self.right.summaries(), || self.left.summaries());
        let (boxes, groups) =
            rayon::join(|| Tree::new(&right, Some(&self.before.cost), LEAF), || Tree::new(&left, None, LANES));
        let index = Index::new(&self.before.positions);
        let leaves: Vec<&Node> = groups.leaves().collect();
        let found: Vec<[Best; LANES]> = leaves
            .par_iter()
            .map(|leaf| {
                let members = &groups.order[leaf.members.clone()];
                let bundle = Bundle::new(self.left, &left, members);
                let mut query = Query { step: self, tree: &boxes, right: &right, bundle, members, leaf, best: [Best::NONE; LANES] };
                query.seed(&index);
                query.visit(0);
                query.best
            })
            .collect();
        let mut best = vec![Best::NONE; self.positions.len()];
        for (leaf, found) in leaves.iter().zip(&found) {
            for (&member, found) in groups.order[leaf.members.clone()].iter().zip(found) {
                best[member as usize] = *found;
            }
        }
        self.row(&best)
    }

    /// The next row, every pair of columns in full.
    pub(crate) fn exhaustive(&self) -> Row {
        let best: Vec<Best> = (0..self.positions.len())
            .into_par_iter()
            .map(|u| {
                let mut best = Best::NONE;
                for v in 0..self.before.positions.len() {
                    let cost = column_cost(self.right.get(v), self.left.get(u));
                    best.offer(self.base(v, self.positions[u].x) + f64::from(cost), v as u32);
                }
                best
            })
            .collect();
        self.row(&best)
    }

    /// P\[i-1, v\], and what column `x` after it costs as a repetition.
    fn base(&self, v: usize, x: u16) -> f64 {
        self.before.cost[v] + self.reuse.repetition(&self.trails[v], x)
    }

    fn row(&self, best: &[Best]) -> Row {
        let taste = |u: usize| self.reuse.taste(self.piece, self.positions[u].x);
        Row {
            cost: best.iter().enumerate().map(|(u, b)| b.cost + taste(u)).collect(),
            back: best.iter().map(|b| b.from).collect(),
            start: best.iter().map(|b| self.before.start[b.from as usize]).collect(),
            positions: Arc::clone(&self.positions),
        }
    }
}

/// Where each position is in its row.
struct Index {
    first: (i64, i64),
    size: (i64, i64),
    places: Vec<u32>,
}

impl Index {
    fn new(positions: &[Position]) -> Self {
        let range = |of: fn(&Position) -> i64| {
            let least = positions.iter().map(of).min().unwrap_or(0);
            (least, positions.iter().map(of).max().map_or(0, |most| most - least + 1))
        };
        let (x, y) = (range(|p| i64::from(p.x)), range(|p| i64::from(p.y)));
        let mut index = Self { first: (x.0, y.0), size: (x.1, y.1), places: vec![NONE; (x.1 * y.1) as usize] };
        for (k, p) in positions.iter().enumerate() {
            if let Some(place) = index.place((p.x.into(), p.y.into())) {
                index.places[place] = k as u32;
            }
        }
        index
    }

    fn place(&self, p: (i64, i64)) -> Option<usize> {
        let (x, y) = (p.0 - self.first.0, p.1 - self.first.1);
        let inside = (0..self.size.0).contains(&x) && (0..self.size.1).contains(&y);
        inside.then(|| (x * self.size.1 + y) as usize)
    }

    fn find(&self, p: (i64, i64)) -> Option<u32> {
        self.place(p).map(|k| self.places[k]).filter(|&k| k != NONE)
    }
}

/// The search for the best ways to up to sixteen positions.
struct Query<'a> {
    step: &'a Step<'a>,
    tree: &'a Tree,
    right: &'a [Summary],
    bundle: Bundle,
    members: &'a [u32],
    leaf: &'a Node,
    best: [Best; LANES],
}

impl Query<'_> {
    /// Begins with the positions that go on in the exemplar.
    fn seed(&mut self, index: &Index) {
        let (dx, dy) = self.step.natural;
        let mut seeds: Vec<u32> = self
            .members
            .iter()
            .map(|&u| self.step.positions[u as usize])
            .filter_map(|p| index.find((i64::from(p.x) + dx, i64::from(p.y) + dy)))
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        seeds.into_iter().for_each(|v| self.compare(v));
    }

    /// The cost above which nothing is of interest to any lane.
    fn limit(&self) -> f64 {
        self.best[..self.members.len()].iter().fold(0.0, |most, b| b.cost.max(most))
    }

    fn bound(&self, node: usize) -> f64 {
        let node = &self.tree.nodes[node];
        node.cost + TRUST * f64::from(node.gap(self.leaf))
    }

    fn visit(&mut self, node: usize) {
        match self.tree.nodes[node].halves {
            Some(halves) => {
                let mut halves = halves.map(|half| (self.bound(half), half));
                halves.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                for (bound, half) in halves {
                    if bound <= self.limit() {
                        self.visit(half);
                    }
                }
            }
            None => {
                for k in self.tree.nodes[node].members.clone() {
                    let v = self.tree.order[k];
                    if self.promises(v) {
                        self.compare(v);
                    }
                }
            }
        }
    }

    /// Whether `v` may be better than what some lane has.
    fn promises(&self, v: u32) -> bool {
        let base = self.step.before.cost[v as usize];
        if base > self.limit() {
            return false;
        }
        let bounds = self.bundle.bounds(&self.right[v as usize]);
        let lanes = self.best.iter().zip(&bounds).take(self.members.len());
        lanes.into_iter().any(|(best, bound)| base + TRUST * f64::from(*bound) <= best.cost)
    }

    fn compare(&mut self, v: u32) {
        let base: [f64; LANES] = std::array::from_fn(|lane| {
            let member = self.members[lane.min(self.members.len() - 1)];
            self.step.base(v as usize, self.step.positions[member as usize].x)
        });
        // Rounded up, so that no equal cost is given up.
        let limits: Lanes = std::array::from_fn(|lane| ((self.best[lane].cost - base[lane]) as f32).next_up());
        let costs = self.bundle.costs(self.step.right.get(v as usize), &limits);
        for lane in 0..self.members.len() {
            if costs[lane] <= limits[lane] {
                self.best[lane].offer(base[lane] + f64::from(costs[lane]), v);
            }
        }
    }
}
