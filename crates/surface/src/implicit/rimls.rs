//! Robust implicit moving least squares [Oztireli 2009].
//!
//! At a place `x` each point `p` with normal `n` says that the surface is `f_p = n · (x - p)` below it. Moving least squares take the mean of what the
//! points around say, with weights `φ = (1 - |x - p|² / h²)⁴`. The robust kind repeats that a few times, and takes less of points that say something else than the
//! rest, by `exp(-((f_p - f) / (σ_r h))²)`, and whose normal differs from the gradient, by `exp(-(|n - ∇f| / σ_n)²)`: so edges stay sharp.
//!
//! Departures: the rounds start from what the nearest point says (in units of its `h`), not from the plain mean, so that the other side of a thin sheet or a near-by part never
//! gets a say; each point has its own `h`, a multiple of the spacing around it. The rounds are done at nodes of cells that the surface crosses; what is farther away is taken from the
//! nearest point, since nothing but its sign matters there.

use arabesque_core::{Budget, Result, Vector};

use super::blocks::{BLOCK, Blocks, Field, Node, SIDE, reached};

/// Nodes nearer to the surface are done with care, in cells: all those of a cell that the surface crosses.
const CARE: f32 = 1.75;

/// Points with normals, as a surface is made of them.
#[derive(Clone, Copy)]
pub(crate) struct Oriented<'a> {
    pub(crate) positions: &'a [Vector<3>],
    pub(crate) normals: &'a [Vector<3>],
    pub(crate) colours: Option<&'a [[f64; 3]]>,
    /// Radius in which each point matters.
    pub(crate) radii: &'a [f64],
}

/// Rounds end when the height changes by less, in cells.
const SETTLED: f32 = 1e-3;
/// Nodes are told by a point that is so near, in radii: beyond corners there may be none that has a weight, and the plane of the nearest one counts.
const VALID: f32 = 1.2;
/// How far points of other sides are asked, in radii: farther, so that no side goes on beyond its edge where the other one is just out of reach.
const REACH: f32 = 1.6;
/// Cosine to the nearest point's normal below which points face another side.
const OTHER: f32 = 0.4;
/// Cosine to a side's normal from which points have a say on it.
const SAME: f32 = 0.2;
/// Points of other sides are asked from this value of 1 - |x - p|² / h², elsewhere only where a node looks farther.
const NEAR: f32 = 0.3;
/// How far to the side of its nearest point a node looks farther, in radii.
const ASIDE: f32 = 0.6;
/// Most sides that are asked at one place.
const SIDES: usize = 3;

/// How points are weighed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kernel {
    pub(crate) rounds: usize,
    /// σ_r, in radii.
    pub(crate) residual: f32,
    /// σ_n.
    pub(crate) sharpness: f32,
    /// Distance from the middle of the points around to a place on their border, in radii: there an open surface ends.
    pub(crate) border: f32,
}

/// A point as a block sees it: in cells from the first node.
#[derive(Clone, Copy)]
struct Sample {
    at: [f32; 3],
    normal: [f32; 3],
    radius: f32,
    /// One over the squared radius.
    inverse2: f32,
}

/// Memory of the nodes of that field, in bytes.
pub(crate) fn rimls_bytes(points: &Oriented<'_>, cell: f64, budget: &Budget) -> Result<usize> {
    Ok(Field::bytes(&blocks(points, cell, budget)?, points.colours.is_some()))
}

/// The blocks that points reach.
fn blocks(points: &Oriented<'_>, cell: f64, budget: &Budget) -> Result<Blocks> {
    let reaches: Vec<f64> = points.radii.iter().map(|r| r * f64::from(REACH)).collect();
    Blocks::new(points.positions, &reaches, cell, budget)
}

/// The field of points with normals, with nodes at distances of `cell`.
pub(crate) fn rimls(points: &Oriented<'_>, kernel: Kernel, cell: f64, budget: &Budget) -> Result<Field> {
    let blocks = blocks(points, cell, budget)?;
    let evaluate = |blocks: &Blocks, block: usize, nodes: &mut [Node], colours: &mut [[f32; 3]]| {
        let corner = blocks.corner(block);
        let numbers = blocks.balls(block);
        let samples: Vec<Sample> = numbers
            .iter()
            .map(|&i| {
                let i = i as usize;
                let radius = (points.radii[i] / cell) as f32;
                let at = ((points.positions[i] - corner) * (1.0 / cell)).0.map(|c| c as f32);
                Sample { at, normal: points.normals[i].0.map(|c| c as f32), radius, inverse2: 1.0 / (radius * radius) }
            })
            .collect();
        let nearest = nearest_samples(&samples);
        budget.spend(BLOCK as u64 + samples.len() as u64 * 200)?;
        let (mut near, mut meter) = (Vec::new(), budget.meter());
        for (k, node) in nodes.iter_mut().enumerate() {
            let Some(first) = nearest[k] else { continue };
            let at = [k % SIDE, k / SIDE % SIDE, k / (SIDE * SIDE)].map(|c| c as f32);
            let first = &samples[first as usize];
            let value = dot(first.normal, minus(at, first.at));
            *node = Node { value, gradient: first.normal, beyond: f32::INFINITY };
            if value.abs() > CARE {
                continue;
            }
            near.clear();
            for (s, sample) in samples.iter().enumerate() {
                let q = dot2(minus(at, sample.at)) * sample.inverse2;
                if q < REACH * REACH {
                    near.push((s as u32, 1.0 - q));
                }
            }
            meter.spend(samples.len() as u64 * 2 + (near.len() * (kernel.rounds + 2)) as u64 * 8)?;
            *node = careful(at, &samples, &near, first.normal, kernel);
            if let (Some(own), Some(colour)) = (points.colours, colours.get_mut(k)) {
                *colour = mean_colour(&near, |s| own[numbers[s as usize] as usize]);
            }
        }
        Ok(())
    };
    Field::new(blocks, Node::UNKNOWN, points.colours.is_some(), budget, evaluate)
}

/// For each node of a block the sample that is nearest, by radii, among those that reach it.
fn nearest_samples(samples: &[Sample]) -> Vec<Option<u32>> {
    let mut best = vec![(VALID * VALID, None); BLOCK];
    for (s, sample) in samples.iter().enumerate() {
        let [x, y, z] = reached(Vector(sample.at.map(f64::from)), f64::from(VALID * sample.radius));
        for k in z.0..z.1 {
            for j in y.0..y.1 {
                for i in x.0..x.1 {
                    let q = dot2(minus([i as f32, j as f32, k as f32], sample.at)) * sample.inverse2;
                    let node = &mut best[i + SIDE * (j + SIDE * k)];
                    if q < node.0 {
                        *node = (q, Some(s as u32));
                    }
                }
            }
        }
    }
    best.into_iter().map(|(_, s)| s).collect()
}

/// What the points around a node say. `near` has the samples that reach it with 1 - |x - p|² / h² each, below 0 for those that have no weight, `first` is the normal of the nearest one.
///
/// Where others face another side they are asked by themselves. Two surfaces that turn their backs on one another have something between them, and outside of it is what is outside of either;
/// two that face one another have a gap or a groove between them, and outside is what is outside of both.
fn careful(at: [f32; 3], samples: &[Sample], near: &[(u32, f32)], first: [f32; 3], kernel: Kernel) -> Node {
    // The sides that were asked: no more than three meet in most corners.
    let (mut sides, mut count) = ([first; SIDES], 0);
    let (mut node, mut looks_beyond) = (Node::UNKNOWN, false);
    while count < SIDES {
        let asked = &sides[..count];
        let is_new = |&&(s, inner): &&(u32, f32)| {
            let normal = samples[s as usize].normal;
            let faces = if count == 0 { normal == first } else { asked.iter().all(|side| dot(*side, normal) < OTHER) };
            faces && (inner > NEAR || count == 0 || looks_beyond)
        };
        let facing = near.iter().filter(is_new);
        let nearest = facing
            .fold(None, |best: Option<(u32, f32)>, &n| if best.is_none_or(|b| n.1 > b.1) { Some(n) } else { best });
        let Some((own, inner)) = nearest else { break };
        let own = &samples[own as usize];
        let height = dot(own.normal, minus(at, own.at));
        // A side of which no point has a weight is the plane of its nearest one. Other sides than the first have few points here; those of the first must not outvote them.
        let said = if inner > 0.0 {
            let start = Start { height, normal: own.normal, least: if count == 0 { -1.0 } else { SAME } };
            rounds(at, samples, near, start, kernel)
        } else {
            Node { value: height, gradient: own.normal, beyond: f32::INFINITY }
        };
        if count == 0 {
            node = said;
            // Where the nearest point is far to one side, its own side may have ended in between.
            looks_beyond = dot2(minus(at, own.at)) - height * height > (ASIDE * own.radius).powi(2);
            if kernel.rounds == 0 {
                break;
            }
        } else {
            let way = minus(middle(samples, near, own.normal), middle(samples, near, first));
            let is_gap = dot(way, minus(first, own.normal)) > 0.0;
            if (said.value < node.value) == is_gap {
                node = Node { beyond: node.beyond, ..said };
            }
        }
        sides[count] = own.normal;
        count += 1;
    }
    node
}

/// Where the samples lie that face a side, in the mean.
fn middle(samples: &[Sample], near: &[(u32, f32)], side: [f32; 3]) -> [f32; 3] {
    let (mut sum, mut place) = (0.0_f32, [0.0_f32; 3]);
    for (sample, inner) in near.iter().map(|&(s, inner)| (&samples[s as usize], inner)) {
        let weight = if dot(sample.normal, side) > 0.3 { (inner + REACH * REACH - 1.0).powi(2) } else { 0.0 };
        sum += weight;
        (0..3).for_each(|k| place[k] += weight * sample.at[k]);
    }
    place.map(|c| c / sum.max(f32::MIN_POSITIVE))
}

/// What the rounds start from.
#[derive(Clone, Copy)]
struct Start {
    height: f32,
    normal: [f32; 3],
    /// Least cosine to the normal of the points that have a say.
    least: f32,
}

/// The rounds at one node.
fn rounds(at: [f32; 3], samples: &[Sample], near: &[(u32, f32)], start: Start, kernel: Kernel) -> Node {
    let (mut f, mut g) = (start.height, start.normal);
    for round in 0..=kernel.rounds {
        let (mut sum, mut sum_f) = (0.0_f32, 0.0_f32);
        let (mut sum_n, mut sum_g, mut sum_gf) = ([0.0_f32; 3], [0.0_f32; 3], [0.0_f32; 3]);
        for &(s, inner) in near.iter().filter(|(_, inner)| *inner > 0.0) {
            let sample = &samples[s as usize];
            let d = minus(at, sample.at);
            let own = dot(sample.normal, d);
            let mut alike = 1.0;
            if kernel.rounds > 0 {
                if dot(sample.normal, start.normal) < start.least {
                    continue;
                }
                let mut unlike = dot2(minus(sample.normal, g)) / (kernel.sharpness * kernel.sharpness);
                if round > 0 {
                    let off = (own - f) / (kernel.residual * sample.radius);
                    unlike += off * off;
                }
                alike = (-unlike).exp();
            }
            let cube = inner * inner * inner;
            let weight = cube * inner * alike;
            let slope = -8.0 * cube * sample.inverse2 * alike;
            sum += weight;
            sum_f += weight * own;
            for k in 0..3 {
                sum_n[k] += weight * sample.normal[k];
                sum_g[k] += slope * d[k];
                sum_gf[k] += slope * d[k] * own;
            }
        }
        if sum.is_nan() || sum <= 1e-20 {
            break;
        }
        let before = f;
        f = sum_f / sum;
        g = std::array::from_fn(|k| (sum_gf[k] - f * sum_g[k] + sum_n[k]) / sum);
        if (f - before).abs() < SETTLED {
            break;
        }
    }
    Node { value: f, gradient: g, beyond: beyond(at, samples, near, g, kernel) }
}

/// How far the place is from the middle of the points around, along the surface: 1 at their border [Adamson 2004].
fn beyond(at: [f32; 3], samples: &[Sample], near: &[(u32, f32)], g: [f32; 3], kernel: Kernel) -> f32 {
    let (mut sum, mut offset, mut radius) = (0.0_f32, [0.0_f32; 3], 0.0_f32);
    for &(s, inner) in near.iter().filter(|(_, inner)| *inner > 0.0) {
        let sample = &samples[s as usize];
        let weight = inner * inner * inner * inner;
        let d = minus(at, sample.at);
        sum += weight;
        radius += weight * sample.radius;
        (0..3).for_each(|k| offset[k] += weight * d[k]);
    }
    if sum <= 0.0 {
        return f32::INFINITY;
    }
    let off = offset.map(|c| c / sum);
    let up = dot(off, g) / dot2(g).max(1e-12);
    let along: [f32; 3] = std::array::from_fn(|k| off[k] - up * g[k]);
    dot2(along).sqrt() / (kernel.border * radius / sum)
}

/// Mean colour of samples, weighed as their heights are.
fn mean_colour(near: &[(u32, f32)], colour: impl Fn(u32) -> [f64; 3]) -> [f32; 3] {
    let (mut sum, mut mean) = (0.0, [0.0; 3]);
    for &(s, inner) in near {
        // Where nothing is nearer, all that can be asked counts.
        let weight = f64::from(inner.max(0.02)).powi(4);
        sum += weight;
        colour(s).iter().enumerate().for_each(|(k, c)| mean[k] += weight * c);
    }
    mean.map(|c| (c / sum) as f32)
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn dot2(a: [f32; 3]) -> f32 {
    dot(a, a)
}

/// How far from the middle of the points around a place is that lies `past` radii beyond the straight border of evenly spread points, in radii.
pub(crate) fn border_offset(past: f64) -> f64 {
    // Across the border the kernel's weight is (1 - u²)^4.5 at u radii, and only what is farther than the border has any.
    let from = past.clamp(-0.95, 0.95);
    let steps = 200;
    let width = (1.0 - from) / f64::from(steps);
    let weight = |k: i32| (1.0 - (from + (f64::from(k) + 0.5) * width).powi(2)).max(0.0).powf(4.5) * width;
    let whole: f64 = (0..steps).map(weight).sum();
    (1.0 - from * from).powf(5.5) / 11.0 / whole
}
