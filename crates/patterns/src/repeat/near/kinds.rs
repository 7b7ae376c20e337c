//! The lattice by which kinds repeat, in the nodes at which things lie.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Budget, Result};

use crate::repeat::{
    lattice::{Lattice, Node},
    near::nodes::Nodes,
};

/// Nodes in the cell of a lattice of kinds, at most, and fewest things for each of them.
const MOST: i64 = 16;
const FEWEST: usize = 3;

/// Share of the things that must be of the kind that the lattice has there, for it to say what lies where.
const RIGHT: f64 = 0.93;

/// What it takes to say which lattice it is, in bits.
const CHOICE: f64 = 7.0;

/// Share of the things that have something one of the shortest vectors on; and of these that must be of one kind with it, in
/// terms of what is to be expected.
const AGAIN: (f64, f64) = (0.15, 0.85);

/// Work for a thing and a lattice.
const ASK: u64 = 6;

/// A lattice of kinds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sublattice {
    /// Its vectors in terms of those of the nodes.
    pub(crate) vectors: [Node; 2],
    /// Elements that are of another kind than is commonest at their place in its cell.
    pub(crate) odd: Vec<usize>,
    /// The place in its cell of each thing at a node, as a number.
    pub(crate) places: Vec<i64>,
}

impl Sublattice {
    /// Whether it says what lies where, but for a few odd things.
    pub(crate) fn says_all(&self) -> bool {
        self.odd.len() as f64 <= (1.0 - RIGHT) * self.places.len() as f64
    }

    /// Whether another one has all its nodes.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        // Vectors are (wide, 0) and (slant, high).
        let [[wide, _], [slant, high]] = other.vectors;
        self.vectors.iter().all(|[x, y]| y % high == 0 && (x - y / high * slant) % wide == 0)
    }

    /// Whether all nodes are one place of its cell.
    pub(crate) fn is_of_all(&self) -> bool {
        self.vectors == [[1, 0], [0, 1]]
    }
}

/// The lattice with which it takes fewest words to say what lies at the nodes ([Rissanen 1978]): either the kind at a place of its cell
/// and what is odd, or how often each kind lies there. `kinds`: those of all elements.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn sublattice(nodes: &Nodes, kinds: &[u32], budget: &Budget) -> Result<Sublattice> {
    let count = nodes.all.len();
    let distinct: BTreeSet<u32> = nodes.all.iter().map(|(_, e)| kinds[*e]).collect();
    let words = Words { of_kind: (distinct.len() as f64).log2().max(0.2), of_place: (count as f64).log2() };
    let mut best: Option<(f64, [i64; 3])> = None;
    for cells in 1..=MOST.min((count / FEWEST) as i64).max(1) {
        for wide in (1..=cells).filter(|wide| cells % wide == 0) {
            for slant in 0..wide {
                budget.spend(ASK * count as u64)?;
                // Vectors (wide, 0) and (slant, high), which each lattice of this cell has once.
                let cell = [wide, slant, cells / wide];
                let counts = counted(nodes, kinds, cell);
                let choice = if cells > 1 { CHOICE } else { 0.0 };
                let cost = choice + counts.values().map(|kinds| words.of(kinds, distinct.len())).sum::<f64>();
                if best.is_none_or(|(least, _)| cost < least)
                    && (cells == 1 || is_seen_again(nodes, kinds, cell, &counts))
                {
                    best = Some((cost, cell));
                }
            }
        }
    }
    let cell = best.map_or([1, 0, 1], |(_, cell)| cell);
    let common = counted(nodes, kinds, cell);
    let common = |node: &Node| {
        let kinds = common.get(&place_in(node, cell))?;
        kinds.iter().max_by_key(|(kind, n)| (**n, u32::MAX - **kind)).map(|(kind, _)| *kind)
    };
    let odd = nodes.all.iter().filter(|(node, e)| common(node) != Some(kinds[*e])).map(|(_, e)| *e).collect();
    let place = |(node, _): &(Node, usize)| {
        let (x, y) = place_in(node, cell);
        y * cell[0] + x
    };
    let vectors = [[cell[0], 0], [cell[1], cell[2]]];
    Ok(Sublattice { vectors, odd, places: nodes.all.iter().map(place).collect() })
}

/// How often each kind lies at each place of a cell.
type Counts = BTreeMap<(i64, i64), BTreeMap<u32, usize>>;

fn counted(nodes: &Nodes, kinds: &[u32], cell: [i64; 3]) -> Counts {
    let mut counts = Counts::new();
    for (node, element) in &nodes.all {
        *counts.entry(place_in(node, cell)).or_default().entry(kinds[*element]).or_default() += 1;
    }
    counts
}

/// Bits that it takes to name a kind, and one of the things.
struct Words {
    of_kind: f64,
    of_place: f64,
}

impl Words {
    /// Bits that it takes to say what lies at one place of the cell.
    fn of(&self, kinds: &BTreeMap<u32, usize>, distinct: usize) -> f64 {
        let count: usize = kinds.values().sum();
        let most = kinds.values().copied().max().unwrap_or(0);
        let one_kind = self.of_kind + (count - most) as f64 * (self.of_place + self.of_kind);
        let each = |n: usize| -(n as f64) * (n as f64 / count as f64).log2();
        let at_random = kinds.values().map(|&n| each(n)).sum::<f64>() + 0.5 * (distinct as f64 - 1.0) * self.of_place;
        1.0 + one_kind.min(at_random)
    }
}

/// Whether the kinds of the nodes come again after each of the shortest vectors of a lattice of nodes: what changes from one side
/// of a drawing to the other is not known to begin anew.
fn is_seen_again(nodes: &Nodes, kinds: &[u32], [wide, slant, high]: [i64; 3], counts: &Counts) -> bool {
    let count = nodes.all.len() as f64;
    let [a, b] = [[wide, 0], [slant, high]].map(|node| nodes.lattice.at(node));
    let Some(lattice) = Lattice::new(a, b) else { return false };
    let alike = |kinds: &BTreeMap<u32, usize>| {
        let all = kinds.values().sum::<usize>() as f64;
        kinds.values().map(|&n| (n as f64).powi(2)).sum::<f64>() / all
    };
    let expected = counts.values().map(alike).sum::<f64>() / count;
    let known: BTreeMap<Node, usize> = nodes.all.iter().copied().collect();
    lattice.vectors.iter().all(|v| {
        let (step, _) = nodes.lattice.nearest(*v);
        let pairs = nodes.all.iter().filter_map(|(node, e)| {
            let there = known.get(&[node[0] + step[0], node[1] + step[1]])?;
            Some(kinds[*e] == kinds[*there])
        });
        let (seen, again) = pairs.fold((0.0, 0.0), |(n, m), same| (n + 1.0, m + f64::from(u8::from(same))));
        seen >= (AGAIN.0 * count).max(3.0) && again >= AGAIN.1 * expected * seen
    })
}

/// The place of a node in the cell of a lattice of nodes.
fn place_in(node: &Node, [wide, slant, high]: [i64; 3]) -> (i64, i64) {
    let rows = node[1].div_euclid(high);
    ((node[0] - rows * slant).rem_euclid(wide), node[1].rem_euclid(high))
}
