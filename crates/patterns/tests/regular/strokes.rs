//! Strokes that repeat lie where the drawing would have them.

use arabesque_core::{Bounds, Domain, Request, Vector};
use std::f64::consts::PI;

use crate::{
    drawing::{Pattern, Piece, xy},
    elements::frame,
    measure::{TOLERANCE, hausdorff, page, prepared, run},
};

fn piece(points: &[(f64, f64)], style: usize) -> Piece {
    Piece { points: points.iter().map(|&(x, y)| xy(x, y)).collect(), style }
}

fn line(from: (f64, f64), to: (f64, f64), style: usize) -> Piece {
    piece(&[from, to], style)
}

/// Lines of three styles across one another.
pub(crate) fn plaid() -> Pattern {
    let across = [(0.1, 0), (0.3, 1), (0.62, 2)];
    let both = |(at, style): (f64, usize)| [line((0.0, at), (1.0, at), style), line((at, 0.0), (at, 1.0), style)];
    Pattern::of_pieces([xy(1.0, 0.0), xy(0.0, 1.0)], across.into_iter().flat_map(both).collect())
}

/// A slanted lattice, every line drawn twice: its casing and its core.
fn lattice_with_casings() -> Pattern {
    let (a, b) = ((1.0, 0.6), (1.0, -0.6));
    let pieces = [0, 1].into_iter().flat_map(|style| [line((0.0, 0.0), a, style), line((0.0, 0.0), b, style)]);
    Pattern::of_pieces([xy(a.0, a.1), xy(b.0, b.1)], pieces.collect())
}

/// Waves, row over row.
fn waves() -> Pattern {
    let wave = |y: f64, style| {
        let at = |k: i32| (f64::from(k) / 40.0, y + 0.18 * (2.0 * PI * f64::from(k) / 40.0).sin());
        piece(&(0..=40).map(at).collect::<Vec<_>>(), style)
    };
    Pattern::of_pieces([xy(1.0, 0.0), xy(0.0, 0.7)], vec![wave(0.2, 0), wave(0.43, 1)])
}

/// The net of a honeycomb.
pub(crate) fn honeycomb() -> Pattern {
    let half = 0.75_f64.sqrt();
    let c = (0.5, 0.5 / 3.0_f64.sqrt());
    let pieces =
        vec![line((0.0, 0.0), (c.0, c.1), 0), line((1.0, 0.0), (c.0, c.1), 0), line((0.5, half), (c.0, c.1), 0)];
    Pattern::of_pieces([xy(1.0, 0.0), xy(0.5, half)], pieces)
}

/// Chevrons with sharp corners.
pub(crate) fn chevrons() -> Pattern {
    Pattern::of_pieces([xy(1.0, 0.0), xy(0.0, 0.5)], vec![piece(&[(0.0, 0.0), (0.5, 0.35), (1.0, 0.0)], 0)])
}

/// Arcs of scales.
fn scallops() -> Pattern {
    let arc: Vec<(f64, f64)> =
        (0..=30).map(|k| PI * f64::from(k) / 30.0).map(|t| (0.5 - 0.5 * t.cos(), 0.5 * t.sin())).collect();
    Pattern::of_pieces([xy(1.0, 0.0), xy(0.5, 0.5)], vec![piece(&arc, 0)])
}

fn check(name: &str, pattern: &Pattern, k: usize, periods: f64) {
    let window = frame(pattern, k);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, name);
    let unit = pattern.shorter();
    let page = page(periods * unit, 0.6 * periods * unit);
    for seed in [0, 4] {
        let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
        let off = hausdorff(pattern, &exemplar, &outcome, page.min - window.min, &page);
        assert!(off <= TOLERANCE * unit, "{name}, seed {seed}: {:.4} of a period off", off / unit);
    }
}

#[test]
fn lines_and_nets_are_continued_exactly() {
    let all = [
        ("plaid", plaid()),
        ("lattice with casings", lattice_with_casings()),
        ("waves", waves()),
        ("honeycomb", honeycomb()),
        ("chevrons", chevrons()),
        ("scallops", scallops()),
    ];
    for (k, (name, pattern)) in all.into_iter().enumerate() {
        for (n, scale) in [0.5, 24.0, 500.0].into_iter().enumerate() {
            check(name, &pattern.scaled(scale), k + n, 8.3);
        }
    }
}

#[test]
fn strokes_do_not_drift_over_a_hundred_cells() {
    let pattern = waves().scaled(17.0);
    let window = frame(&pattern, 2);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "waves");
    let unit = pattern.shorter();
    let page = page(150.0 * unit, 3.0 * unit);
    let outcome = run(&prepared, &Request::new(Domain::Box(page)));
    let off = hausdorff(&pattern, &exemplar, &outcome, page.min - window.min, &page);
    assert!(off <= TOLERANCE * unit, "{:.4} of a period off", off / unit);
    // Each line is one stroke from border to border.
    let ends = outcome.curves.iter().flat_map(|c| [c.path.start().unwrap(), c.path.end().unwrap()]);
    for end in ends {
        assert!(page.signed_distance(end).abs() < 0.03 * unit, "a stroke ends at {end:?}");
    }
}

#[test]
fn stripes_repeat_across_themselves() {
    let window = Bounds::new(Vector::ZERO, xy(70.0, 40.0));
    let at = |k: usize| 3.0 + 20.0 * (k / 2) as f64 + 7.0 * (k % 2) as f64;
    let lines: Vec<_> = (0..7).map(|k| (vec![xy(at(k), 0.0), xy(at(k), 40.0)], k % 2)).collect();
    let exemplar = crate::drawing::exemplar(&[], &lines, window);
    let prepared = prepared(&exemplar, "stripes");
    let step = prepared.repeat().unwrap().step(&window).unwrap();
    assert!((step - xy(20.0, 0.0)).norm() < 1e-6, "{step:?}");
    let page = page(400.0, 90.0);
    let outcome = run(&prepared, &Request::new(Domain::Box(page)));
    let mut found: Vec<(f64, usize)> =
        outcome.curves.iter().map(|c| (c.path.start().unwrap()[0], exemplar.curves[c.source].style)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted: Vec<(f64, usize)> = (0..40).map(|k| (at(k), k % 2)).filter(|(x, _)| *x < 400.0).collect();
    assert_eq!(found.len(), wanted.len());
    for ((x, style), (there, other)) in found.iter().zip(&wanted) {
        assert!((x - there).abs() < 0.2 && style == other, "{x} for {there}");
    }
}
