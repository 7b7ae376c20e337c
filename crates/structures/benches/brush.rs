//! A stroke of the brush, at a size that is published: a helix of 600 points, of which about 100 are in reach of a stroke.
//!
//! `cargo bench -p arabesque-structures --bench brush`: the method as published takes 4 s to convergence, the one before it 12 s.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]
#![allow(missing_docs, reason = "the macros of divan make items without any")]

use std::{f64::consts::TAU, ops::ControlFlow, sync::Arc};

use arabesque_core::{Budget, PointSet, Progress, Unobserved, Vector, Watch};
use arabesque_structures::{Brush, Prepared, Stroke, StructureParams};

fn main() {
    divan::main();
}

/// 600 points along a helix of 24 turns.
fn helix() -> PointSet<3> {
    let at = |k: u32| (f64::from(k) + 0.5) / 600.0;
    let place = |x: f64| Vector([x, 0.02 * (24.0 * TAU * x).cos(), 0.02 * (24.0 * TAU * x).sin()]);
    PointSet::at((0..600).map(|k| place(at(k))).collect())
}

/// A brush that has painted for a while, and the stroke that comes next, about 100 points long.
fn painted() -> (Brush<3>, Stroke<3>) {
    let prepared = Prepared::new(Arc::new(helix()), &StructureParams::default(), &Budget::default()).unwrap();
    let mut brush = Brush::new(Arc::new(prepared), 1);
    let first = Stroke::new(vec![Vector::ZERO, Vector([1.0, 0.2, 0.0])], 0.02);
    brush.stroke(&first, &Budget::default(), &mut Unobserved).unwrap();
    (brush, Stroke::new(vec![Vector([1.0, 0.2, 0.0]), Vector([1.16, 0.25, 0.02])], 0.02))
}

/// Stops at the first change.
struct First;

impl<P> Watch<P> for First {
    fn step(&mut self, _: &Progress, preview: &dyn Fn() -> P) -> ControlFlow<()> {
        divan::black_box(preview());
        ControlFlow::Break(())
    }
}

#[divan::bench]
fn helix_brush_600_points_100_in_reach(bencher: divan::Bencher<'_, '_>) {
    let (brush, stroke) = painted();
    let paint = |mut brush: Brush<3>| brush.stroke(&stroke, &Budget::default(), &mut Unobserved).unwrap();
    bencher.with_inputs(|| brush.clone()).bench_values(paint);
}

#[divan::bench]
fn helix_brush_first_change(bencher: divan::Bencher<'_, '_>) {
    let (brush, stroke) = painted();
    let paint = |mut brush: Brush<3>| brush.stroke(&stroke, &Budget::default(), &mut First).unwrap();
    bencher.with_inputs(|| brush.clone()).bench_values(paint);
}
