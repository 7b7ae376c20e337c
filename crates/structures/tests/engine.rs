//! The engine on small drawings made here.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::{f64::consts::TAU, ops::ControlFlow, sync::Arc};

use arabesque_core::{
    Bounds, Budget, Domain, Fields, Limits, PointSet, Progress, Stage, StopReason, Stream, Unobserved, Vector, Watch,
};
use arabesque_structures::{Flat, Prepared, Start, StructureOutcome, StructureParams, StructureRequest, Thread, Tube};

/// A wavy line of points 1 long, with normals.
fn wave() -> PointSet<2> {
    let at = |k: usize| k as f64 / 100.0;
    let positions = (0..100).map(|k| Vector::xy(at(k), 0.05 * (at(k) * 5.0 * TAU).sin())).collect();
    let slope = |k: usize| 0.25 * TAU * (at(k) * 5.0 * TAU).cos();
    let normals = (0..100).map(|k| Vector::xy(-slope(k), 1.0).unit()).collect();
    PointSet { normals: Some(normals), ..PointSet::at(positions) }
}

/// A square grid of points, `n` along each side of a unit square.
fn lattice(n: usize) -> PointSet<2> {
    let at = |k: usize| (k as f64 + 0.5) / n as f64;
    PointSet::at((0..n * n).map(|k| Vector::xy(at(k % n), at(k / n))).collect())
}

/// Pairs of points as rigid elements, at random angles in a loose grid.
fn dumbbells() -> PointSet<2> {
    let mut stream = Stream::new(5, Stage::TEST, 0);
    let (mut positions, mut elements) = (Vec::new(), Vec::new());
    for k in 0..36 {
        let mut jitter = || stream.range(-0.02, 0.02);
        let centre = Vector::xy((f64::from(k % 6) + 0.5) / 6.0 + jitter(), (f64::from(k / 6) + 0.5) / 6.0 + jitter());
        let arm = Vector::xy(0.03, 30.0 * jitter() * 0.03);
        positions.extend([centre - arm, centre, centre + arm]);
        elements.extend([k, k, k]);
    }
    PointSet { elements: Some(elements), ..PointSet::at(positions) }
}

fn square(side: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::splat(side))
}

fn fill(exemplar: PointSet<2>, domain: Domain<2>, params: &StructureParams, seed: u64) -> StructureOutcome<2> {
    let prepared = Prepared::new(Arc::new(exemplar), params, &Budget::default()).unwrap();
    let territory = Arc::new(Flat::new(domain, Fields::default()));
    let request = StructureRequest { seed, ..StructureRequest::new(territory) };
    prepared.run(&request, &mut Unobserved).unwrap()
}

fn nearest(points: &[Vector<2>], i: usize) -> f64 {
    let others = points.iter().enumerate().filter(|(j, _)| *j != i);
    others.map(|(_, &p)| (p - points[i]).norm()).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_lattice_stays_a_lattice() {
    let outcome = fill(lattice(12), Domain::Box(square(1.6)), &StructureParams::default(), 1);
    let points = &outcome.points.positions;
    let expected = 144.0 * 1.6 * 1.6;
    assert!((points.len() as f64 / expected - 1.0).abs() < 0.08, "{} for {expected}", points.len());
    let inner = |p: &Vector<2>| square(1.6).signed_distance(*p) > 0.1;
    let off: Vec<f64> =
        (0..points.len()).filter(|&i| inner(&points[i])).map(|i| (nearest(points, i) * 12.0 - 1.0).abs()).collect();
    let bad = off.iter().filter(|d| **d > 0.15).count();
    assert!(bad * 50 < off.len(), "{bad} of {}", off.len());
}

#[test]
fn a_wave_goes_on_along_a_ring() {
    let corners = (0..=200).map(|k| f64::from(k) / 200.0 * TAU).map(|a| Vector::xy(a.cos(), a.sin()) * 0.5).collect();
    let prepared = Prepared::new(Arc::new(wave()), &StructureParams::default(), &Budget::default()).unwrap();
    assert_eq!(prepared.repeats(), 1);
    let tube = Tube::new(vec![Thread::new(corners)], 0.1).unwrap();
    let outcome = prepared.run(&StructureRequest::new(Arc::new(tube)), &mut Unobserved).unwrap();
    let radii: Vec<f64> = outcome.points.positions.iter().map(|p| p.norm()).collect();
    let (least, most) = radii.iter().fold((9.0_f64, 0.0_f64), |(a, b), &r| (a.min(r), b.max(r)));
    assert!(least > 0.42 && least < 0.47 && most > 0.53 && most < 0.58, "{least} {most}");
    let apart: Vec<f64> = (0..radii.len()).map(|i| nearest(&outcome.points.positions, i)).collect();
    assert!(apart.iter().all(|&d| d > 0.003 && d < 0.03), "{apart:?}");
    let normals = outcome.points.normals.unwrap();
    let inwards = |i: usize| normals[i].dot(outcome.points.positions[i]) < 0.0;
    assert!((0..radii.len()).all(inwards), "the pattern's up is the left of the curve, inside of a ring");
}

#[test]
fn rigid_elements_are_congruent_to_the_exemplars() {
    let exemplar = dumbbells();
    let outcome = fill(exemplar.clone(), Domain::Box(square(1.5)), &StructureParams::default(), 2);
    let numbers = outcome.points.elements.as_ref().unwrap();
    assert!(outcome.elements.len() > 50, "{}", outcome.elements.len());
    for (n, element) in outcome.elements.iter().enumerate() {
        let members: Vec<usize> =
            (0..36 * 3).filter(|&i| exemplar.elements.as_ref().unwrap()[i] == element.element).collect();
        assert_eq!(members.len(), element.points.len());
        for (k, &from) in element.points.clone().zip(&members) {
            assert_eq!(outcome.points.positions[k], element.pose.apply(exemplar.positions[from]));
            assert_eq!((numbers[k], outcome.sources[k]), (n as i32, Some(from)));
        }
        let r = element.pose.rotation;
        let product = r.compose(&r.transpose());
        assert!((0..2).all(|k| (product.0[k][k] - 1.0).abs() < 1e-12) && element.pose.scale == 1.0);
    }
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            fill(wave(), Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(2.0, 0.0))), &StructureParams::default(), 7)
        })
    };
    let one = run(1);
    for threads in [2, 8] {
        let other = run(threads);
        assert_eq!((&one.points, &one.energy), (&other.points, &other.energy));
    }
    let other =
        fill(wave(), Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(2.0, 0.0))), &StructureParams::default(), 8);
    assert_ne!(one.points, other.points);
}

#[test]
fn wherever_it_starts_the_wave_comes_out() {
    for start in [Start::Grow, Start::Patches, Start::Noise] {
        let params = StructureParams { start, ..StructureParams::default() };
        let outcome = fill(wave(), Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(2.0, 0.0))), &params, 3);
        let points = &outcome.points.positions;
        assert!((170..=230).contains(&points.len()), "{}: {}", start.name(), points.len());
        // On one line: no two points above each other.
        let mut order = points.clone();
        order.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let jumps = order.windows(2).filter(|w| (w[1] - w[0]).norm() > 0.03).count();
        // Patches that do not fit leave a step here and there.
        let most = if start == Start::Grow { 5 } else { 16 };
        assert!(jumps <= most, "{}: {jumps} jumps", start.name());
    }
}

#[test]
fn a_tile_has_no_border() {
    let outcome = fill(lattice(12), Domain::Torus(square(1.0)), &StructureParams::default(), 4);
    let points = &outcome.points.positions;
    assert!(points.iter().all(|p| square(1.0).contains(*p)));
    assert!((125..=160).contains(&points.len()), "{}", points.len());
}

/// Stops at one step.
struct StopAt(usize);

impl<P> Watch<P> for StopAt {
    fn step(&mut self, _: &Progress, _: &dyn Fn() -> P) -> ControlFlow<()> {
        self.0 -= 1;
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn stopped_early_it_gives_what_there_is() {
    let prepared = Prepared::new(Arc::new(wave()), &StructureParams::default(), &Budget::default()).unwrap();
    let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(2.0, 0.0)));
    let request = StructureRequest::new(Arc::new(Flat::new(domain, Fields::default())));
    let outcome = prepared.run(&request, &mut StopAt(2)).unwrap();
    assert_eq!((outcome.stopped, outcome.energy.len()), (StopReason::Stopped, 2));
    assert!(outcome.points.len() > 100);
    let tight = Budget::new(Limits { work: 1, work_per_element: 0, ..Limits::default() });
    assert!(prepared.run(&StructureRequest { budget: tight, ..request }, &mut Unobserved).is_err());
}

#[test]
fn bad_exemplars_are_refused_with_a_reason() {
    let refused = |points: PointSet<2>| {
        Prepared::new(Arc::new(points), &StructureParams::default(), &Budget::default()).unwrap_err().to_string()
    };
    assert!(refused(PointSet::at(vec![Vector::xy(0.0, 0.0); 9])).contains("9 points"));
    assert!(refused(PointSet::at(vec![Vector::xy(1.0, 2.0); 30])).contains("one place"));
    let mut broken = lattice(5);
    broken.positions[7][1] = f64::NAN;
    assert!(refused(broken).contains("point 8"));
    let params = StructureParams { window: Some(40.0), ..StructureParams::default() };
    let error = Prepared::new(Arc::new(lattice(12)), &params, &Budget::default()).unwrap_err().to_string();
    assert!(error.contains("window") && error.contains("at most"), "{error}");
    assert!(Tube::<2>::new(vec![Thread::new(vec![Vector::ZERO; 4])], 0.1).is_err());
}

#[test]
fn kept_points_stay_to_the_last_bit() {
    let kept = PointSet::at(vec![Vector::xy(0.5, 0.0123), Vector::xy(0.51, 0.0234)]);
    let prepared = Prepared::new(Arc::new(wave()), &StructureParams::default(), &Budget::default()).unwrap();
    let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(1.5, 0.0)));
    let request = StructureRequest {
        kept: kept.clone(),
        ..StructureRequest::new(Arc::new(Flat::new(domain, Fields::default())))
    };
    let outcome = prepared.run(&request, &mut Unobserved).unwrap();
    assert_eq!(outcome.points.positions[..2], kept.positions[..]);
    assert_eq!(outcome.sources[..2], [None, None]);
}

#[test]
fn classes_of_a_checkerboard_take_turns() {
    let exemplar =
        PointSet { classes: Some((0..144).map(|k| 5 - 3 * ((k % 12 + k / 12) % 2)).collect()), ..lattice(12) };
    for start in [Start::Grow, Start::Noise] {
        let params = StructureParams { start, ..StructureParams::default() };
        let outcome = fill(exemplar.clone(), Domain::Box(square(1.6)), &params, 4);
        let (points, classes) = (&outcome.points.positions, outcome.points.classes.as_ref().unwrap());
        assert!(classes.iter().all(|c| [2, 5].contains(c)) && classes.len() == points.len());
        let next = |i: usize| {
            (0..points.len())
                .filter(|&j| j != i)
                .min_by(|&a, &b| (points[a] - points[i]).norm().total_cmp(&(points[b] - points[i]).norm()))
        };
        let same = (0..points.len()).filter(|&i| next(i).is_some_and(|j| classes[j] == classes[i])).count();
        // At random, half of all would have a neighbour like themselves.
        let most = if start == Start::Grow { 20 } else { 5 };
        assert!(same * most < points.len(), "{}: {same} of {}", start.name(), points.len());
    }
}

#[test]
fn more_classes_than_channels_go_with_their_points() {
    let exemplar = PointSet { classes: Some((0..144).map(|k| k % 12 + 12 * (k / 72)).collect()), ..lattice(12) };
    let outcome = fill(exemplar.clone(), Domain::Box(square(1.2)), &StructureParams::default(), 4);
    let own = exemplar.classes.unwrap();
    let classes = outcome.points.classes.unwrap();
    assert!(outcome.sources.iter().zip(&classes).all(|(s, c)| s.is_none_or(|s| own[s] == *c)));
}

#[test]
fn elements_are_as_many_and_as_far_apart_as_in_the_exemplar() {
    let exemplar = dumbbells();
    let least = |points: &PointSet<2>| {
        let (p, e) = (&points.positions, points.elements.as_ref().unwrap());
        let pairs = (0..p.len()).flat_map(|i| (0..i).map(move |j| (i, j))).filter(|&(i, j)| e[i] != e[j]);
        pairs.map(|(i, j)| (p[i] - p[j]).norm()).fold(f64::INFINITY, f64::min)
    };
    let wanted = least(&exemplar);
    for seed in 0..3 {
        let outcome = fill(exemplar.clone(), Domain::Box(square(2.0)), &StructureParams::default(), seed);
        let found = least(&outcome.points);
        assert!(found > 0.5 * wanted, "{found} where the exemplar has {wanted}");
        let count = outcome.elements.len();
        assert!((120..=165).contains(&count), "{count} where 144 were expected");
    }
}
