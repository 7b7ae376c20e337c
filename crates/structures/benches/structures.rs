//! Structures at the sizes that are published for the method, and how time grows with the output.
//!
//! `cargo bench -p arabesque-structures`: [Roveri 2015, table 1] has 4 s for a brush over a helix (600 points of the exemplar, 100 of the output),
//! 2 minutes for sand (1 600 to 7 200 points) and 6 minutes for a chair (1 100 to 23 000 points) on an i7-3770K with four cores. `exhaustive`
//! is one evaluation of the error density with nothing left out.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]
#![allow(missing_docs, reason = "the macros of divan make items without any")]

use std::{f64::consts::TAU, sync::Arc};

use arabesque_core::{Bounds, Budget, Domain, Fields, PointSet, Stage, Stream, Unobserved, Vector};
use arabesque_structures::{Flat, Prepared, StructureParams, StructureRequest};

fn main() {
    divan::main();
}

/// Two strands around each other, 1 long, with normals.
fn helix() -> PointSet<3> {
    let mut stream = Stream::new(1, Stage::new(1), 0);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for k in 0..600 {
        let (x, around) = (f64::from(k / 2) / 300.0, stream.range(0.0, TAU));
        let turn = 4.0 * TAU * x + if k % 2 == 0 { 0.0 } else { 0.5 * TAU };
        let normal =
            Vector([0.0, turn.cos() * around.cos(), turn.sin() * around.cos()]) + Vector([around.sin(), 0.0, 0.0]);
        positions.push(Vector([x, 0.07 * turn.cos(), 0.07 * turn.sin()]) + normal * 0.04);
        normals.push(normal.unit());
    }
    PointSet { normals: Some(normals), ..PointSet::at(positions) }
}

/// Ripples of sand, `n` by `n` points on the unit square.
fn sand(n: u32) -> PointSet<3> {
    let mut stream = Stream::new(2, Stage::new(1), 0);
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    for k in 0..n * n {
        let mut at = |c: u32| (f64::from(c) + 0.5 + stream.range(-0.25, 0.25)) / f64::from(n);
        let (x, y) = (at(k % n), at(k / n));
        let phase = 5.0 * TAU * x + 0.8 * (TAU * y).sin();
        positions.push(Vector([x, y, 0.02 * phase.sin()]));
        normals.push(Vector([-0.1 * TAU * phase.cos(), 0.0, 1.0]).unit());
    }
    PointSet { normals: Some(normals), ..PointSet::at(positions) }
}

/// An open foam: points on a surface that repeats three times along each side of the unit cube.
fn foam(n: usize) -> PointSet<3> {
    let mut stream = Stream::new(3, Stage::new(1), 0);
    let level = |p: Vector<3>| p.0.iter().map(|x| (3.0 * TAU * x).cos()).sum::<f64>();
    let slope = |p: Vector<3>| p.map(|x| -(3.0 * TAU * x).sin());
    let (mut positions, mut normals): (Vec<Vector<3>>, Vec<Vector<3>>) = (Vec::new(), Vec::new());
    while positions.len() < n {
        let mut p = Vector([stream.unit(), stream.unit(), stream.unit()]);
        for _ in 0..6 {
            let s = slope(p);
            p += s * (-level(p) / (3.0 * TAU * s.norm2().max(0.1)));
        }
        let far = 0.8 / (n as f64).sqrt();
        if p.0.iter().all(|x| (0.0..1.0).contains(x)) && positions.iter().all(|q| (*q - p).norm() > far) {
            positions.push(p);
            normals.push(slope(p).unit_or_zero());
        }
    }
    PointSet { normals: Some(normals), ..PointSet::at(positions) }
}

fn run(exemplar: PointSet<3>, size: [f64; 3]) -> usize {
    let prepared = Prepared::new(Arc::new(exemplar), &StructureParams::default(), &Budget::default()).unwrap();
    let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector(size)));
    let request = StructureRequest::new(Arc::new(Flat::new(domain, Fields::default())));
    prepared.run(&request, &mut Unobserved).unwrap().points.len()
}

#[divan::bench(sample_count = 3)]
fn prepare_helix(bencher: divan::Bencher<'_, '_>) {
    let exemplar = Arc::new(helix());
    bencher.bench(|| Prepared::new(Arc::clone(&exemplar), &StructureParams::default(), &Budget::default()).unwrap());
}

#[divan::bench(args = [0.2, 1.0, 5.0], sample_count = 3)]
fn helix_of_length(bencher: divan::Bencher<'_, '_>, length: f64) {
    let exemplar = helix();
    bencher.bench(|| run(exemplar.clone(), [length, 0.4, 0.4]));
}

#[divan::bench(args = [1.0, 2.12, 4.0], sample_count = 2)]
fn sand_of_side(bencher: divan::Bencher<'_, '_>, side: f64) {
    let exemplar = sand(40);
    bencher.bench(|| run(exemplar.clone(), [side, side, 0.2]));
}

#[divan::bench(args = [1.0, 2.0], sample_count = 1)]
fn foam_of_side(bencher: divan::Bencher<'_, '_>, side: f64) {
    let exemplar = foam(1100);
    bencher.bench(|| run(exemplar.clone(), [side, side, side]));
}

/// One match of one window by sums over all pairs, as [Roveri 2015 eq. 5] has them.
#[divan::bench(args = [100, 600])]
fn exhaustive(bencher: divan::Bencher<'_, '_>, points: usize) {
    let all = helix().positions;
    let (x, sigma) = (&all[..points], 0.03);
    bencher.bench(|| {
        let sum = |p: &[Vector<3>], q: &[Vector<3>]| -> f64 {
            let g = |a: &Vector<3>, b: &Vector<3>| (-(*a - *b).norm2() / (2.0 * sigma * sigma)).exp();
            p.iter().map(|a| q.iter().map(|b| g(a, b)).sum::<f64>()).sum()
        };
        sum(x, x) - 2.0 * sum(x, &all) + sum(&all, &all)
    });
}
