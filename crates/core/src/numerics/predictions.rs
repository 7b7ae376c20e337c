//! Least squares for positions that predict one another: the graph of predictions as linear equations.

use crate::{
    budget::Budget,
    error::Result,
    numerics::{Equations, conjugate_gradients},
    space::Vector,
};

/// `weight * |(x_to - x_from) - offset|^2` for a pair of unknowns.
#[derive(Clone, Copy, Debug)]
pub struct Prediction<const D: usize> {
    /// The unknown that predicts.
    pub from: u32,
    /// The unknown that is predicted.
    pub to: u32,
    /// Where the one should lie from the other.
    pub offset: Vector<D>,
    /// How much it counts.
    pub weight: f64,
}

/// `weight * |x - target|^2` for one unknown.
#[derive(Clone, Copy, Debug)]
pub struct Pull<const D: usize> {
    /// Where the unknown should lie.
    pub target: Vector<D>,
    /// How much it counts.
    pub weight: f64,
}

/// The normal equations of a sum of predictions and pulls: symmetric positive definite when every unknown has a pull of
/// its own.
///
/// Unknowns are displacements from a start, so that positions on a torus need no common origin.
#[derive(Clone, Debug)]
pub struct NormalEquations<const D: usize> {
    diagonal: Vec<f64>,
    starts: Vec<u32>,
    /// Other unknown and weight, row by row.
    entries: Vec<(u32, f64)>,
    right: Vec<Vector<D>>,
    fixed: Vec<bool>,
}

impl<const D: usize> NormalEquations<D> {
    /// Equations for `n` displacements; `pulls[i]` belongs to unknown `i`, unknowns with `fixed[i]` stay at zero.
    pub fn new(predictions: &[Prediction<D>], pulls: &[Pull<D>], fixed: Vec<bool>) -> Self {
        let n = pulls.len();
        let mut diagonal: Vec<f64> = pulls.iter().map(|p| p.weight).collect();
        let mut right: Vec<_> = pulls.iter().map(|p| p.target * p.weight).collect();
        let mut starts = vec![0_u32; n + 1];
        for p in predictions {
            starts[p.from as usize + 1] += 1;
            starts[p.to as usize + 1] += 1;
        }
        for i in 1..=n {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0.0); predictions.len() * 2];
        for p in predictions {
            for (a, b, sign) in [(p.from, p.to, -1.0), (p.to, p.from, 1.0)] {
                let slot = &mut next[a as usize];
                entries[*slot as usize] = (b, p.weight);
                *slot += 1;
                diagonal[a as usize] += p.weight;
                right[a as usize] += p.offset * (sign * p.weight);
            }
        }
        Self { diagonal, starts, entries, right, fixed }
    }

    /// Solves the equations from zero, until the residual is `tolerance` of the start or after `most` steps. Never raises the sum of squares
    /// above its value at zero.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub fn solve(&self, tolerance: f64, most: usize, budget: &Budget) -> Result<Vec<Vector<D>>> {
        conjugate_gradients(self, tolerance, most, budget)
    }
}

impl<const D: usize> Equations<D> for NormalEquations<D> {
    fn row(&self, i: usize, x: &[Vector<D>]) -> Vector<D> {
        if self.fixed[i] {
            return Vector::ZERO;
        }
        let entries = &self.entries[self.starts[i] as usize..self.starts[i + 1] as usize];
        entries.iter().fold(x[i] * self.diagonal[i], |sum, &(j, w)| sum - x[j as usize] * w)
    }

    fn diagonal(&self, i: usize) -> f64 {
        self.diagonal[i]
    }

    fn right(&self, i: usize) -> Vector<D> {
        if self.fixed[i] { Vector::ZERO } else { self.right[i] }
    }

    fn count(&self) -> usize {
        self.right.len()
    }

    fn price(&self) -> u64 {
        self.entries.len() as u64 * 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

    /// A ring of unknowns with chords, random offsets and weights.
    fn problem(n: usize, seed: u64) -> (Vec<Prediction<2>>, Vec<Pull<2>>) {
        let mut random = Stream::new(seed, Stage::TEST, 0);
        let mut vector = || Vector::xy(random.range(-1.0, 1.0), random.range(-1.0, 1.0));
        let offsets: Vec<_> = (0..3 * n).map(|_| vector()).collect();
        let targets: Vec<_> = (0..n).map(|_| vector()).collect();
        let mut random = Stream::new(seed, Stage::TEST, 1);
        let predictions = (0..3 * n).map(|k| Prediction {
            from: (k % n) as u32,
            to: ((k * 7 + 1 + k / n) % n) as u32,
            offset: offsets[k],
            weight: random.range(0.1, 2.0),
        });
        let predictions = predictions.filter(|p| p.from != p.to).collect();
        let pulls = targets.into_iter().map(|target| Pull { target, weight: random.range(0.01, 0.2) }).collect();
        (predictions, pulls)
    }

    fn energy(predictions: &[Prediction<2>], pulls: &[Pull<2>], x: &[Vector<2>]) -> f64 {
        let pairs = predictions.iter().map(|p| p.weight * (x[p.to as usize] - x[p.from as usize] - p.offset).norm2());
        let alone = pulls.iter().zip(x).map(|(p, v)| p.weight * (*v - p.target).norm2());
        pairs.sum::<f64>() + alone.sum::<f64>()
    }

    #[test]
    fn the_solution_is_that_of_a_library_solver() {
        for (n, seed) in [(5, 1), (40, 2), (300, 3)] {
            let (predictions, pulls) = problem(n, seed);
            let mut matrix = nalgebra::DMatrix::<f64>::zeros(n, n);
            let mut right = nalgebra::DMatrix::<f64>::zeros(n, 2);
            for (i, p) in pulls.iter().enumerate() {
                matrix[(i, i)] += p.weight;
                (0..2).for_each(|k| right[(i, k)] += p.weight * p.target[k]);
            }
            for p in &predictions {
                let (a, b) = (p.from as usize, p.to as usize);
                matrix[(a, a)] += p.weight;
                matrix[(b, b)] += p.weight;
                matrix[(a, b)] -= p.weight;
                matrix[(b, a)] -= p.weight;
                for k in 0..2 {
                    right[(b, k)] += p.weight * p.offset[k];
                    right[(a, k)] -= p.weight * p.offset[k];
                }
            }
            let want = matrix.cholesky().unwrap().solve(&right);
            let got = NormalEquations::new(&predictions, &pulls, vec![false; n])
                .solve(1e-12, 10_000, &Budget::default())
                .unwrap();
            for i in 0..n {
                assert!((0..2).all(|k| (got[i][k] - want[(i, k)]).abs() < 1e-7), "{n} {i}");
            }
        }
    }

    #[test]
    fn the_energy_never_rises_in_a_solve() {
        for seed in 0..20 {
            let (predictions, pulls) = problem(60, seed);
            let equations = NormalEquations::new(&predictions, &pulls, vec![false; 60]);
            let mut last = energy(&predictions, &pulls, &[Vector::ZERO; 60]);
            for steps in 1..20 {
                let now = energy(&predictions, &pulls, &equations.solve(0.0, steps, &Budget::default()).unwrap());
                assert!(now <= last * (1.0 + 1e-12), "{seed} {steps}: {last} {now}");
                last = now;
            }
        }
    }

    #[test]
    fn a_fixed_unknown_does_not_move() {
        let (predictions, pulls) = problem(12, 5);
        let mut fixed = vec![false; 12];
        fixed[4] = true;
        let x = NormalEquations::new(&predictions, &pulls, fixed).solve(1e-9, 100, &Budget::default()).unwrap();
        assert_eq!(x[4], Vector::ZERO);
        assert!(x.iter().any(|v| v.norm() > 0.01));
    }
}
