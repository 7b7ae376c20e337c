//! One row of the dynamic programme: the cheapest path to every position of a piece [Zhou 2013 §1.4, eq. 1].
//!
//! P\[i, u\] is the smallest P\[i-1, v\] + D(v + R, u + L) over all v, plus what re-use and variety add. Left columns are compared
//! sixteen at a time. Right columns lie in a tree of boxes; a box is left out when the cost of the cheapest path into it and a lower
//! bound on D are together above the best that all sixteen have. The bound is exact, so the result is that of [`exhaustive`].

use std::sync::Arc;

use arabesque_core::{Budget, Held, Meter, Result};
use rayon::prelude::*;

use crate::{
    constraints::valid::Position,
    exemplar::cluster::{Node, Tree},
    exemplar::columns::{Bundle, Columns, LANES, Lanes, Summary, TRUST, block_bounds, column_cost, column_cost_within},
    search::reuse::{Reuse, Trail},
};

/// No earlier position.
pub(crate) const NONE: u32 = u32::MAX;

/// Positions that are seeded one after the other.
const SEEDED: usize = 256;
/// Right columns in the smallest boxes.
const LEAF: usize = 4;

/// What the memory of rows is called.
const TABLE: &str = "places of the pieces laid so far";
/// Work of bounding one box, and of comparing one column with all lanes by their summaries.
const BOX: u64 = 80;
const COMPARED: u64 = 60;
/// Work of bounding one pair of columns block by block.
const BOUNDED: u64 = 60;
/// Bytes that a position takes in a row, and beside it for the row that follows.
const KEPT: usize = size_of::<Position>() + size_of::<f64>() + 2 * size_of::<u32>();
const BESIDE: usize = size_of::<Trail>() + 2 * size_of::<Summary>() + size_of::<Node>() + 2 * size_of::<Best>();

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
    /// The memory of all this.
    _held: Arc<Held>,
}

impl Row {
    /// The first row, which nothing goes before.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the memory is used up.
    pub(crate) fn first(positions: Arc<Vec<Position>>, reuse: &Reuse, depth: f64, budget: &Budget) -> Result<Self> {
        let n = positions.len();
        let held = Arc::new(budget.hold(TABLE, n * KEPT)?);
        let cost = positions.iter().map(|p| reuse.preference(0, *p, depth)).collect();
        Ok(Self { cost, back: vec![NONE; n], start: (0..n as u32).collect(), positions, _held: held })
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
    /// How far down its left edge reaches.
    pub(crate) depth: f64,
    /// From a position of this piece to the one before that it goes on from most naturally.
    pub(crate) natural: (i64, i64),
    pub(crate) reuse: &'a Reuse,
    /// Which piece this is.
    pub(crate) piece: usize,
    pub(crate) budget: &'a Budget,
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
    ///
    /// # Errors
    /// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`].
    pub(crate) fn bounded(&self) -> Result<Row> {
        let budget = self.budget;
        let count = self.before.positions.len() + self.positions.len();
        let _held = budget.hold("places of one piece", count * BESIDE)?;
        let (right, left) = rayon::join(|| self.right.summaries(budget), || self.left.summaries(budget));
        let (right, left) = (right?, left?);
        let (boxes, groups) = rayon::join(
            || Tree::new(&right, Some(&self.before.cost), LEAF, budget),
            || Tree::new(&left, None, LANES, budget),
        );
        let (boxes, groups) = (boxes?, groups?);
        let seeds = self.seeds(&right, &left)?;
        let leaves: Vec<&Node> = groups.leaves().collect();
        let search = |leaf: &&Node| {
            let mut query = Query::new(self, [(&boxes, &right), (&groups, &left)], leaf, &seeds);
            query.visit(0)?;
            Ok(query.best)
        };
        let found = leaves.par_iter().map(search).collect::<Result<Vec<[Best; LANES]>>>()?;
        budget.spend(0)?;
        let mut best = vec![Best::NONE; self.positions.len()];
        for (leaf, found) in leaves.iter().zip(&found) {
            for (&member, found) in groups.order[leaf.members.clone()].iter().zip(found) {
                best[member as usize] = *found;
            }
        }
        self.row(&best)
    }

    /// Good ways to begin with: what goes on in the exemplar, and what is best for the positions above and to the left, one farther.
    fn seeds(&self, right: &[Summary], left: &[Summary]) -> Result<Vec<Best>> {
        let index = Index::new(&self.before.positions, self.budget)?;
        let here = Index::new(&self.positions, self.budget)?;
        let mut best = vec![Best::NONE; self.positions.len()];
        best.par_chunks_mut(SEEDED).enumerate().try_for_each(|(chunk, best)| {
            let first = chunk * SEEDED;
            let mut meter = self.budget.meter();
            for k in 0..best.len() {
                let p = self.positions[first + k].place();
                let beside = [(0, 1), (1, 0)].into_iter().filter_map(|(dx, dy)| {
                    let neighbour = here.find((p.0 - dx, p.1 - dy))? as usize;
                    let from = best.get(neighbour.checked_sub(first)?)?.from;
                    let q = self.before.positions.get(from as usize)?.place();
                    index.find((q.0 + dx, q.1 + dy))
                });
                let natural = index.find((p.0 + self.natural.0, p.1 + self.natural.1));
                let candidates: Vec<u32> = natural.into_iter().chain(beside).collect();
                for v in candidates {
                    meter.spend(BOUNDED + self.left.work())?;
                    self.offer(&mut best[k], v as usize, first + k, [right, left]);
                }
            }
            Ok(())
        })?;
        self.budget.spend(0)?;
        Ok(best)
    }

    /// Takes `v` for the way to `u` if it is better.
    fn offer(&self, best: &mut Best, v: usize, u: usize, [right, left]: [&[Summary]; 2]) {
        let base = self.base(v, self.positions[u].x);
        // Rounded up, so that no equal cost is given up.
        let limit = ((best.cost - base) as f32).next_up();
        let bounds = block_bounds(&right[v], &left[u]);
        if let Some(cost) = column_cost_within((self.right, v), (self.left, u), &bounds, limit) {
            best.offer(base + f64::from(cost), v as u32);
        }
    }

    /// The next row, every pair of columns in full.
    ///
    /// # Errors
    /// As [`Step::bounded`].
    pub(crate) fn exhaustive(&self) -> Result<Row> {
        let way = |u: usize| {
            let (mut best, mut meter) = (Best::NONE, self.budget.meter());
            for v in 0..self.before.positions.len() {
                meter.spend(BOUNDED + self.left.work())?;
                let cost = column_cost(self.right, v, self.left, u);
                best.offer(self.base(v, self.positions[u].x) + f64::from(cost), v as u32);
            }
            Ok(best)
        };
        let best = (0..self.positions.len()).into_par_iter().map(way).collect::<Result<Vec<Best>>>()?;
        self.budget.spend(0)?;
        self.row(&best)
    }

    /// P\[i-1, v\], and what column `x` after it costs as a repetition.
    fn base(&self, v: usize, x: u16) -> f64 {
        self.before.cost[v] + self.reuse.repetition(&self.trails[v], x)
    }

    fn row(&self, best: &[Best]) -> Result<Row> {
        let held = Arc::new(self.budget.hold(TABLE, best.len() * KEPT)?);
        let preference = |u: usize| self.reuse.preference(self.piece, self.positions[u], self.depth);
        Ok(Row {
            cost: best.iter().enumerate().map(|(u, b)| b.cost + preference(u)).collect(),
            back: best.iter().map(|b| b.from).collect(),
            start: best.iter().map(|b| self.before.start[b.from as usize]).collect(),
            positions: Arc::clone(&self.positions),
            _held: held,
        })
    }
}

/// Where each position is in its row.
struct Index {
    first: (i64, i64),
    size: (i64, i64),
    places: Vec<u32>,
    _held: Held,
}

impl Index {
    fn new(positions: &[Position], budget: &Budget) -> Result<Self> {
        let range = |of: fn(&Position) -> i64| {
            let least = positions.iter().map(of).min().unwrap_or(0);
            (least, positions.iter().map(of).max().map_or(0, |most| most - least + 1))
        };
        let (x, y) = (range(|p| i64::from(p.x)), range(|p| i64::from(p.y)));
        let (mut places, held) = budget.list("places of one piece", (x.1 * y.1) as usize)?;
        places.resize((x.1 * y.1) as usize, NONE);
        let mut index = Self { first: (x.0, y.0), size: (x.1, y.1), places, _held: held };
        for (k, p) in positions.iter().enumerate() {
            if let Some(place) = index.place(p.place()) {
                index.places[place] = k as u32;
            }
        }
        Ok(index)
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
    left: &'a [Summary],
    bundle: Bundle,
    members: &'a [u32],
    leaf: &'a Node,
    best: [Best; LANES],
    /// Costs of the best above the cheapest path of the row before, rounded up.
    limits: Lanes,
    /// The largest of them.
    limit: f32,
    /// Cost of the cheapest path of the row before.
    least: f64,
    /// Work that is not yet counted.
    owed: u64,
    meter: Meter<'a>,
}

impl<'a> Query<'a> {
    fn new(step: &'a Step<'a>, sides: [(&'a Tree, &'a [Summary]); 2], leaf: &'a Node, seeds: &[Best]) -> Self {
        let [(tree, right), (groups, left)] = sides;
        let members = &groups.order[leaf.members.clone()];
        let best = std::array::from_fn(|lane| seeds[members[lane.min(members.len() - 1)] as usize]);
        let (bundle, least) = (Bundle::new(left, members), tree.nodes[0].cost);
        let (limits, meter) = ([0.0; LANES], step.budget.meter());
        let mut query =
            Self { step, tree, right, left, bundle, members, leaf, best, limits, limit: 0.0, least, owed: 0, meter };
        query.raise_limits();
        query
    }

    fn raise_limits(&mut self) {
        self.limits = std::array::from_fn(|lane| ((self.best[lane].cost - self.least) as f32).next_up());
        self.limit = self.limits.iter().fold(0.0, |most, &limit| limit.max(most));
    }

    /// `cost` above the cheapest path, rounded down.
    fn above(&self, cost: f64) -> f32 {
        ((cost - self.least) as f32).next_down()
    }

    fn bound(&self, node: usize) -> f32 {
        let node = &self.tree.nodes[node];
        self.above(node.cost) + TRUST * node.gap(self.leaf)
    }

    fn visit(&mut self, node: usize) -> Result<()> {
        self.meter.spend(BOX + std::mem::take(&mut self.owed))?;
        if let Some([a, b]) = self.tree.nodes[node].halves {
            let (near, far) = (self.bound(a), self.bound(b));
            let order = if near <= far { [(near, a), (far, b)] } else { [(far, b), (near, a)] };
            for (bound, half) in order {
                if bound <= self.limit {
                    self.visit(half)?;
                }
            }
        } else {
            for k in self.tree.nodes[node].members.clone() {
                self.compare(self.tree.order[k]);
            }
        }
        Ok(())
    }

    /// Offers `v` to the lanes that it may be better for than what they have.
    fn compare(&mut self, v: u32) {
        let base = self.above(self.step.before.cost[v as usize]);
        if base > self.limit {
            return;
        }
        self.owed += COMPARED;
        let bounds = self.bundle.bounds(&self.right[v as usize]);
        let promising: [bool; LANES] = std::array::from_fn(|lane| base + TRUST * bounds[lane] <= self.limits[lane]);
        if !promising.iter().any(|&p| p) {
            return;
        }
        for lane in (0..self.members.len()).filter(|&lane| promising[lane]) {
            let u = self.members[lane] as usize;
            self.owed += BOUNDED + self.step.left.work();
            self.step.offer(&mut self.best[lane], v as usize, u, [self.right, self.left]);
        }
        self.raise_limits();
    }
}
