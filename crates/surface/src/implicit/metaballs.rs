//! Metaballs: the place where a sum of kernels around points reaches a level [Blinn 1982].
//!
//! A point with radius `r` adds `m (1 - d² / R²)³` at distance `d`, where `R` is `r` times the reach. The level is what a ball alone has at its radius. The
//! mass `m` is one over the sum of all kernels at the point, so that the surface stays about a radius away from points whether they are few or many: without it, dense rows of
//! points would swell.

use arabesque_core::{Bounds, Budget, Result, Vector};
use rayon::prelude::*;

use super::blocks::{BLOCK, Blocks, Field, Node, SIDE, reached};
use crate::tree::Tree;

/// Points with radii.
pub(crate) struct Balls<'a> {
    pub(crate) positions: &'a [Vector<3>],
    pub(crate) radii: &'a [f64],
    pub(crate) colours: Option<&'a [[f64; 3]]>,
}

/// The field of metaballs, with nodes at distances of `cell`.
pub(crate) fn metaballs(balls: &Balls<'_>, reach: f64, cell: f64, budget: &Budget) -> Result<Field> {
    let outer: Vec<f64> = balls.radii.iter().map(|r| r * reach).collect();
    let masses = masses(balls.positions, &outer, budget)?;
    let blocks = Blocks::new(balls.positions, &outer, cell, budget)?;
    let level = kernel(1.0 / (reach * reach)) as f32;
    // Near the surface of a ball alone the sum falls so much from cell to cell; it is told in cells.
    let median = {
        let mut sorted = balls.radii.to_vec();
        let half = sorted.len() / 2;
        *sorted.select_nth_unstable_by(half, f64::total_cmp).1
    };
    let slope = 6.0 * (1.0 - 1.0 / (reach * reach)).powi(2) / (reach * reach * median) * cell;
    let scale = (1.0 / slope) as f32;
    let elsewhere = Node { value: level * scale, gradient: [0.0; 3], beyond: 0.0 };
    let evaluate = |blocks: &Blocks, block: usize, nodes: &mut [Node], colours: &mut [[f32; 3]]| {
        let corner = blocks.corner(block);
        let mut meter = budget.meter();
        let mut sums = vec![0.0_f32; if colours.is_empty() { 0 } else { BLOCK }];
        for &ball in blocks.balls(block) {
            let i = ball as usize;
            let (at, radius) = ((balls.positions[i] - corner) * (1.0 / cell), outer[i] / cell);
            let [x, y, z] = reached(at, radius);
            let (mass, inverse2) = (masses[i] as f32 * scale, (1.0 / (radius * radius)) as f32);
            let own = balls.colours.map(|c| c[i].map(|c| c as f32));
            let at = at.0.map(|c| c as f32);
            meter.spend(20 + 6 * [x, y, z].iter().map(|(a, b)| b.saturating_sub(*a) as u64).product::<u64>())?;
            for (k, j, i) in (z.0..z.1).flat_map(|k| (y.0..y.1).flat_map(move |j| (x.0..x.1).map(move |i| (k, j, i)))) {
                let d = [i as f32 - at[0], j as f32 - at[1], k as f32 - at[2]];
                let inner = 1.0 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * inverse2;
                if inner <= 0.0 {
                    continue;
                }
                let number = i + SIDE * (j + SIDE * k);
                let node = &mut nodes[number];
                node.value -= mass * inner * inner * inner;
                let fall = 6.0 * mass * inner * inner * inverse2;
                (0..3).for_each(|axis| node.gradient[axis] += fall * d[axis]);
                if let Some(own) = own {
                    let weight = inner * inner * inner;
                    sums[number] += weight;
                    (0..3).for_each(|c| colours[number][c] += weight * own[c]);
                }
            }
        }
        for (colour, sum) in colours.iter_mut().zip(&sums).filter(|(_, sum)| **sum > 0.0) {
            *colour = colour.map(|c| c / sum);
        }
        Ok(())
    };
    Field::new(blocks, elsewhere, balls.colours.is_some(), budget, evaluate)
}

/// What a ball adds at a share of its outer radius, squared.
fn kernel(share2: f64) -> f64 {
    (1.0 - share2).max(0.0).powi(3)
}

/// One over the sum of the kernels at each point.
fn masses(points: &[Vector<3>], outer: &[f64], budget: &Budget) -> Result<Vec<f64>> {
    let boxes: Vec<_> = points.iter().zip(outer).map(|(&p, &r)| Bounds::new(p, p).grown(r)).collect();
    budget.spend(points.len() as u64 * 200)?;
    let tree = Tree::new(&boxes, budget)?;
    let chunk = |chunk: &[Vector<3>]| -> Result<Vec<f64>> {
        let mut meter = budget.meter();
        let one = |&p: &Vector<3>| {
            let mut sum = 0.0;
            let looked = tree.meeting(&Bounds::new(p, p), |i| {
                let i = i as usize;
                sum += kernel((points[i] - p).norm2() / (outer[i] * outer[i]));
                true
            });
            meter.spend(looked * 8).map(|()| 1.0 / sum)
        };
        chunk.iter().map(one).collect()
    };
    let chunks: Result<Vec<_>> = points.par_chunks(256).map(chunk).collect();
    let chunks = chunks?;
    budget.spend(0)?;
    Ok(chunks.into_iter().flatten().collect())
}
