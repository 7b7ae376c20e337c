//! The nearest points of each point, and how densely points lie.

use std::f64::consts::PI;

use arabesque_core::{Bounds, Budget, Result, Vector};
use rayon::prelude::*;

use crate::tree::Tree;

/// Points whose neighbours say how densely all of them lie.
const ASKED: usize = 4000;

/// The nearest points of each point.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours {
    /// As many for each point, nearest first, without the point itself.
    all: Vec<u32>,
    each: usize,
    /// Side of the square of surface that a point stands for, about: by the distance of its farthest neighbour.
    pub(crate) spacing: Vec<f64>,
}

impl Neighbours {
    /// The `each` nearest points of each of `points`, of which there are more than that.
    pub(crate) fn new(points: &[Vector<3>], each: usize, budget: &Budget) -> Result<Self> {
        let each = each.min(points.len().saturating_sub(1)).max(1);
        let boxes: Vec<_> = points.iter().map(|&p| Bounds::new(p, p)).collect();
        budget.spend(points.len() as u64 * 200)?;
        let tree = Tree::new(&boxes, budget)?;
        let chunk = |(c, chunk): (usize, &[Vector<3>])| -> Result<(Vec<u32>, Vec<f64>)> {
            let (mut all, mut spacing) = (Vec::with_capacity(chunk.len() * each), Vec::with_capacity(chunk.len()));
            let (mut found, mut meter) = (Vec::new(), budget.meter());
            for (k, &p) in chunk.iter().enumerate() {
                let own = (c * 512 + k) as u32;
                let looked =
                    tree.nearest_many(p, each, &mut found, |i| (i != own).then(|| (points[i as usize] - p).norm2()));
                meter.spend(looked * 8)?;
                all.extend(found.iter().map(|f| f.1));
                all.resize((k + 1) * each, own);
                // A disc up to the farthest of n neighbours holds about n + 1/2 points with their squares.
                let farthest2 = found.last().map_or(0.0, |f| f.0);
                spacing.push((PI * farthest2 / (each as f64 + 0.5)).sqrt());
            }
            Ok((all, spacing))
        };
        let chunks: Result<Vec<_>> = points.par_chunks(512).enumerate().map(chunk).collect();
        let (mut all, mut spacing) = (Vec::with_capacity(points.len() * each), Vec::with_capacity(points.len()));
        let chunks = chunks?;
        budget.spend(0)?;
        for (some, theirs) in chunks {
            all.extend(some);
            spacing.extend(theirs);
        }
        Ok(Self { all, each, spacing })
    }

    /// The spacing that half of the points have at least, by `each` neighbours of some thousand of them.
    pub(crate) fn usual_spacing(points: &[Vector<3>], each: usize, budget: &Budget) -> Result<f64> {
        let each = each.min(points.len().saturating_sub(1)).max(1);
        let boxes: Vec<_> = points.iter().map(|&p| Bounds::new(p, p)).collect();
        let tree = Tree::new(&boxes, budget)?;
        let asked: Vec<usize> = (0..points.len()).step_by(points.len().div_ceil(ASKED).max(1)).collect();
        budget.spend(asked.len() as u64 * 800)?;
        let spacing = |&own: &usize| {
            let mut found = Vec::new();
            tree.nearest_many(points[own], each, &mut found, |i| {
                (i as usize != own).then(|| (points[i as usize] - points[own]).norm2())
            });
            (PI * found.last().map_or(0.0, |f| f.0) / (each as f64 + 0.5)).sqrt()
        };
        let mut spacings: Vec<f64> = asked.par_iter().with_min_len(64).map(spacing).collect();
        let half = spacings.len() / 2;
        Ok(*spacings.select_nth_unstable_by(half, f64::total_cmp).1)
    }

    /// The neighbours of point `i`, nearest first.
    pub(crate) fn of(&self, i: usize) -> &[u32] {
        &self.all[i * self.each..(i + 1) * self.each]
    }

    /// The spacing that half of the points have at least.
    pub(crate) fn median_spacing(&self) -> f64 {
        let mut sorted = self.spacing.clone();
        let half = sorted.len() / 2;
        *sorted.select_nth_unstable_by(half, f64::total_cmp).1
    }

    /// Spacings that change gently: the mean over each point and its neighbours, and at most twice what most points have.
    pub(crate) fn even_spacing(&self) -> Vec<f64> {
        let median = self.median_spacing();
        let even = |i: usize| {
            let of = |j: usize| self.spacing[j].clamp(0.25 * median, 2.0 * median);
            let sum: f64 = self.of(i).iter().map(|&j| of(j as usize)).sum();
            (sum + of(i)) / (self.each + 1) as f64
        };
        (0..self.spacing.len()).map(even).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_points_tell_the_spacing_of_all() {
        let jitter = |k: usize| ((k * 7919) % 101) as f64 / 101.0 * 0.3;
        let points: Vec<_> = (0..20_000)
            .map(|k| Vector([(k % 200) as f64 + jitter(k), (k / 200) as f64 + jitter(k + 5), jitter(k + 9)]))
            .collect();
        let budget = Budget::default();
        let all = Neighbours::new(&points, 6, &budget).unwrap().median_spacing();
        let some = Neighbours::usual_spacing(&points, 6, &budget).unwrap();
        assert!((some / all - 1.0).abs() < 0.02, "{some} {all}");
        let few = &points[..900];
        let all = Neighbours::new(few, 6, &budget).unwrap().median_spacing();
        assert_eq!(Neighbours::usual_spacing(few, 6, &budget).unwrap(), all);
    }
}
