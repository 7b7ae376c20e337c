//! Columns of pixels along the edges of pieces, and what it costs to put two of them side by side [Zhou 2013 §1.3, `extractColumns`].

use arabesque_core::Vector;
use rayon::prelude::*;

use crate::{cage::Form, strip::Strip, valid::Position};

/// Cost of an opaque pixel beside a transparent one, in 8-bit colour steps [Zhou 2013, "comparing pixels"].
pub(crate) const GAMMA: f32 = 1024.0;
/// The largest distance of two premultiplied colours.
const LARGEST: f32 = 441.68;
/// Left columns that are compared at once.
pub(crate) const LANES: usize = 16;
/// Parts of a column whose sums bound its cost from below.
pub(crate) const BLOCKS: usize = 8;
/// Numbers in a summary: premultiplied colour and weighted alpha of every block.
pub(crate) const SUMMARY: usize = 4 * BLOCKS;

/// One number for each of [`LANES`] columns.
pub(crate) type Lanes = [f32; LANES];
/// Sums of the blocks of a column, alpha weighted so that distances of sums bound costs.
pub(crate) type Summary = [f32; SUMMARY];

/// ξ(p, q): colours premultiplied, all four in [0, 255]; continuous in alpha and equal to the paper's at 0 and 255.
pub(crate) fn pixel_cost(p: [f32; 4], q: [f32; 4]) -> f32 {
    let (r, g, b) = (p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    let colour = (r * r + g * g + b * b).sqrt();
    let alpha = (p[3] - q[3]).abs() * (1.0 / 255.0);
    colour + alpha * (GAMMA - colour)
}

/// The pixels along one edge for every position of a piece.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    rows: usize,
    pixels: Vec<[f32; 4]>,
}

impl Columns {
    /// Left edges: L + u.
    pub(crate) fn left(strip: &Strip, form: &Form, positions: &[Position]) -> Self {
        let rows = form.rows();
        let at = |k: usize| Vector::xy(0.5, (k as f64 + 0.5) * form.left / rows as f64);
        Self::extract(strip, positions, &(0..rows).map(at).collect::<Vec<_>>())
    }

    /// Right edges: R + v, sampled at as many `rows` as the left edge that follows.
    pub(crate) fn right(strip: &Strip, form: &Form, rows: usize, positions: &[Position]) -> Self {
        let at = |k: usize| form.top + (form.bottom - form.top) * ((k as f64 + 0.5) / rows as f64) + Vector::xy(0.5, 0.0);
        Self::extract(strip, positions, &(0..rows).map(at).collect::<Vec<_>>())
    }

    fn extract(strip: &Strip, positions: &[Position], offsets: &[Vector<2>]) -> Self {
        let column = |p: &Position| {
            let span = &strip.spans[strip.owner(usize::from(p.x))];
            let corner = Vector::xy(f64::from(p.x), f64::from(p.y));
            offsets.iter().map(|&o| strip.sample(corner + o, span)).collect::<Vec<_>>()
        };
        let pixels = positions.par_iter().with_min_len(64).flat_map_iter(column).collect();
        Self { rows: offsets.len(), pixels }
    }

    /// The pixels of column `k`.
    pub(crate) fn get(&self, k: usize) -> &[[f32; 4]] {
        &self.pixels[k * self.rows..][..self.rows]
    }

    /// Number of columns.
    pub(crate) fn len(&self) -> usize {
        self.pixels.len().checked_div(self.rows).unwrap_or(0)
    }

    /// Sums over the blocks of every column.
    pub(crate) fn summaries(&self) -> Vec<Summary> {
        (0..self.len()).into_par_iter().with_min_len(256).map(|k| summary(self.get(k))).collect()
    }
}

fn summary(column: &[[f32; 4]]) -> Summary {
    let mut sums = [0.0; SUMMARY];
    let n = column.len();
    for (k, pixel) in column.iter().enumerate() {
        let block = &mut sums[k * BLOCKS / n * 4..][..4];
        block.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
    }
    sums.chunks_exact_mut(4).for_each(|block| block[3] *= (GAMMA - LARGEST) / 255.0);
    sums
}

/// D(v + R, u + L) of one pair, summed from top to bottom.
pub(crate) fn column_cost(right: &[[f32; 4]], left: &[[f32; 4]]) -> f32 {
    right.iter().zip(left).fold(0.0, |sum, (p, q)| sum + pixel_cost(*p, *q))
}

/// Up to [`LANES`] left columns, pixel by pixel side by side.
#[derive(Clone, Debug)]
pub(crate) struct Bundle {
    pixels: Vec<[Lanes; 4]>,
    summary: Vec<Lanes>,
}

impl Bundle {
    /// The columns `members`; the last is repeated to fill the lanes.
    pub(crate) fn new(columns: &Columns, summaries: &[Summary], members: &[u32]) -> Self {
        let of = |lane: usize| members[lane.min(members.len() - 1)] as usize;
        let pixel = |row: usize| {
            std::array::from_fn(|channel| std::array::from_fn(|lane| columns.get(of(lane))[row][channel]))
        };
        let value = |k: usize| std::array::from_fn(|lane| summaries[of(lane)][k]);
        Self { pixels: (0..columns.rows).map(pixel).collect(), summary: (0..SUMMARY).map(value).collect() }
    }

    /// A lower bound of [`Bundle::costs`], from the sums over blocks and the triangle inequality.
    pub(crate) fn bounds(&self, right: &Summary) -> Lanes {
        let mut sum = [0.0; LANES];
        for (block, r) in self.summary.chunks_exact(4).zip(right.chunks_exact(4)) {
            for lane in 0..LANES {
                let [x, y, z, w] = std::array::from_fn(|k| block[k][lane] - r[k]);
                sum[lane] += (x * x + y * y + z * z).sqrt() + w.abs();
            }
        }
        sum
    }

    /// D of `right` beside every lane; gives up with larger numbers than `limits` once every lane is over its limit.
    pub(crate) fn costs(&self, right: &[[f32; 4]], limits: &Lanes) -> Lanes {
        let mut sum = [0.0; LANES];
        for (left, right) in self.pixels.chunks(16).zip(right.chunks(16)) {
            for (q, p) in left.iter().zip(right) {
                add(&mut sum, q, *p);
            }
            if sum.iter().zip(limits).all(|(s, limit)| s > limit) {
                return sum;
            }
        }
        sum
    }
}

/// Adds the cost of one row of pixels to the sums, in the same order of operations as [`pixel_cost`].
fn add(sum: &mut Lanes, q: &[Lanes; 4], p: [f32; 4]) {
    for lane in 0..LANES {
        let (r, g, b) = (p[0] - q[0][lane], p[1] - q[1][lane], p[2] - q[2][lane]);
        let colour = (r * r + g * g + b * b).sqrt();
        let alpha = (p[3] - q[3][lane]).abs() * (1.0 / 255.0);
        sum[lane] += colour + alpha * (GAMMA - colour);
    }
}

/// Distance of two pixels by all four channels.
pub(crate) fn column_norm(p: [f32; 4], q: [f32; 4]) -> f32 {
    (0..4).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f32>().sqrt()
}
