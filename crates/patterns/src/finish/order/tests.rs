//! Tests of the painting order.

use std::f64::consts::TAU;

use arabesque_core::{Bounds, Class, Element, Exemplar, Matrix, Outline, Role, Similarity, Stage, Stream};

use super::*;
use crate::finish::clearance;

/// A disc, with its class.
#[derive(Clone, Copy)]
struct Disc {
    centre: Vector<2>,
    radius: f64,
    class: usize,
}

fn disc(x: f64, y: f64, radius: f64, class: usize) -> Disc {
    Disc { centre: Vector::xy(x, y), radius, class }
}

fn exemplar(discs: &[Disc]) -> Exemplar<2> {
    let element = |d: &Disc| {
        let corner = |k: u32| {
            let (s, c) = (f64::from(k) / 24.0 * TAU).sin_cos();
            d.centre + Vector::xy(c, s) * d.radius
        };
        Element {
            class: d.class,
            centre: d.centre,
            pose: Similarity::shift(d.centre),
            outline: Outline { rings: vec![(0..24).map(corner).collect()] },
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    };
    let classes = discs.iter().map(|d| d.class).max().unwrap_or(0) + 1;
    let names = (0..classes).map(|c| Class { name: c.to_string() }).collect();
    let window = Bounds::around(discs.iter().map(|d| d.centre)).grown(1.0);
    Exemplar::new("t", discs.iter().map(element).collect(), names, window).unwrap()
}

/// Discs in rows, each half a disc from its neighbours, in the order in which `rows` names the rows.
fn rows(rows: impl Iterator<Item = i32>, columns: i32, classes: usize, stream: &mut Stream) -> Vec<Disc> {
    let row = |y: i32| (0..columns).map(move |x| (20.0 * f64::from(x) + 10.0 * f64::from(y.rem_euclid(2)), y));
    rows.flat_map(row).map(|(x, y)| disc(x, 5.0 * f64::from(y), 10.0, stream.below(classes))).collect()
}

/// Where elements are put: which, where, how turned.
fn placed(known: &Exemplar<2>, source: usize, at: Vector<2>, turn: f64) -> Placement<2> {
    let transform = Similarity::about(known.elements[source].centre, at, Matrix::rotation(turn), 1.0);
    Placement { source, transform, control: Vec::new(), frozen: None }
}

fn sorted(known: &Exemplar<2>, placements: &mut Vec<Placement<2>>, domain: &Domain<2>) -> Sorted<2> {
    let budget = Budget::default();
    let clearance = clearance::measure(known, &budget).unwrap();
    let order = clearance.as_ref().and_then(|known| ExemplarOrder::new(known, &budget).unwrap());
    sort(placements, order.as_ref(), clearance.as_ref(), domain, &budget).unwrap()
}

fn centre(known: &Exemplar<2>, p: &Placement<2>) -> Vector<2> {
    p.transform.apply(known.elements[p.source].centre)
}

fn page(width: f64, height: f64) -> Domain<2> {
    Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(width, height)))
}

/// Discs at the places of a larger lattice, in any order and with a slight jitter.
fn larger(known: &Exemplar<2>, [columns, rows]: [i32; 2], stream: &mut Stream) -> Vec<Placement<2>> {
    let mut all = Vec::new();
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        let jitter = Vector::xy(stream.range(-0.3, 0.3), stream.range(-0.3, 0.3));
        let at = Vector::xy(20.0 * f64::from(x) + 10.0 * f64::from(y % 2) + 1.0, 5.0 * f64::from(y) + 1.0);
        all.push(placed(known, stream.below(known.elements.len()), at + jitter, 0.0));
    }
    stream.shuffle(&mut all);
    all
}

/// Pairs of rows that lie the wrong way round: `places` from bottom to top.
fn wrong(places: &[Vector<2>], down: bool) -> usize {
    let overlap = |p: Vector<2>, q: Vector<2>| (p - q).norm() < 18.0 && (p[1] - q[1]).abs() > 2.0;
    let pairs = places.iter().enumerate().flat_map(|(k, &p)| places[k + 1..].iter().map(move |&q| (p, q)));
    pairs.filter(|&(p, q)| overlap(p, q) && (q[1] > p[1]) != down).count()
}

#[test]
fn every_row_covers_the_one_before_it() {
    for seed in 0..5 {
        for (down, classes) in [(true, 1), (false, 1), (true, 4)] {
            let mut stream = Stream::new(seed, Stage::TEST, 0);
            let order: Vec<i32> = if down { (0..12).collect() } else { (0..12).rev().collect() };
            let known = exemplar(&rows(order.into_iter(), 5, classes, &mut stream));
            let mut all = larger(&known, [9, 30], &mut stream);
            let found = sorted(&known, &mut all, &page(180.0, 150.0));
            let places: Vec<_> = all.iter().map(|p| centre(&known, p)).collect();
            assert_eq!((wrong(&places, down), found.warning), (0, None), "seed {seed}, {classes} classes");
            assert!(found.sequence.is_empty());
        }
    }
}

#[test]
fn rows_over_rows_close_up_around_a_tile() {
    for seed in 0..5 {
        let mut stream = Stream::new(seed, Stage::TEST, 1);
        let known = exemplar(&rows(0..12, 5, 1, &mut stream));
        let mut all = larger(&known, [5, 16], &mut stream);
        let tile = Domain::Torus(Bounds::new(Vector::ZERO, Vector::xy(100.0, 80.0)));
        let found = sorted(&known, &mut all, &tile);
        assert!(found.warning.is_none() && found.sequence.len() > all.len());
        let shift = |i: &Instance<2>| Vector::xy(100.0 * f64::from(i.around[0]), 80.0 * f64::from(i.around[1]));
        let places: Vec<_> = found.sequence.iter().map(|i| centre(&known, &all[i.placement]) + shift(i)).collect();
        assert_eq!(wrong(&places, true), 0, "seed {seed}");
        // Each of the placements is drawn itself, in their order.
        let itself = found.sequence.iter().filter(|i| i.around == [0, 0]).map(|i| i.placement);
        assert!(itself.eq(0..all.len()));
    }
}

#[test]
fn a_pattern_that_is_turned_is_covered_from_another_side() {
    let mut stream = Stream::new(7, Stage::TEST, 2);
    let known = exemplar(&rows(0..12, 5, 1, &mut stream));
    let quarter = Matrix::rotation(0.25 * TAU);
    let mut all: Vec<_> = larger(&known, [6, 20], &mut stream)
        .iter()
        .map(|p| placed(&known, p.source, quarter.apply(centre(&known, p)), 0.25 * TAU))
        .collect();
    sorted(&known, &mut all, &page(100.0, 100.0));
    let back: Vec<_> = all.iter().map(|p| quarter.transpose().apply(centre(&known, p))).collect();
    assert_eq!(wrong(&back, true), 0);
}

#[test]
fn the_exemplar_itself_comes_out_as_it_is() {
    for seed in 0..40 {
        let mut stream = Stream::new(seed, Stage::TEST, 3);
        let discs: Vec<_> = (0..14)
            .map(|k| disc(stream.range(0.0, 60.0), stream.range(0.0, 60.0), stream.range(6.0, 14.0), k % 3))
            .collect();
        let known = exemplar(&discs);
        let mut all: Vec<_> = (0..discs.len()).map(|k| placed(&known, k, discs[k].centre, 0.0)).collect();
        stream.shuffle(&mut all);
        let found = sorted(&known, &mut all, &page(60.0, 60.0));
        assert!(found.warning.is_none(), "seed {seed}");
        let rank = |k: usize| all.iter().position(|p| p.source == k);
        for (i, j) in (0..discs.len()).flat_map(|j| (0..j).map(move |i| (i, j))) {
            let apart = (discs[i].centre - discs[j].centre).norm() / (discs[i].radius + discs[j].radius);
            assert!(apart > 0.95 || rank(i) < rank(j), "seed {seed}: {i} lies below {j}");
        }
    }
}

#[test]
fn what_does_not_overlap_in_the_exemplar_stays_in_its_order() {
    let known = exemplar(&[disc(0.0, 0.0, 4.0, 0), disc(20.0, 0.0, 4.0, 0), disc(40.0, 0.0, 4.0, 0)]);
    let mut all: Vec<_> = [2, 0, 1].map(|k| placed(&known, k, Vector::xy(f64::from(k as u8), 0.0), 0.0)).to_vec();
    sorted(&known, &mut all, &page(60.0, 60.0));
    assert!(all.iter().map(|p| p.source).eq([2, 0, 1]));
}

#[test]
fn circles_are_cut_and_told() {
    // Each of three classes covers the one before it, the first the last.
    let pairs = [(0, 1), (1, 2), (2, 0)];
    let corner = |k: usize| {
        let (s, c) = (k as f64 / 3.0 * TAU).sin_cos();
        Vector::xy(50.0 + 5.0 * c, 50.0 + 5.0 * s)
    };
    let apart = |k: usize, class: usize| corner(class) + Vector::xy(100.0 * k as f64, 0.0);
    let at = |k: usize, class: usize| disc(apart(k, class)[0], apart(k, class)[1], 10.0, class);
    let discs: Vec<_> = pairs.iter().enumerate().flat_map(|(k, &(a, b))| [at(k, a), at(k, b)]).collect();
    let known = exemplar(&discs);
    let mut all: Vec<_> = (0..3).map(|k| placed(&known, 2 * k, corner(k), 0.0)).collect();
    let told = sorted(&known, &mut all, &page(100.0, 100.0)).warning.unwrap();
    assert!(told.message.contains("of 3 overlaps 1 are the other way round"), "{}", told.message);
}

#[test]
fn what_the_user_placed_keeps_its_own_order() {
    let mut stream = Stream::new(3, Stage::TEST, 4);
    let known = exemplar(&rows(0..12, 5, 1, &mut stream));
    let mut all: Vec<_> = (0..2).map(|k| placed(&known, 0, Vector::xy(50.0, 50.0 - 5.0 * f64::from(k)), 0.0)).collect();
    all[0].frozen = Some(0);
    all[1].frozen = Some(1);
    all.reverse();
    all.push(placed(&known, 0, Vector::xy(60.0, 40.0), 0.0));
    sorted(&known, &mut all, &page(100.0, 100.0));
    assert!(all.iter().map(|p| p.frozen).eq([None, Some(0), Some(1)]));
}
