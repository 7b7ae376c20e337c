//! Linear equations by conjugate gradients.

use rayon::prelude::*;

use crate::{budget::Budget, error::Result, space::Vector};

/// A symmetric positive definite matrix, and right sides of `D` numbers for every unknown.
pub trait Equations<const D: usize>: Sync {
    /// Entry `i` of the product of the matrix with `x`.
    fn row(&self, i: usize, x: &[Vector<D>]) -> Vector<D>;
    /// Entry `i` of the diagonal, by which the equations are preconditioned.
    fn diagonal(&self, i: usize) -> f64;
    /// The right side of equation `i`.
    fn right(&self, i: usize) -> Vector<D>;
    /// Number of unknowns.
    fn count(&self) -> usize;
    /// About how many nanoseconds the product of the matrix with a vector takes, for the budget.
    fn price(&self) -> u64;
}

/// Unknowns handled as one piece of parallel work; sums are taken piece by piece, so that they do not depend on the number of threads.
const PIECE: usize = 4096;

/// Nanoseconds that a step takes for each unknown, besides the product with the matrix.
const VECTORS: u64 = 20;

/// Fewest rows worth a piece of parallel work of their own.
const ROWS: usize = 512;

/// Solves equations with the diagonal as preconditioner, from zero, until the residual is `tolerance` of the start or after `most` steps.
/// Never raises the quadratic form whose minimum is looked for above its value at zero.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn conjugate_gradients<const D: usize>(
    equations: &impl Equations<D>,
    tolerance: f64,
    most: usize,
    budget: &Budget,
) -> Result<Vec<Vector<D>>> {
    let n = equations.count();
    let mut x = vec![Vector::ZERO; n];
    let mut r: Vec<_> = (0..n).into_par_iter().with_min_len(ROWS).map(|i| equations.right(i)).collect();
    let mut z = preconditioned(equations, &r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let stop = rz * tolerance * tolerance;
    for _ in 0..most {
        if rz <= stop || rz <= f64::MIN_POSITIVE {
            break;
        }
        budget.spend(equations.price() + n as u64 * VECTORS)?;
        let q: Vec<_> = (0..n).into_par_iter().with_min_len(ROWS).map(|i| equations.row(i, &p)).collect();
        let alpha = rz / dot(&p, &q).max(f64::MIN_POSITIVE);
        add_scaled(&mut x, &p, alpha);
        add_scaled(&mut r, &q, -alpha);
        z = preconditioned(equations, &r);
        let next = dot(&r, &z);
        let beta = next / rz;
        rz = next;
        p.par_iter_mut().with_min_len(ROWS).zip(&z).for_each(|(p, &z)| *p = z + *p * beta);
    }
    Ok(x)
}

fn preconditioned<const D: usize>(equations: &impl Equations<D>, r: &[Vector<D>]) -> Vec<Vector<D>> {
    let scaled = |(i, &v): (usize, &Vector<D>)| v * (1.0 / equations.diagonal(i).max(f64::MIN_POSITIVE));
    r.par_iter().with_min_len(ROWS).enumerate().map(scaled).collect()
}

/// `x += y * factor`, entry by entry.
fn add_scaled<const D: usize>(x: &mut [Vector<D>], y: &[Vector<D>], factor: f64) {
    x.par_iter_mut().with_min_len(ROWS).zip(y).for_each(|(x, &y)| *x += y * factor);
}

fn dot<const D: usize>(a: &[Vector<D>], b: &[Vector<D>]) -> f64 {
    let pieces: Vec<f64> = a
        .par_chunks(PIECE)
        .zip(b.par_chunks(PIECE))
        .map(|(a, b)| a.iter().zip(b).map(|(p, q)| p.dot(*q)).sum())
        .collect();
    pieces.into_iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stage, Stream};

    /// A full matrix.
    struct Full {
        matrix: nalgebra::DMatrix<f64>,
        right: nalgebra::DMatrix<f64>,
    }

    impl Equations<2> for Full {
        fn row(&self, i: usize, x: &[Vector<2>]) -> Vector<2> {
            x.iter().enumerate().fold(Vector::ZERO, |sum, (j, &v)| sum + v * self.matrix[(i, j)])
        }

        fn diagonal(&self, i: usize) -> f64 {
            self.matrix[(i, i)]
        }

        fn right(&self, i: usize) -> Vector<2> {
            Vector::xy(self.right[(i, 0)], self.right[(i, 1)])
        }

        fn count(&self) -> usize {
            self.right.nrows()
        }

        fn price(&self) -> u64 {
            1000
        }
    }

    fn random(n: usize) -> Full {
        let mut stream = Stream::new(9, Stage::TEST, n as u64);
        let root = nalgebra::DMatrix::from_fn(n, n, |_, _| stream.range(-1.0, 1.0));
        let matrix = &root * root.transpose() + nalgebra::DMatrix::identity(n, n);
        let right = nalgebra::DMatrix::from_fn(n, 2, |_, _| stream.range(-1.0, 1.0));
        Full { matrix, right }
    }

    #[test]
    fn the_solution_is_that_of_a_direct_solver() {
        for n in [1, 7, 40] {
            let equations = random(n);
            let want = equations.matrix.clone().cholesky().unwrap().solve(&equations.right);
            let got = conjugate_gradients(&equations, 1e-12, 1000, &Budget::default()).unwrap();
            assert!((0..n).all(|i| (0..2).all(|k| (got[i][k] - want[(i, k)]).abs() < 1e-8)), "{n}");
        }
    }

    #[test]
    fn every_step_brings_the_solution_nearer() {
        let equations = random(20);
        let form = |x: &[Vector<2>]| -> f64 {
            (0..20).map(|i| x[i].dot(equations.row(i, x) * 0.5 - equations.right(i))).sum()
        };
        let mut last = form(&[Vector::ZERO; 20]);
        for steps in 1..12 {
            let now = form(&conjugate_gradients(&equations, 0.0, steps, &Budget::default()).unwrap());
            assert!(now < last, "{steps}: {last} {now}");
            last = now;
        }
    }

    #[test]
    fn a_solver_that_is_asked_to_stop_gives_nothing() {
        let budget = Budget::stopping_at(crate::budget::Limits::default(), 2);
        assert!(conjugate_gradients(&random(20), 0.0, 1000, &budget).is_err());
        assert_eq!(budget.checks(), 2);
    }

    #[test]
    fn nothing_to_solve_is_solved() {
        let none = Full { matrix: nalgebra::DMatrix::zeros(0, 0), right: nalgebra::DMatrix::zeros(0, 2) };
        assert!(conjugate_gradients(&none, 1e-9, 10, &Budget::default()).unwrap().is_empty());
    }
}
