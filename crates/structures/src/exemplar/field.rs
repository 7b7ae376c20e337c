//! The field of the exemplar on a grid: the sum of its Gaussians and the slopes of that sum.

use arabesque_core::{Bounds, Budget, Error, Result, Vector, rounded};
use rayon::prelude::*;

use super::channels::{BLOCK, LANES, Weights};
use crate::energy::{exp::exp, kernel::Kernel};

/// Nodes of the grid in one width of a Gaussian that stands for a point.
const FINENESS: f64 = 2.5;
/// Where Gaussians end, in units of their width.
const END: f64 = 2.3;
/// Most bytes of one grid; a coarser one beyond.
const MOST: f64 = 260e6;
/// Most bytes of a field that is as coarse as it may be.
const LARGEST: f64 = 600e6;

/// Values and slopes at the nodes of a grid, read with an error of the third order of its step.
#[derive(Clone, Debug)]
pub(crate) struct Field<const D: usize> {
    origin: [f32; D],
    per_unit: f32,
    step: f32,
    counts: [usize; D],
    strides: [usize; D],
    blocks: usize,
    /// For each node and block of channels the values, then the slopes along each coordinate.
    nodes: Vec<f32>,
}

impl<const D: usize> Field<D> {
    /// The field of points with weights under the Gaussians of `kernel`.
    ///
    /// # Errors
    /// When the grid takes more than the budget has.
    pub(crate) fn new(
        places: &[Vector<D>],
        weights: &[Weights],
        blocks: usize,
        kernel: &Kernel<D>,
        budget: &Budget,
    ) -> Result<Self> {
        let end = [END / kernel.sharpness().sqrt(); D];
        let bounds = Bounds::around(places.iter().copied());
        let size = bounds.size();
        let node_bytes = (4 * (1 + D) * blocks * BLOCK) as f64;
        let mut step = kernel.sigma / FINENESS;
        let count = |step: f64| -> [f64; D] { std::array::from_fn(|k| ((size[k] + 2.0 * end[k]) / step).ceil() + 2.0) };
        while count(step).iter().product::<f64>() * node_bytes > MOST {
            step *= 1.1;
        }
        step = step.min(kernel.sigma);
        if count(step).iter().product::<f64>() * node_bytes > LARGEST {
            return Err(Error::Limit {
                what: "bytes of the field of the exemplar, with a node for each spacing of its points".into(),
                found: rounded(count(kernel.sigma).iter().product::<f64>() * node_bytes),
                limit: rounded(LARGEST),
                advice: "give a smaller piece of the structure, or leave out points far from all others".into(),
            });
        }
        let counts = count(step).map(|n| n as usize);
        let mut strides = [1; D];
        for k in 1..D {
            strides[k] = strides[k - 1] * counts[k - 1];
        }
        let nodes: usize = counts.iter().product();
        budget.spend(nodes as u64 * 20)?;
        let origin = std::array::from_fn(|k| (bounds.min[k] - end[k]) as f32);
        let mut field = Self {
            origin,
            per_unit: (1.0 / step) as f32,
            step: step as f32,
            counts,
            strides,
            blocks,
            nodes: vec![0.0; nodes * (1 + D) * blocks * BLOCK],
        };
        field.fill((places, weights), kernel, &end, budget)?;
        Ok(field)
    }

    /// Adds the Gaussians, slab by slab along the last coordinate, each slab by one thread.
    fn fill(
        &mut self,
        (places, weights): (&[Vector<D>], &[Weights]),
        kernel: &Kernel<D>,
        end: &[f64; D],
        budget: &Budget,
    ) -> Result<()> {
        let (last, sharp) = (D - 1, kernel.sharpness());
        let record = (1 + D) * self.blocks * BLOCK;
        let slab = self.strides[last] * record;
        let (origin, step, counts, strides) = (self.origin, self.step, self.counts, self.strides);
        let span = |p: &Vector<D>, k: usize| {
            let at = |x: f64| (x - f64::from(origin[k])) / f64::from(step);
            let low = at(p[k] - end[k]).ceil().max(0.0) as usize;
            (low, (at(p[k] + end[k]).floor().max(0.0) as usize).min(counts[k] - 1))
        };
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by(|&a, &b| places[a][last].total_cmp(&places[b][last]).then(a.cmp(&b)));
        let channels = (self.blocks * BLOCK) as u64;
        self.nodes.par_chunks_mut(slab).enumerate().try_for_each(|(z, nodes)| {
            let mut meter = budget.meter();
            let height = f64::from(origin[last]) + z as f64 * f64::from(step);
            let from = order.partition_point(|&i| places[i][last] < height - end[last]);
            for &i in order[from..].iter().take_while(|&&i| places[i][last] <= height + end[last]) {
                let p = &places[i];
                let high = height - p[last];
                let tall = (-high * high * sharp).exp();
                let spans: [(usize, usize); D] = std::array::from_fn(|k| if k == last { (0, 0) } else { span(p, k) });
                let rows = if D == 3 { spans[1].0..=spans[1].1 } else { 0..=0 };
                meter.spend(((rows.clone().count() * (spans[0].1 + 1 - spans[0].0)) as u64) * (10 + 2 * channels))?;
                for y in rows {
                    let wide = f64::from(origin[1]) + y as f64 * f64::from(step) - p[1];
                    let side = if D == 3 { (-wide * wide * sharp).exp() } else { 1.0 };
                    for x in spans[0].0..=spans[0].1 {
                        let along = f64::from(origin[0]) + x as f64 * f64::from(step) - p[0];
                        let gauss = tall * side * f64::from(exp((-along * along * sharp) as f32));
                        let offset: [f64; D] = std::array::from_fn(|k| {
                            if k == last {
                                high
                            } else if k == 0 {
                                along
                            } else {
                                wide
                            }
                        });
                        let node = x + if D == 3 { y * strides[1] } else { 0 };
                        let record = &mut nodes[node * record..(node + 1) * record];
                        let slopes: [f32; D] = std::array::from_fn(|k| (-2.0 * offset[k] * sharp * gauss) as f32);
                        for (part, w) in record.chunks_exact_mut((1 + D) * BLOCK).zip(weights[i].chunks_exact(BLOCK)) {
                            for (n, part) in part.chunks_exact_mut(BLOCK).enumerate() {
                                let factor = if n == 0 { gauss as f32 } else { slopes[n - 1] };
                                for (v, w) in part.iter_mut().zip(w) {
                                    *v += factor * w;
                                }
                            }
                        }
                    }
                }
            }
            Ok(())
        })?;
        budget.spend(0)
    }

    /// Number of the lowest corner of the cell at `y`, and how far into the cell it is; `None` where the field is zero.
    #[inline]
    fn cell(&self, y: &[f32; D]) -> Option<(usize, [f32; D])> {
        let mut node = 0;
        let mut into = [0.0; D];
        for k in 0..D {
            let at = (y[k] - self.origin[k]) * self.per_unit;
            if !(at >= 0.0 && at < (self.counts[k] - 1) as f32) {
                return None;
            }
            let low = at as i32;
            into[k] = at - low as f32;
            node += low as usize * self.strides[k];
        }
        Some((node, into))
    }

    /// Calls `visit` with the corners of the cell at `y`: the share of each, the way from there to `y`, halved, and its record.
    #[inline(always)]
    fn corners(&self, y: &[f32; D], mut visit: impl FnMut(f32, &[f32; D], &[f32])) {
        let Some((node, into)) = self.cell(y) else { return };
        let record = (1 + D) * self.blocks * BLOCK;
        for corner in 0..1_usize << D {
            let (mut share, mut at) = (1.0, node);
            let mut off = [0.0_f32; D];
            for k in 0..D {
                let far = corner >> k & 1;
                share *= if far == 1 { into[k] } else { 1.0 - into[k] };
                off[k] = 0.5 * self.step * (into[k] - far as f32);
                at += far * self.strides[k];
            }
            visit(share, &off, &self.nodes[at * record..(at + 1) * record]);
        }
    }

    /// Inner product of the field at `y` with `weights`.
    #[inline]
    pub(crate) fn project(&self, y: &[f32; D], weights: &Weights) -> f32 {
        let mut sums = [0.0_f32; BLOCK];
        self.corners(y, |share, off, record| {
            for (part, w) in record.chunks_exact((1 + D) * BLOCK).zip(weights.chunks_exact(BLOCK)) {
                let mut v = lanes(part, 0);
                for k in 0..D {
                    let slope = lanes(part, 1 + k);
                    (0..BLOCK).for_each(|l| v[l] += off[k] * slope[l]);
                }
                (0..BLOCK).for_each(|l| sums[l] += share * v[l] * w[l]);
            }
        });
        sums[0] + sums[1] + (sums[2] + sums[3])
    }

    /// As [`Field::project`], but from the nearest node alone, with an error of the second order: enough to tell good matches from bad ones.
    #[inline]
    pub(crate) fn glimpse(&self, y: &[f32; D], weights: &Weights) -> f32 {
        let Some((mut node, into)) = self.cell(y) else { return 0.0 };
        let mut off = [0.0_f32; D];
        for k in 0..D {
            let far = usize::from(into[k] > 0.5);
            node += far * self.strides[k];
            off[k] = self.step * (into[k] - far as f32);
        }
        let record = (1 + D) * self.blocks * BLOCK;
        let mut sums = [0.0_f32; BLOCK];
        let record = &self.nodes[node * record..(node + 1) * record];
        for (part, w) in record.chunks_exact((1 + D) * BLOCK).zip(weights.chunks_exact(BLOCK)) {
            let mut v = lanes(part, 0);
            for k in 0..D {
                let slope = lanes(part, 1 + k);
                (0..BLOCK).for_each(|l| v[l] += off[k] * slope[l]);
            }
            (0..BLOCK).for_each(|l| sums[l] += v[l] * w[l]);
        }
        sums[0] + sums[1] + (sums[2] + sums[3])
    }

    /// As [`Field::project`], with the slope of the inner product.
    #[inline]
    pub(crate) fn project_slope(&self, y: &[f32; D], weights: &Weights) -> (f32, [f32; D]) {
        let mut sums = [0.0_f32; BLOCK];
        let mut slopes = [[0.0_f32; BLOCK]; D];
        self.corners(y, |share, off, record| {
            for (part, w) in record.chunks_exact((1 + D) * BLOCK).zip(weights.chunks_exact(BLOCK)) {
                let mut v = lanes(part, 0);
                let w: [f32; BLOCK] = std::array::from_fn(|l| share * w[l]);
                for k in 0..D {
                    let slope = lanes(part, 1 + k);
                    (0..BLOCK).for_each(|l| v[l] += off[k] * slope[l]);
                    (0..BLOCK).for_each(|l| slopes[k][l] += w[l] * slope[l]);
                }
                (0..BLOCK).for_each(|l| sums[l] += v[l] * w[l]);
            }
        });
        let total = |s: &[f32; BLOCK]| s[0] + s[1] + (s[2] + s[3]);
        (total(&sums), std::array::from_fn(|k| total(&slopes[k])))
    }

    /// The field at `y`.
    #[inline]
    pub(crate) fn value(&self, y: &[f32; D]) -> Weights {
        let mut sums = [0.0_f32; LANES];
        self.corners(y, |share, off, record| {
            for (part, sums) in record.chunks_exact((1 + D) * BLOCK).zip(sums.chunks_exact_mut(BLOCK)) {
                let mut v = lanes(part, 0);
                for k in 0..D {
                    let slope = lanes(part, 1 + k);
                    (0..BLOCK).for_each(|l| v[l] += off[k] * slope[l]);
                }
                (0..BLOCK).for_each(|l| sums[l] += share * v[l]);
            }
        });
        sums
    }
}

/// Block `n` of a record.
#[inline(always)]
fn lanes(part: &[f32], n: usize) -> [f32; BLOCK] {
    let mut lanes = [0.0; BLOCK];
    lanes.copy_from_slice(&part[n * BLOCK..(n + 1) * BLOCK]);
    lanes
}
