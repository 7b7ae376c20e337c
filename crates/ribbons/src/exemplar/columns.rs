//! Columns of pixels along the edges of pieces, and what it costs to put two of them side by side [Zhou 2013 §1.3, `extractColumns`].

use arabesque_core::{Budget, Held, Result, Vector};
use rayon::prelude::*;

use crate::{constraints::valid::Position, exemplar::strip::Strip, geometry::cage::Form};

/// Cost of an opaque pixel beside a transparent one, in 8-bit colour steps [Zhou 2013, "comparing pixels"].
pub(crate) const GAMMA: f32 = 1024.0;
/// The largest distance of two premultiplied colours.
const LARGEST: f32 = 441.68;
/// Weight of slopes beside pixels where the context counts fully.
const SLOPES: f64 = 3.0;
/// How far the ink of two columns may be apart, beside what it spreads, before it counts as broken, in heights of the column; what is
/// less, stitching mends.
const BROKEN: f32 = 0.03;
/// Left columns whose bounds are computed at once.
pub(crate) const LANES: usize = 8;
/// Parts of a column whose sums bound its cost from below.
pub(crate) const BLOCKS: usize = 8;
/// Numbers of a pixel: premultiplied red, green and blue, alpha, and the slopes of alpha and of brightness, all in 8-bit steps.
pub(crate) const CHANNELS: usize = 6;
/// Numbers in a summary: those of every block.
pub(crate) const SUMMARY: usize = CHANNELS * BLOCKS;
/// Rows of pixels that are compared at once.
const WIDE: usize = 4;

/// Work of sampling one pixel of a column, and of adding it to the sums of its block.
const SAMPLE: u64 = 12;
const SUM: u64 = 1;
/// Columns that are summed up before their work is counted.
const SUMMED: usize = 256;

/// One number for each of [`LANES`] columns.
pub(crate) type Lanes = [f32; LANES];
/// What is known of a column block by block.
#[derive(Clone, Debug)]
pub(crate) struct Summary {
    /// Sums over the blocks, alpha weighted so that distances of sums bound costs.
    pub(crate) sums: [f32; SUMMARY],
    /// A bit for each block that is not empty.
    filled: u8,
}

impl Summary {
    fn block(&self, block: usize) -> &[f32; CHANNELS] {
        &self.sums.as_chunks::<CHANNELS>().0[block]
    }
}

/// ξ(p, q) of [`WIDE`] pairs of pixels, added to `sum`: colours premultiplied, alpha in [0, 255], channel by channel.
/// Continuous in alpha and, except for the slopes, equal to the paper's where alpha is 0 or 255.
fn add_costs(sum: &mut [f32; WIDE], p: &Chunk, q: &Chunk) {
    for k in 0..WIDE {
        let (r, g, b) = (p[0][k] - q[0][k], p[1][k] - q[1][k], p[2][k] - q[2][k]);
        let colour = (r * r + g * g + b * b).sqrt();
        let alpha = (p[3][k] - q[3][k]).abs() * (1.0 / 255.0);
        let slope = (p[4][k] - q[4][k]).abs() + (p[5][k] - q[5][k]).abs();
        sum[k] += colour + alpha * (GAMMA - colour) + slope;
    }
}

/// [`WIDE`] pixels, channel by channel.
type Chunk = [[f32; WIDE]; CHANNELS];

/// The pixels along one edge for every position of a piece. Columns are filled up with transparent pixels to whole blocks.
#[derive(Debug)]
pub(crate) struct Columns {
    rows: usize,
    /// Chunks of a block.
    block: usize,
    chunks: Vec<Chunk>,
    /// Where the ink of each column crosses the edge.
    crossings: Vec<Crossing>,
    /// Their memory.
    _held: [Held; 2],
}

/// Where ink crosses an edge, weighted by alpha.
#[derive(Clone, Copy, Debug, Default)]
struct Crossing {
    /// Rows of it.
    mass: f32,
    /// The middle of it, and how far it spreads from there on both sides, in rows.
    middle: f32,
    spread: f32,
}

impl Crossing {
    fn of(rows: usize, alpha: impl Fn(usize) -> f32) -> Self {
        let (mut mass, mut moment, mut square) = (0.0, 0.0, 0.0);
        for row in 0..rows {
            let (share, at) = (alpha(row) / 255.0, row as f32 + 0.5);
            mass += share;
            moment += share * at;
            square += share * at * at;
        }
        if mass <= 0.0 {
            return Self::default();
        }
        let middle = moment / mass;
        Self { mass, middle, spread: (square / mass - middle * middle).max(0.0).sqrt() }
    }

    /// What it costs beside the pixels that a pattern breaks off here and goes on elsewhere. Pixels tell nothing of how far that is once
    /// a thin stem has left itself, so that one large break would be as good as one small one.
    fn gap(self, other: Self, rows: usize) -> f32 {
        let (least, most) = (self.mass.min(other.mass), self.mass.max(other.mass));
        let allowed = BROKEN * rows as f32;
        let beyond = (self.middle - other.middle).abs() - allowed - 0.5 * self.spread.max(other.spread);
        if beyond <= 0.0 || least <= 0.0 {
            return 0.0;
        }
        // The middle of a stem beside that of a stem with a leaf says little.
        GAMMA * rows as f32 * (beyond / allowed) * (least / most)
    }
}

impl Columns {
    /// Left edges: L + u.
    pub(crate) fn left(
        strip: &Strip,
        form: &Form,
        context: f64,
        positions: &[Position],
        budget: &Budget,
    ) -> Result<Self> {
        Self::extract(strip, positions, &taps([Vector::ZERO, form.foot], form.rows(), context), budget)
    }

    /// Right edges: R + v, sampled at as many `rows` as the left edge that follows.
    pub(crate) fn right(
        strip: &Strip,
        (form, rows): (&Form, usize),
        context: f64,
        positions: &[Position],
        budget: &Budget,
    ) -> Result<Self> {
        Self::extract(strip, positions, &taps([form.top, form.bottom], rows, context), budget)
    }

    fn extract(strip: &Strip, positions: &[Position], taps: &[Tap], budget: &Budget) -> Result<Self> {
        let rows = taps.len();
        let block = rows.div_ceil(BLOCKS).div_ceil(WIDE);
        let count = (block * BLOCKS).saturating_mul(positions.len());
        let (mut chunks, held) = budget.list::<Chunk>("edges of one piece at all its places in the exemplar", count)?;
        chunks.resize(count, [[0.0; WIDE]; CHANNELS]);
        let (mut crossings, places) = budget.list("edges of one piece", positions.len())?;
        crossings.resize(positions.len(), Crossing::default());
        let columns = chunks.par_chunks_mut(block * BLOCKS).zip(positions).zip(&mut crossings);
        columns.with_min_len(64).try_for_each(|((column, p), crossing)| {
            budget.spend(SAMPLE * rows as u64)?;
            for (k, tap) in taps.iter().enumerate() {
                for (channel, value) in tap.sample(strip, *p).into_iter().enumerate() {
                    column[k / WIDE][channel][k % WIDE] = value;
                }
            }
            *crossing = Crossing::of(rows, |row| column[row / WIDE][3][row % WIDE]);
            Ok(())
        })?;
        Ok(Self { rows, block, chunks, crossings, _held: [held, places] })
    }

    /// Column `k`, block by block.
    fn blocks(&self, k: usize) -> std::slice::ChunksExact<'_, Chunk> {
        self.chunks[k * self.block * BLOCKS..][..self.block * BLOCKS].chunks_exact(self.block)
    }

    /// The pixels of column `k`, from top to bottom.
    pub(crate) fn pixels(&self, k: usize) -> Vec<[f32; 4]> {
        let column = &self.chunks[k * self.block * BLOCKS..];
        (0..self.rows).map(|row| std::array::from_fn(|channel| column[row / WIDE][channel][row % WIDE])).collect()
    }

    /// Sums over the blocks of every column.
    pub(crate) fn summaries(&self, budget: &Budget) -> Result<Vec<Summary>> {
        let n = self.chunks.len().checked_div(self.block * BLOCKS).unwrap_or(0);
        let part = |part: usize| {
            let columns = part * SUMMED..((part + 1) * SUMMED).min(n);
            budget.spend(SUM * (self.rows * columns.len()) as u64)?;
            Ok(columns.map(|k| self.summary(k)).collect())
        };
        let parts = (0..n.div_ceil(SUMMED)).into_par_iter().map(part).collect::<Result<Vec<Vec<Summary>>>>()?;
        Ok(parts.concat())
    }

    /// Work of comparing two columns in full.
    pub(crate) fn work(&self) -> u64 {
        2 * self.rows as u64
    }

    fn summary(&self, k: usize) -> Summary {
        let (mut sums, mut filled) = ([0.0; SUMMARY], 0);
        for (number, (sums, block)) in sums.chunks_exact_mut(CHANNELS).zip(self.blocks(k)).enumerate() {
            filled |= u8::from(block.as_flattened().as_flattened().iter().any(|&c| c != 0.0)) << number;
            for (channel, sum) in sums.iter_mut().enumerate() {
                *sum = block.iter().flat_map(|chunk| chunk[channel]).sum();
            }
            sums[3] *= (GAMMA - LARGEST) / 255.0;
        }
        Summary { sums, filled }
    }
}

/// Samples down an edge, and the slopes square to it: what lies ahead of it.
fn taps([top, bottom]: [Vector<2>; 2], rows: usize, context: f64) -> Vec<Tap> {
    let edge = bottom - top;
    let ahead = Vector::xy(edge[1], -edge[0]) * (SLOPES * context / edge.norm());
    let at = |k: usize| top + edge * ((k as f64 + 0.5) / rows as f64) + Vector::xy(0.5, 0.0);
    (0..rows).map(|k| Tap::new(at(k), ahead)).collect()
}

/// Where between four pixels a sample lies, the same for all positions.
struct Tap {
    x: i64,
    y: i64,
    /// Weights of the pixels: upper left and right, lower left and right.
    weights: [f32; 4],
    /// Direction and weight of the slopes.
    ahead: [f32; 2],
}

impl Tap {
    fn new(offset: Vector<2>, ahead: Vector<2>) -> Self {
        let (x, y) = (offset[0] - 0.5, offset[1] - 0.5);
        let (fx, fy) = ((x - x.floor()) as f32, (y - y.floor()) as f32);
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        Self { x: x.floor() as i64, y: y.floor() as i64, weights, ahead: ahead.0.map(|c| c as f32) }
    }

    fn sample(&self, strip: &Strip, p: Position) -> [f32; CHANNELS] {
        let (x, y) = (i64::from(p.x) + self.x, i64::from(p.y) + self.y);
        let mut sum = [0.0; CHANNELS];
        for (k, weight) in self.weights.into_iter().enumerate().filter(|(_, w)| *w > 0.0) {
            let ([r, g, b, a], slope) = strip.pixel_at(x + (k as i64 & 1), y + (k as i64 >> 1));
            let ahead = |k: usize| self.ahead[0] * slope[k] + self.ahead[1] * slope[k + 2];
            sum.iter_mut().zip([r, g, b, a, ahead(0), ahead(1)]).for_each(|(s, c)| *s += weight * c);
        }
        sum
    }
}

/// D(v + R, u + L) of column `v` of `right` beside column `u` of `left`: sums of blocks, from top to bottom.
pub(crate) fn column_cost(right: &Columns, v: usize, left: &Columns, u: usize) -> f32 {
    let pixels = right.blocks(v).zip(left.blocks(u)).fold(0.0, |sum, (p, q)| sum + block_cost(p, q));
    pixels + break_cost(right, v, left, u)
}

fn break_cost(right: &Columns, v: usize, left: &Columns, u: usize) -> f32 {
    right.crossings[v].gap(left.crossings[u], right.rows)
}

fn block_cost(p: &[Chunk], q: &[Chunk]) -> f32 {
    let mut sum = [0.0; WIDE];
    p.iter().zip(q).for_each(|(p, q)| add_costs(&mut sum, p, q));
    (sum[0] + sum[1]) + (sum[2] + sum[3])
}

/// The same as [`column_cost`], or `None` once it is certain to be above `limit`. `bounds` are those of the single blocks, negative for
/// blocks that are empty in both columns.
pub(crate) fn column_cost_within(
    (right, v): (&Columns, usize),
    (left, u): (&Columns, usize),
    bounds: &[f32; BLOCKS],
    limit: f32,
) -> Option<f32> {
    let mut rest = TRUST * bounds.iter().map(|b| b.max(0.0)).sum::<f32>();
    if rest > limit {
        return None;
    }
    let broken = break_cost(right, v, left, u);
    if rest + broken > limit {
        return None;
    }
    let mut sum = 0.0;
    let blocks = right.blocks(v).zip(left.blocks(u)).zip(bounds).filter(|(_, bound)| **bound >= 0.0);
    for ((p, q), bound) in blocks {
        rest -= bound * TRUST;
        sum += block_cost(p, q);
        if sum + rest + broken > limit {
            return None;
        }
    }
    Some(sum + broken)
}

/// Share of a lower bound that is believed, for the rounding of sums.
pub(crate) const TRUST: f32 = 0.9995;

/// Distance of two sums of one block: no more than the cost of its pixels.
fn distance(a: [f32; CHANNELS]) -> f32 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt() + a[3].abs() + a[4].abs() + a[5].abs()
}

/// Lower bounds for the blocks of one pair; -1 for blocks that are empty in both columns, which cost nothing.
pub(crate) fn block_bounds(right: &Summary, left: &Summary) -> [f32; BLOCKS] {
    let filled = right.filled | left.filled;
    std::array::from_fn(|block| {
        let (p, q) = (right.block(block), left.block(block));
        if filled >> block & 1 == 0 { -1.0 } else { distance(std::array::from_fn(|k| p[k] - q[k])) }
    })
}

/// The summaries of up to [`LANES`] left columns side by side.
#[derive(Clone, Debug)]
pub(crate) struct Bundle {
    /// The numbers of each block.
    blocks: [[Lanes; CHANNELS]; BLOCKS],
    /// A bit for each block that is not empty in all columns.
    filled: u8,
}

impl Bundle {
    /// The columns `members`; the last is repeated to fill the lanes.
    pub(crate) fn new(summaries: &[Summary], members: &[u32]) -> Self {
        let of = |lane: usize| &summaries[members[lane.min(members.len() - 1)] as usize];
        let number = |block: usize, k: usize| std::array::from_fn(|lane| of(lane).block(block)[k]);
        let blocks: [[Lanes; CHANNELS]; BLOCKS] =
            std::array::from_fn(|block| std::array::from_fn(|k| number(block, k)));
        let filled = (0..LANES).fold(0, |filled, lane| filled | of(lane).filled);
        Self { blocks, filled }
    }

    /// A lower bound on D of `right` beside every lane, from the sums over blocks and the triangle inequality.
    pub(crate) fn bounds(&self, right: &Summary) -> Lanes {
        let mut sum = [0.0; LANES];
        let filled = self.filled | right.filled;
        for (block, [r, g, b, a, e, f]) in self.blocks.iter().enumerate().filter(|(block, _)| filled >> block & 1 == 1)
        {
            let p = right.block(block);
            for lane in 0..LANES {
                let (x, y, z) = (r[lane] - p[0], g[lane] - p[1], b[lane] - p[2]);
                let rest = (a[lane] - p[3]).abs() + (e[lane] - p[4]).abs() + (f[lane] - p[5]).abs();
                sum[lane] += (x * x + y * y + z * z).sqrt() + rest;
            }
        }
        sum
    }
}

/// Distance of two pixels by all four channels.
pub(crate) fn column_norm(p: [f32; 4], q: [f32; 4]) -> f32 {
    (0..4).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f32>().sqrt()
}
