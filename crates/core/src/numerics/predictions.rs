//! Least squares for positions that predict one another: the graph of predictions as linear equations.

use std::ops::Range;

use rayon::prelude::*;

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
    right: Vec<Vector<D>>,
    /// What else is in the rows, so many at a time; the last of them may be fewer.
    pieces: Vec<Entries>,
    /// Rows in each of them.
    rows: usize,
    fixed: Vec<bool>,
}

/// What stands beside the diagonal in rows that follow one another.
#[derive(Clone, Debug)]
struct Entries {
    starts: Vec<u32>,
    /// Other unknown and weight, row by row.
    entries: Vec<(u32, f64)>,
}

/// Rows of the equations that follow one another.
struct Rows<const D: usize> {
    diagonal: Vec<f64>,
    right: Vec<Vector<D>>,
    entries: Entries,
}

/// Fewest rows that one thread sets up by itself: it reads all predictions for them.
const FEWEST: usize = 1024;

impl<const D: usize> NormalEquations<D> {
    /// Equations for `n` displacements; `pulls[i]` belongs to unknown `i`, unknowns with `fixed[i]` stay at zero.
    pub fn new(predictions: &[Prediction<D>], pulls: &[Pull<D>], fixed: Vec<bool>) -> Self {
        Self::of_groups(&[predictions], |i, _| pulls[i], fixed)
    }

    /// Equations for as many displacements as `fixed` has entries, from predictions in groups; `pull(i, weight)` belongs to unknown `i`,
    /// whose predictions weigh `weight` together, and unknowns with `fixed[i]` stay at zero. The same for any number of threads.
    pub fn of_groups<G: AsRef<[Prediction<D>]> + Sync>(
        groups: &[G],
        pull: impl Fn(usize, f64) -> Pull<D> + Sync,
        fixed: Vec<bool>,
    ) -> Self {
        let n = fixed.len();
        let rows = n.div_ceil(rayon::current_num_threads()).max(FEWEST);
        let piece = |k: usize| Rows::new(groups, k * rows..n.min((k + 1) * rows), &pull);
        let made: Vec<Rows<D>> = (0..n.div_ceil(rows)).into_par_iter().map(piece).collect();
        let (mut diagonal, mut right) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let mut pieces = Vec::with_capacity(made.len());
        for mut piece in made {
            diagonal.append(&mut piece.diagonal);
            right.append(&mut piece.right);
            pieces.push(piece.entries);
        }
        Self { diagonal, right, pieces, rows, fixed }
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

impl<const D: usize> Rows<D> {
    /// The rows in a range; each adds up what is predicted in the order of the predictions.
    fn new<G: AsRef<[Prediction<D>]>>(
        groups: &[G],
        range: Range<usize>,
        pull: &impl Fn(usize, f64) -> Pull<D>,
    ) -> Self {
        let (first, count) = (range.start as u32, range.len());
        let ends = |p: &Prediction<D>| [(p.from, p.to, -1.0), (p.to, p.from, 1.0)];
        // Rows before the first wrap around to what is beyond the last.
        let row = |unknown: u32| Some(unknown.wrapping_sub(first) as usize).filter(|&row| row < count);
        let all = || groups.iter().flat_map(|group| group.as_ref());
        let (mut starts, mut weight) = (vec![0_u32; count + 1], vec![0.0; count]);
        for p in all() {
            for row in ends(p).into_iter().filter_map(|(a, ..)| row(a)) {
                starts[row + 1] += 1;
                weight[row] += p.weight;
            }
        }
        for i in 1..=count {
            starts[i] += starts[i - 1];
        }
        let pulls: Vec<Pull<D>> = range.zip(weight).map(|(i, weight)| pull(i, weight)).collect();
        let mut diagonal: Vec<f64> = pulls.iter().map(|p| p.weight).collect();
        let mut right: Vec<_> = pulls.iter().map(|p| p.target * p.weight).collect();
        let mut next = starts.clone();
        let mut entries = vec![(0, 0.0); starts.last().map_or(0, |&n| n as usize)];
        for p in all() {
            for (a, b, sign) in ends(p) {
                let Some(row) = row(a) else { continue };
                let slot = &mut next[row];
                entries[*slot as usize] = (b, p.weight);
                *slot += 1;
                diagonal[row] += p.weight;
                right[row] += p.offset * (sign * p.weight);
            }
        }
        Self { diagonal, right, entries: Entries { starts, entries } }
    }
}

impl<const D: usize> Equations<D> for NormalEquations<D> {
    fn row(&self, i: usize, x: &[Vector<D>]) -> Vector<D> {
        if self.fixed[i] {
            return Vector::ZERO;
        }
        let Entries { starts, entries } = &self.pieces[i / self.rows];
        let row = i % self.rows;
        let entries = &entries[starts[row] as usize..starts[row + 1] as usize];
        entries.iter().fold(x[i] * self.diagonal[i], |sum, &(j, w)| sum - x[j as usize] * w)
    }

    fn diagonal(&self, i: usize) -> f64 {
        self.diagonal[i]
    }

    fn right(&self, i: usize) -> Vector<D> {
        if self.fixed[i] { Vector::ZERO } else { self.right[i] }
    }

    fn count(&self) -> usize {
        self.fixed.len()
    }

    fn price(&self) -> u64 {
        self.pieces.iter().map(|piece| piece.entries.len() as u64 * 2).sum()
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
    fn the_solution_is_the_same_for_any_number_of_threads_and_groups() {
        let n = 5 * FEWEST / 2;
        let (predictions, pulls) = problem(n, 7);
        let on = |threads: usize, groups: &[&[Prediction<2>]]| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let solve = || {
                let pull = |i: usize, weight: f64| Pull { weight: pulls[i].weight + 0.05 * weight, ..pulls[i] };
                NormalEquations::of_groups(groups, pull, vec![false; n]).solve(1e-6, 200, &Budget::default()).unwrap()
            };
            pool.install(solve)
        };
        let want = on(1, &[&predictions]);
        let groups: Vec<&[Prediction<2>]> = predictions.chunks(7).collect();
        for threads in [1, 2, 3, 8] {
            assert!(on(threads, &groups) == want, "{threads} threads");
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
