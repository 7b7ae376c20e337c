//! Signed distance and its gradient at the nodes of a grid [Duranleau 2008 §5.1].
//!
//! Distances end at a reach beyond which nothing is told: they are in units of it, and so weigh as much as gradients, which have length 1.

use arabesque_core::{Budget, Held, Result, Vector};
use arabesque_surface::OrientedPoints;
use rayon::prelude::*;

/// Numbers at a node: distance and gradient.
pub(crate) const CHANNELS: usize = 4;
/// Places of a row that are compared at once; behind each plane stand so many numbers that mean nothing.
pub(crate) const ABREAST: usize = 16;
/// Share of the differences of coloured textures that is their colours'.
const TINT: f32 = 0.35;
/// Colours that spread less than this are one colour.
const PLAIN: f32 = 1e-4;
/// Work units of a projection.
pub(crate) const PROJECTION: u64 = 3000;

/// Where the nodes of all grids are: columns stand at multiples of `cell`, and in each the same heights.
#[derive(Clone, Debug)]
pub(crate) struct Lattice {
    pub(crate) cell: f64,
    pub(crate) heights: Vec<f64>,
    /// How far distances are told.
    pub(crate) reach: f64,
}

impl Lattice {
    /// Planes of numbers: one for each height and channel.
    pub(crate) fn planes(&self) -> usize {
        self.heights.len() * CHANNELS
    }

    /// The numbers of one column, height by height.
    pub(crate) fn column(&self, points: &OrientedPoints, x: f64, y: f64, out: &mut Vec<f32>) {
        for &z in &self.heights {
            out.extend(self.at(points, Vector([x, y, z])));
        }
    }

    /// The colour of the topmost surface near a column.
    fn colour(&self, points: &OrientedPoints, (x, y): (f64, f64), colour: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        let (low, high) = (self.heights[0], self.heights[self.heights.len() - 1]);
        let reach = high - low + 2.0 * self.reach;
        let Some((first, _)) = points.nearest(Vector([x, y, high + self.reach]), reach, |_| true) else {
            return [0.5; 3];
        };
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        points.around(points.positions()[first], self.cell, |i, _| {
            let c = colour(i);
            sum = std::array::from_fn(|k| sum[k] + c[k]);
            count += 1.0;
        });
        sum.map(|c| c / count)
    }

    /// Distance and gradient at one node; zeros where there is no surface within reach.
    fn at(&self, points: &OrientedPoints, x: Vector<3>) -> [f32; CHANNELS] {
        let Some(foot) = points.project(x, self.reach, None) else { return [1.0, 0.0, 0.0, 0.0] };
        let way = x - foot.point;
        let far = way.norm();
        let sign = if way.dot(foot.normal) < 0.0 { -1.0 } else { 1.0 };
        let gradient = if far > 0.25 * self.cell { way * (sign / far) } else { foot.normal };
        // Towards the reach gradients fade, as there are none beyond.
        let fade = (2.0 - 2.0 * far / self.reach).clamp(0.0, 1.0);
        let [a, b, c] = gradient.0.map(|v| (v * fade) as f32);
        [(sign * (far / self.reach).min(1.0)) as f32, a, b, c]
    }
}

/// The field of the texture, plane by plane, row by row.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) planes: Vec<Vec<f32>>,
    /// The columns of a gap, which tell nothing of the texture; empty where there is none.
    unknown: Vec<bool>,
    /// What colours are multiplied by in the last three planes; 0 where there are none.
    pub(crate) tint: f32,
    _held: Held,
}

impl Field {
    /// Leaves out columns of which nothing is known, by where they stand as seen from the origin of the field.
    pub(crate) fn leave_out(&mut self, lattice: &Lattice, is_unknown: impl Fn(f64, f64) -> bool) {
        let at = |k: usize| (k as f64 + 0.5) * lattice.cell;
        let of = |k: usize| is_unknown(at(k % self.width), at(k / self.width));
        self.unknown = (0..self.width * self.height).map(of).collect();
    }

    /// The field by the means of nine columns each: what is narrower than a column or two is no detail but how points happened to lie.
    pub(crate) fn smoothed(&self, budget: &Budget) -> Result<Self> {
        let count = self.width * self.height;
        let held = budget.hold("the distance field", count * self.planes.len() * 4)?;
        budget.spend((count * self.planes.len()) as u64)?;
        let mean = |values: &[f32], k: usize, step: usize, (is_first, is_last): (bool, bool)| {
            let before = if is_first { values[k] } else { values[k - step] };
            let after = if is_last { values[k] } else { values[k + step] };
            (before + values[k] + after) / 3.0
        };
        let smooth = |values: &Vec<f32>| -> Vec<f32> {
            let ends = |k: usize| (k.is_multiple_of(self.width), (k + 1).is_multiple_of(self.width));
            let rows: Vec<f32> = (0..count).map(|k| mean(values, k, 1, ends(k))).collect();
            let ends = |k: usize| (k < self.width, k + self.width >= count);
            (0..count).map(|k| mean(&rows, k, self.width, ends(k))).collect()
        };
        let planes = self.planes.par_iter().map(smooth).collect();
        Ok(Self {
            planes,
            width: self.width,
            height: self.height,
            unknown: self.unknown.clone(),
            tint: self.tint,
            _held: held,
        })
    }

    /// Adds the colours of points, so that they have a say in what fits; nothing where all is of one colour.
    pub(crate) fn add_colours(
        &mut self,
        points: &OrientedPoints,
        colours: &[[f64; 3]],
        (lattice, origin): (&Lattice, [f64; 2]),
        budget: &Budget,
    ) -> Result<()> {
        let count = self.width * self.height;
        budget.spend(count as u64 * PROJECTION)?;
        let of = |k: usize| {
            let at = [k % self.width, k / self.width].map(|i| (i as f64 + 0.5) * lattice.cell);
            let colour = |i: usize| colours[i].map(|c| c as f32);
            lattice.colour(points, (origin[0] + at[0], origin[1] + at[1]), colour)
        };
        let seen: Vec<[f32; 3]> = (0..count).into_par_iter().map(of).collect();
        let colours: f32 = (0..3).map(|c| variance(seen.iter().map(|rgb| rgb[c]))).sum();
        if colours < PLAIN {
            return Ok(());
        }
        let shape: f32 = self.planes.iter().map(|p| variance(p[..count].iter().copied())).sum();
        let most = (lattice.heights.len() as f32).sqrt();
        self.tint = (TINT / (1.0 - TINT) * shape / colours).sqrt().min(most);
        for c in 0..3 {
            let numbers = seen.iter().map(|rgb| rgb[c] * self.tint);
            self.planes.push(numbers.chain([0.0; ABREAST]).collect());
        }
        Ok(())
    }

    /// Whether column `k` tells of the texture.
    pub(crate) fn is_known(&self, k: usize) -> bool {
        !self.unknown.get(k).is_some_and(|unknown| *unknown)
    }

    /// The field of points over `width` by `height` columns, the first of which stands half a cell beyond `origin`.
    pub(crate) fn new(
        points: &OrientedPoints,
        lattice: &Lattice,
        origin: [f64; 2],
        (width, height): (usize, usize),
        budget: &Budget,
    ) -> Result<Self> {
        let held = budget.hold("the distance field", width * height * lattice.planes() * 8)?;
        let rows: Result<Vec<Vec<f32>>> = (0..height)
            .into_par_iter()
            .map(|j| {
                let mut row = Vec::with_capacity(width * lattice.planes());
                for i in 0..width {
                    budget.spend(PROJECTION * lattice.heights.len() as u64)?;
                    let at = [i, j].map(|k| (k as f64 + 0.5) * lattice.cell);
                    lattice.column(points, origin[0] + at[0], origin[1] + at[1], &mut row);
                }
                Ok(row)
            })
            .collect();
        let rows = rows?;
        let planes = lattice.planes();
        let plane = |p: usize| {
            let numbers = rows.iter().flat_map(|row| row.iter().skip(p).step_by(planes).copied());
            numbers.chain([0.0; ABREAST]).collect()
        };
        Ok(Self {
            width,
            height,
            planes: (0..planes).map(plane).collect(),
            unknown: Vec::new(),
            tint: 0.0,
            _held: held,
        })
    }
}

/// What is there already of the place of a patch: the numbers at the nodes that are compared.
#[derive(Clone, Debug, Default)]
pub(crate) struct Overlap {
    /// Columns, as steps from the corner of the patch.
    pub(crate) nodes: Vec<[u32; 2]>,
    /// For each plane the number at each of them.
    pub(crate) planes: Vec<Vec<f32>>,
}

impl Overlap {
    /// The field of points at `nodes` of a patch whose corner is the origin.
    pub(crate) fn new(
        points: &OrientedPoints,
        lattice: &Lattice,
        nodes: Vec<[u32; 2]>,
        budget: &Budget,
    ) -> Result<Self> {
        budget.spend(nodes.len() as u64 * PROJECTION * lattice.heights.len() as u64)?;
        let planes = lattice.planes();
        let of = |node: &[u32; 2]| {
            let mut column = Vec::with_capacity(planes);
            let [x, y] = node.map(|k| (f64::from(k) + 0.5) * lattice.cell);
            lattice.column(points, x, y, &mut column);
            column
        };
        let columns: Vec<Vec<f32>> = nodes.par_iter().map(of).collect();
        let plane = |p: usize| columns.iter().map(|c| c[p]).collect();
        Ok(Self { planes: (0..planes).map(plane).collect(), nodes })
    }

    /// Some of the nodes, by their numbers.
    pub(crate) fn only(&self, some: &[usize]) -> Self {
        let plane = |p: &Vec<f32>| some.iter().map(|&k| p[k]).collect();
        Self { nodes: some.iter().map(|&k| self.nodes[k]).collect(), planes: self.planes.iter().map(plane).collect() }
    }

    /// The colours of points at `nodes`, multiplied by `tint` as those of the field are: three planes.
    pub(crate) fn colours(
        points: &OrientedPoints,
        colour: impl Fn(usize) -> [f32; 3] + Sync,
        (lattice, tint): (&Lattice, f32),
        nodes: Vec<[u32; 2]>,
        budget: &Budget,
    ) -> Result<Self> {
        budget.spend(nodes.len() as u64 * PROJECTION)?;
        let of = |node: &[u32; 2]| {
            let [x, y] = node.map(|k| (f64::from(k) + 0.5) * lattice.cell);
            lattice.colour(points, (x, y), &colour)
        };
        let seen: Vec<[f32; 3]> = nodes.par_iter().map(of).collect();
        let plane = |c: usize| seen.iter().map(|rgb| rgb[c] * tint).collect();
        Ok(Self { planes: (0..3).map(plane).collect(), nodes })
    }

    /// How much the colours of each node differ from those of the field where the corner of the patch is at `place`.
    pub(crate) fn differences(&self, field: &Field, place: [u32; 2]) -> Vec<f32> {
        let at = |[x, y]: [u32; 2]| (y + place[1]) as usize * field.width + (x + place[0]) as usize;
        let others = &field.planes[field.planes.len() - self.planes.len()..];
        let squares = |k: usize| {
            let of = |(own, other): (&Vec<f32>, &Vec<f32>)| (own[k] - other[at(self.nodes[k])]).powi(2);
            self.planes.iter().zip(others).map(of).sum()
        };
        (0..self.nodes.len()).map(squares).collect()
    }
}

/// The mean square of how far numbers are from their mean.
fn variance(values: impl Iterator<Item = f32> + Clone) -> f32 {
    let (mut sum, mut count) = (0.0_f64, 0.0_f64);
    values.clone().for_each(|v| (sum, count) = (sum + f64::from(v), count + 1.0));
    let mean = sum / count.max(1.0);
    (values.map(|v| (f64::from(v) - mean).powi(2)).sum::<f64>() / count.max(1.0)) as f32
}
