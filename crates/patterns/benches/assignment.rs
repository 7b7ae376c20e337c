//! Time of one pairing, at the sizes that the search meets.

use std::cell::Cell;

use arabesque_core::{Stage, Stream};
use arabesque_patterns::stages::Pairing;
use divan::{Bencher, black_box};

/// Rows and columns of a problem.
const SIZES: [(usize, usize); 3] = [(8, 8), (12, 24), (30, 60)];

/// Different problems that each benchmark goes through in turn.
const PROBLEMS: usize = 256;

/// Points of `classes` classes in the unit disc, as neighbourhoods have them.
fn disc(stream: &mut Stream, n: usize, classes: usize) -> Vec<(f64, f64, usize)> {
    let mut point = || (stream.range(0.0, std::f64::consts::TAU), stream.unit().sqrt(), stream.below(classes));
    (0..n).map(|_| point()).map(|(turn, r, class)| (r * turn.cos(), r * turn.sin(), class)).collect()
}

/// Squared distances between two random neighbourhoods; pairs of unlike classes must not be.
fn neighbourhoods(item: usize, (rows, columns): (usize, usize), classes: usize) -> Vec<f32> {
    let mut stream = Stream::new(1, Stage::TEST, item as u64);
    let (a, b) = (disc(&mut stream, rows, classes), disc(&mut stream, columns, classes));
    let cost = |p: &(f64, f64, usize), q: &(f64, f64, usize)| match p.2 == q.2 {
        true => ((p.0 - q.0).powi(2) + (p.1 - q.1).powi(2)) as f32,
        false => f32::INFINITY,
    };
    a.iter().flat_map(|p| b.iter().map(move |q| cost(p, q))).collect()
}

fn each_in_turn(bencher: Bencher, problems: &[Vec<f32>], mut solve: impl FnMut(&[f32]) -> f32) {
    let next = Cell::new(0);
    bencher.bench_local(|| {
        let k = next.replace((next.get() + 1) % problems.len());
        solve(black_box(&problems[k]))
    });
}

fn problems(size: (usize, usize), classes: usize) -> Vec<Vec<f32>> {
    (0..PROBLEMS).map(|k| neighbourhoods(k, size, classes)).collect()
}

#[divan::bench(args = SIZES)]
fn full(bencher: Bencher, size: (usize, usize)) {
    let mut solver = Pairing::default();
    each_in_turn(bencher, &problems(size, 1), |cost| solver.full(size.0, size.1, cost));
}

/// The outlier distance is the mean distance to the nearest neighbour.
#[divan::bench(args = SIZES, consts = [1, 3])]
fn with_outliers<const CLASSES: usize>(bencher: Bencher, size: (usize, usize)) {
    let mut solver = Pairing::default();
    let outlier = vec![1.0 / size.1 as f32; size.0];
    each_in_turn(bencher, &problems(size, CLASSES), |cost| solver.with_outliers(size.0, size.1, cost, &outlier));
}

#[divan::bench(args = SIZES)]
fn greedy(bencher: Bencher, size: (usize, usize)) {
    let mut solver = Pairing::default();
    each_in_turn(bencher, &problems(size, 1), |cost| solver.greedy(size.0, size.1, cost));
}

fn main() {
    divan::main();
}
