//! Clear space between rigid elements that stand on something continuous.
//!
//! The sums of Gaussians hardly tell how near elements are, and where pieces of the exemplar meet, two of them may come next to each other. What is
//! between them is not empty, so that leaving one out shows as a bare place. Elements that are nearer than those of the exemplar therefore add to the
//! error by the square of what is missing, in widths of the Gaussians, and make way for each other along the base.

use std::collections::BTreeMap;

use arabesque_core::{Budget, GridIndex, Result, Vector};

use crate::{
    energy::level::{Level, Pull},
    exemplar::{bodies::LOOSE, channels::inner},
    output::state::Output,
};

/// Work for each point of an element, and for each other one in reach.
const POINT: u64 = 30;
const OTHER: u64 = 10;
/// Weight beside the error of the lighter of two elements.
const WEIGHT: f64 = 1.0;

/// Two elements that are too near: their nearest points, how much of the clear space is missing, in widths of the Gaussians, and the weight of that.
struct Pair {
    points: (usize, usize),
    missing: f64,
    weight: f64,
    width: f64,
}

/// Elements of an output that are too near to each other.
pub(crate) struct Crowd(Vec<Pair>);

impl Crowd {
    /// Of an output with these pulls on its points; none where all is rigid or nothing is.
    pub(crate) fn new<const D: usize>(
        level: &Level<'_, D>,
        output: &Output<D>,
        pulls: &[Pull<D>],
        budget: &Budget,
    ) -> Result<Self> {
        let Some(clear) = level.pattern.gaps.clear() else { return Ok(Self(Vec::new())) };
        let rigid: Vec<usize> = (0..output.places.len()).filter(|&i| output.body_of[i] != LOOSE).collect();
        let places: Vec<Vector<D>> = rigid.iter().map(|&i| output.places[i]).collect();
        let largest = output.bodies.iter().map(|b| b.pose.scale).fold(0.0, f64::max);
        if clear * largest <= 0.0 {
            return Ok(Self(Vec::new()));
        }
        let index = GridIndex::new(&places, clear * largest, level.domain);
        let mut nearest: BTreeMap<(u32, u32), (f64, usize, usize)> = BTreeMap::new();
        let mut meter = budget.meter();
        for &i in &rigid {
            let own = output.body_of[i];
            let looked = index.within(output.places[i], clear * largest, |n, r| {
                let j = rigid[n];
                if output.body_of[j] > own {
                    let found = (r.norm(), i, j);
                    let best = nearest.entry((own, output.body_of[j])).or_insert(found);
                    if found.0 < best.0 {
                        *best = found;
                    }
                }
            });
            meter.spend(POINT + OTHER * looked)?;
        }
        let weight = |b: u32| -> f64 {
            let body = &output.bodies[b as usize];
            let of = |i: usize| f64::from(inner(&output.weights[i], &output.weights[i])) * pulls[i].cover;
            (body.first..body.first + body.count).map(of).sum()
        };
        let pair = |((a, b), (far, i, j)): ((u32, u32), (f64, usize, usize))| {
            let scale = 0.5 * (output.bodies[a as usize].pose.scale + output.bodies[b as usize].pose.scale);
            let width = level.tables.kernel.sigma * scale;
            let missing = (clear * scale - far) / width;
            (missing > 0.0).then(|| Pair { points: (i, j), missing, weight: WEIGHT * weight(a).min(weight(b)), width })
        };
        Ok(Self(nearest.into_iter().filter_map(pair).collect()))
    }

    /// What they add to the error.
    pub(crate) fn energy(&self) -> f64 {
        self.0.iter().map(|p| p.weight * p.missing * p.missing).sum()
    }

    /// Calls `visit` with each point that is pushed, the slope of the error by its place, along the base alone, and the curvature.
    pub(crate) fn slopes<const D: usize>(
        &self,
        level: &Level<'_, D>,
        output: &Output<D>,
        mut visit: impl FnMut(usize, Vector<D>, f64),
    ) {
        let base = level.pattern.base;
        for pair in &self.0 {
            let (i, j) = pair.points;
            let body = &output.bodies[output.body_of[i] as usize];
            let mut way = level.domain.offset(output.places[i], output.places[j]);
            for k in (0..D).filter(|&k| !base[k]) {
                let across = Vector(std::array::from_fn(|r| body.pose.rotation.0[r][k]));
                way = way - across * way.dot(across);
            }
            let slope = way.unit_or_zero() * (2.0 * pair.weight * pair.missing / pair.width);
            let curve = 2.0 * pair.weight / (pair.width * pair.width);
            visit(i, slope, curve);
            visit(j, -slope, curve);
        }
    }
}
