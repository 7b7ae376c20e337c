//! A grid of which only blocks near points are there.

use arabesque_core::{Bounds, Budget, Error, Held, Result, Vector, rounded};
use rayon::prelude::*;

/// Nodes along the side of a block.
pub(crate) const SIDE: usize = 8;
/// Nodes of a block.
pub(crate) const BLOCK: usize = SIDE * SIDE * SIDE;
/// Balls whose blocks are listed, and entries that are sorted, before somebody is asked whether to stop; and most parts in which is sorted.
const CHUNK: usize = 4096;
const PARTS: usize = 16;
/// Bits of a key for each coordinate of a block.
const BITS: u32 = 21;

/// Blocks of nodes near balls, each with the balls that may reach a node of it.
#[derive(Debug)]
pub(crate) struct Blocks {
    /// The node with number 0 along each coordinate.
    pub(crate) origin: Vector<3>,
    /// Distance of nodes.
    pub(crate) cell: f64,
    /// Places of the blocks, packed, in rising order.
    keys: Vec<u64>,
    /// Balls of block `b`: `starts[b]..starts[b + 1]`.
    starts: Vec<u32>,
    balls: Vec<u32>,
    _held: Held,
}

impl Blocks {
    /// The blocks that balls with these centres and radii reach.
    pub(crate) fn new(centres: &[Vector<3>], radii: &[f64], cell: f64, budget: &Budget) -> Result<Self> {
        let bounds =
            centres.iter().zip(radii).fold(Bounds::EMPTY, |all, (&c, &r)| all.union(&Bounds::new(c, c).grown(r)));
        // Off from round numbers, so that points on a lattice do not fall on nodes.
        let origin = bounds.min - Vector([0.519, 0.547, 0.503]) * cell;
        let side = cell * SIDE as f64;
        let along = bounds.size().0.iter().fold(0.0_f64, |a, &b| a.max(b)) / side;
        if along.is_nan() || along >= f64::from(1_u32 << BITS) - 4.0 {
            let most =
                bounds.size().0.iter().fold(0.0_f64, |a, &b| a.max(b)) / (f64::from(1_u32 << BITS) * SIDE as f64);
            let apart = rounded(bounds.size().0.iter().fold(0.0_f64, |a, &b| a.max(b)));
            return Err(Error::Limit {
                what: format!("cells of {} over points that lie {apart} apart", rounded(cell)),
                found: rounded(along * SIDE as f64),
                limit: rounded(f64::from(1_u32 << BITS) * SIDE as f64),
                advice: format!(
                    "remove points that lie far from all others, or set cell to more than {}",
                    rounded(most)
                ),
            });
        }
        let range = |c: Vector<3>, r: f64| {
            let at = |v: f64, k: usize| ((v - origin[k]) / side).floor().max(0.0) as u64;
            std::array::from_fn::<_, 3, _>(|k| (at(c[k] - r, k), at(c[k] + r, k)))
        };
        let count =
            |(&c, &r): (&Vector<3>, &f64)| range(c, r).iter().map(|(a, b)| b - a + 1).fold(1_u64, u64::saturating_mul);
        let pairs = centres.iter().zip(radii).map(count).fold(0_u64, u64::saturating_add);
        budget.foresee(pairs.saturating_mul(60))?;
        let held =
            budget.hold("cells around the points", usize::try_from(pairs).unwrap_or(usize::MAX).saturating_mul(20))?;
        budget.spend(pairs * 60)?;
        let of_ball = |i: usize| {
            let [x, y, z] = range(centres[i], radii[i]);
            let plane =
                move |z: u64| (y.0..=y.1).flat_map(move |y| (x.0..=x.1).map(move |x| (packed([x, y, z]), i as u32)));
            (z.0..=z.1).flat_map(plane).collect::<Vec<_>>()
        };
        let of_chunk = |c: usize| -> Result<Vec<(u64, u32)>> {
            budget.check()?;
            Ok((c * CHUNK..(c * CHUNK + CHUNK).min(centres.len())).flat_map(of_ball).collect())
        };
        let chunks: Result<Vec<_>> = (0..centres.len().div_ceil(CHUNK)).into_par_iter().map(of_chunk).collect();
        let mut reached = Vec::with_capacity(usize::try_from(pairs).unwrap_or(0));
        chunks?.into_iter().for_each(|chunk| reached.extend(chunk));
        sort(&mut reached, budget)?;
        let (mut keys, mut starts) = (Vec::new(), Vec::new());
        for (k, &(key, _)) in reached.iter().enumerate() {
            if keys.last() != Some(&key) {
                keys.push(key);
                starts.push(k as u32);
            }
        }
        starts.push(reached.len() as u32);
        Ok(Self { origin, cell, keys, starts, balls: reached.iter().map(|r| r.1).collect(), _held: held })
    }

    /// Number of blocks.
    pub(crate) fn len(&self) -> usize {
        self.keys.len()
    }

    /// The balls that may reach a block, in rising order.
    pub(crate) fn balls(&self, block: usize) -> &[u32] {
        &self.balls[self.starts[block] as usize..self.starts[block + 1] as usize]
    }

    /// Place of a block among blocks.
    pub(crate) fn place(&self, block: usize) -> [u64; 3] {
        let mask = (1 << BITS) - 1;
        let key = self.keys[block];
        [key & mask, key >> BITS & mask, key >> (2 * BITS)]
    }

    /// The block at a place.
    pub(crate) fn at(&self, place: [u64; 3]) -> Option<usize> {
        self.keys.binary_search(&packed(place)).ok()
    }

    /// Where the first node of a block is.
    pub(crate) fn corner(&self, block: usize) -> Vector<3> {
        self.corner_at(self.place(block))
    }

    /// Where the first node of a block at a place is, or would be.
    pub(crate) fn corner_at(&self, place: [u64; 3]) -> Vector<3> {
        self.origin + Vector(place.map(|i| (i * SIDE as u64) as f64)) * self.cell
    }

    /// Blocks of the same grid at other places, which no ball is known to reach.
    pub(crate) fn of_places(&self, places: Vec<[u64; 3]>, budget: &Budget) -> Result<Self> {
        let held = budget.hold("cells along the mesh that trims", places.len() * 12)?;
        let mut keys: Vec<u64> = places.into_iter().map(packed).collect();
        keys.sort_unstable();
        keys.dedup();
        let starts = vec![0; keys.len() + 1];
        Ok(Self { origin: self.origin, cell: self.cell, keys, starts, balls: Vec::new(), _held: held })
    }
}

/// Sorts a long list in parts, so that a request to stop is heard between them.
fn sort<T: Ord + Copy + Send>(list: &mut [T], budget: &Budget) -> Result<()> {
    for part in list.chunks_mut((list.len() / PARTS).max(CHUNK)) {
        budget.check()?;
        part.par_sort_unstable();
    }
    budget.check()?;
    // Runs that are in order are merged.
    list.par_sort();
    Ok(())
}

fn packed([x, y, z]: [u64; 3]) -> u64 {
    x | y << BITS | z << (2 * BITS)
}

/// The nodes of a block that a ball may reach: first and last along each coordinate. `offset` is from the first node to the ball's centre, in cells.
pub(super) fn reached(offset: Vector<3>, radius: f64) -> [(usize, usize); 3] {
    std::array::from_fn(|k| {
        let low = (offset[k] - radius).ceil().max(0.0) as usize;
        // An empty range where the ball ends before the block.
        let high = (offset[k] + radius).floor();
        (low, if high < 0.0 { 0 } else { (high as usize + 1).min(SIDE) })
    })
}

/// What is known at a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// Negative inside, about the distance in cells near the surface; NaN where nothing is known.
    pub(crate) value: f32,
    /// How the value changes from cell to cell: outwards.
    pub(crate) gradient: [f32; 3],
    /// How far beyond the border of the points: at 1 an open surface ends.
    pub(crate) beyond: f32,
}

impl Node {
    /// A node far from all points.
    pub(crate) const UNKNOWN: Self = Self { value: f32::NAN, gradient: [0.0; 3], beyond: f32::INFINITY };
}

/// A list of one value; that of a large field takes a while.
fn filled<T: Copy>(value: T, count: usize, budget: &Budget) -> Result<Vec<T>> {
    let mut list = Vec::with_capacity(count);
    while list.len() < count {
        budget.check()?;
        list.resize(count.min(list.len() + CHUNK * BLOCK / 4), value);
    }
    Ok(list)
}

/// A function at the nodes of blocks.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) blocks: Blocks,
    /// The nodes block by block, in each with x fastest.
    pub(crate) nodes: Vec<Node>,
    /// Colours at the nodes, where points have some.
    pub(crate) colours: Vec<[f32; 3]>,
    /// What is known of nodes in no block.
    pub(crate) elsewhere: Node,
    _held: Held,
}

impl Field {
    /// Memory of the nodes of a field over these blocks, in bytes.
    pub(crate) fn bytes(blocks: &Blocks, has_colours: bool) -> usize {
        let each = size_of::<Node>() + if has_colours { size_of::<[f32; 3]>() } else { 0 };
        (blocks.len() * BLOCK).saturating_mul(each)
    }

    /// A field with nodes from `evaluate`, which is given a block's number, its nodes, and their colours, if any.
    pub(crate) fn new(
        blocks: Blocks,
        elsewhere: Node,
        has_colours: bool,
        budget: &Budget,
        evaluate: impl Fn(&Blocks, usize, &mut [Node], &mut [[f32; 3]]) -> Result<()> + Sync,
    ) -> Result<Self> {
        let count = blocks.len() * BLOCK;
        let held = budget.hold("nodes near the points", Self::bytes(&blocks, has_colours))?;
        let mut nodes = filled(elsewhere, count, budget)?;
        let mut colours = filled([0.0; 3], if has_colours { count } else { 0 }, budget)?;
        if has_colours {
            let parts = nodes.par_chunks_mut(BLOCK).zip(colours.par_chunks_mut(BLOCK)).enumerate();
            parts.try_for_each(|(b, (nodes, colours))| evaluate(&blocks, b, nodes, colours))?;
        } else {
            nodes.par_chunks_mut(BLOCK).enumerate().try_for_each(|(b, nodes)| evaluate(&blocks, b, nodes, &mut []))?;
        }
        Ok(Self { blocks, nodes, colours, elsewhere, _held: held })
    }
}
