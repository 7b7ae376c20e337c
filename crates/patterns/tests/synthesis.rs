//! Whole runs on tiny named exemplars.

#![allow(clippy::unwrap_used, reason = "a test may panic, its helpers as well")]

use std::ops::ControlFlow;

use arabesque_core::{
    Border, Bounds, Budget, Domain, Exemplar, Fields, FillRule, Matrix, OrientationField, Outcome, Placement, Progress,
    Region, Request, ScalarField, Shape, Similarity, Snapshot, StopReason, Unobserved, Vector, Watch,
};
use arabesque_patterns::{Params, Prepared, Repeats};

/// The engine alone: these patterns repeat, and would be continued by their repeat.
fn irregular() -> Params {
    Params { repeat: Repeats::Off, ..Params::default() }
}

/// A square grid of `side` x `side` points at distance 1, classes by `class_of`.
fn grid(side: usize, class_of: impl Fn(usize, usize) -> usize) -> Exemplar<2> {
    let cells: Vec<_> = (0..side * side).map(|i| (i % side, i / side)).collect();
    let points: Vec<_> = cells.iter().map(|&(x, y)| Vector::xy(x as f64, y as f64)).collect();
    let classes: Vec<_> = cells.iter().map(|&(x, y)| class_of(x, y)).collect();
    let names: Vec<_> = (0..=classes.iter().copied().max().unwrap_or(0)).map(|c| c.to_string()).collect();
    Exemplar::from_points("grid", &points, &classes, &names).unwrap()
}

fn page(w: f64, h: f64) -> Domain<2> {
    Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(w, h)))
}

fn fill(exemplar: &Exemplar<2>, request: &Request<2>) -> Outcome<2> {
    Prepared::new(exemplar.clone(), &irregular(), &Budget::default()).unwrap().run(request, &mut Unobserved).unwrap()
}

fn centres(exemplar: &Exemplar<2>, outcome: &Outcome<2>) -> Vec<(usize, Vector<2>)> {
    let place = |p: &Placement<2>| p.transform.apply(exemplar.elements[p.source].centre);
    outcome.placements.iter().map(|p| (exemplar.elements[p.source].class, place(p))).collect()
}

/// The nearest other centre to each one, with its class.
fn nearest(centres: &[(usize, Vector<2>)]) -> Vec<(usize, usize, f64)> {
    let one = |i: usize| {
        let others = (0..centres.len()).filter(|&j| j != i);
        let distance = |j: usize| (centres[j].1 - centres[i].1).norm();
        let j = others.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap();
        (centres[i].0, centres[j].0, distance(j))
    };
    (0..centres.len()).map(one).collect()
}

#[test]
fn a_grid_stays_a_grid() {
    let exemplar = grid(8, |_, _| 0);
    let outcome = fill(&exemplar, &Request::new(page(24.0, 24.0)));
    let centres = centres(&exemplar, &outcome);
    assert!((550..=650).contains(&centres.len()), "{}", centres.len());
    for (_, _, distance) in nearest(&centres) {
        assert!((distance - 1.0).abs() < 0.03, "{distance}");
    }
}

#[test]
fn two_classes_alternate() {
    let exemplar = grid(9, |x, y| (x + y) % 2);
    let outcome = fill(&exemplar, &Request::new(page(20.0, 20.0)));
    for (own, other, distance) in nearest(&centres(&exemplar, &outcome)) {
        assert!((distance - 1.0).abs() < 0.05, "{distance}");
        assert_ne!(own, other);
    }
}

#[test]
fn a_tile_is_periodic() {
    let exemplar = grid(8, |_, _| 0);
    let domain = Domain::Torus(Bounds::new(Vector::ZERO, Vector::xy(16.0, 12.0)));
    let outcome = fill(&exemplar, &Request::new(domain.clone()));
    let centres = centres(&exemplar, &outcome);
    assert_eq!(centres.len(), 16 * 12);
    for &(_, p) in &centres {
        let gap = centres.iter().map(|&(_, q)| domain.offset(p, q).norm()).filter(|d| *d > 0.0);
        let gap = gap.fold(f64::INFINITY, f64::min);
        assert!((gap - 1.0).abs() < 0.1, "{gap}");
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let exemplar = grid(7, |x, y| usize::from((x * 5 + y * 3) % 4 == 0));
    let request = Request { seed: 3, ..Request::new(page(30.0, 20.0)) };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&exemplar, &request)).placements
    };
    let one = run(1);
    [2, 3, 8].into_iter().for_each(|threads| assert_eq!(one, run(threads), "{threads} threads"));
}

#[test]
fn seeds_differ() {
    let exemplar = grid(7, |x, y| usize::from((x * 5 + y * 3) % 4 == 0));
    let run = |seed| fill(&exemplar, &Request { seed, ..Request::new(page(20.0, 20.0)) }).placements;
    assert_ne!(run(1), run(2));
}

#[test]
fn a_frozen_element_stays_put_to_the_last_bit() {
    let exemplar = grid(8, |_, _| 0);
    let at = Vector::xy(7.123_456_789, 6.987_654_321);
    let transform = Similarity::about(exemplar.elements[5].centre, at, Matrix::rotation(0.3), 1.0);
    let frozen = Placement { source: 5, transform, control: Vec::new(), frozen: None };
    let request = Request { frozen: vec![frozen], ..Request::new(page(15.0, 15.0)) };
    let outcome = fill(&exemplar, &request);
    let kept: Vec<_> = outcome.placements.iter().filter(|p| p.frozen == Some(0)).collect();
    assert_eq!(kept.len(), 1);
    assert_eq!(kept[0].transform, transform);
    // The rest of the lattice is fitted around it.
    let near = centres(&exemplar, &outcome).iter().filter(|(_, p)| (*p - at).norm() < 0.5).count();
    assert_eq!(near, 1);
}

#[test]
fn a_shape_with_a_hole_is_filled_and_the_hole_is_not() {
    let exemplar = grid(8, |_, _| 0);
    let square = |low: f64, high: f64| {
        vec![Vector::xy(low, low), Vector::xy(high, low), Vector::xy(high, high), Vector::xy(low, high)]
    };
    let shape = Shape::new(&[square(0.0, 20.0), square(7.0, 13.0)], FillRule::EvenOdd).unwrap();
    let domain = Domain::Region(std::sync::Arc::new(shape.clone()));
    let outcome = fill(&exemplar, &Request { border: Border::Inside, ..Request::new(domain) });
    let expected = shape.measure();
    assert!((outcome.placements.len() as f64 - expected).abs() < 0.12 * expected, "{}", outcome.placements.len());
    assert!(centres(&exemplar, &outcome).iter().all(|(_, p)| shape.signed_distance(*p) >= 0.0));
}

#[test]
fn an_orientation_field_turns_rows() {
    let exemplar = grid(8, |_, y| y % 2);
    let orientation = Some(OrientationField::Constant(Matrix::rotation(std::f64::consts::FRAC_PI_4)));
    let fields = Fields { orientation, ..Fields::default() };
    let outcome = fill(&exemplar, &Request { fields, ..Request::new(page(20.0, 20.0)) });
    let centres = centres(&exemplar, &outcome);
    let along = Vector::xy(1.0, 1.0) * 0.5_f64.sqrt();
    let (mut right, mut all) = (0, 0);
    for &(class, p) in &centres {
        for &(other, q) in &centres {
            let offset = q - p;
            if (0.5..1.2).contains(&offset.norm()) {
                all += 1;
                // Rows run along the diagonal: same class along it, the other class across.
                right += usize::from((offset.dot(along).abs() > 0.7) == (class == other));
            }
        }
    }
    assert!(right * 100 >= all * 95, "{right} of {all}");
}

#[test]
fn scale_and_density_change_the_number_of_elements() {
    let exemplar = grid(8, |_, _| 0);
    let count = |scale, density| {
        let fields =
            Fields { orientation: None, scale: ScalarField::Constant(scale), density: ScalarField::Constant(density) };
        fill(&exemplar, &Request { fields, ..Request::new(page(24.0, 24.0)) }).placements
    };
    let (plain, large, thin) = (count(1.0, 1.0), count(2.0, 1.0), count(1.0, 0.25));
    assert!((plain.len() as f64 / large.len() as f64 - 4.0).abs() < 0.8, "{} {}", plain.len(), large.len());
    assert!((plain.len() as f64 / thin.len() as f64 - 4.0).abs() < 0.8, "{} {}", plain.len(), thin.len());
    assert!(large.iter().all(|p| (p.transform.scale - 2.0).abs() < 1e-9));
    assert!(thin.iter().all(|p| (p.transform.scale - 1.0).abs() < 1e-9));
}

#[test]
fn a_lattice_in_space_stays_a_lattice() {
    let points: Vec<_> =
        (0..216).map(|i| Vector([f64::from(i % 6), f64::from(i / 6 % 6), f64::from(i / 36)])).collect();
    let exemplar = Exemplar::from_points("lattice", &points, &[0; 216], &["a".into()]).unwrap();
    let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(9.0)));
    let outcome = Prepared::new(exemplar.clone(), &irregular(), &Budget::default())
        .unwrap()
        .run(&Request::new(domain), &mut Unobserved)
        .unwrap();
    let centres: Vec<_> =
        outcome.placements.iter().map(|p| p.transform.apply(exemplar.elements[p.source].centre)).collect();
    assert!((600..=900).contains(&centres.len()), "{}", centres.len());
    for (i, p) in centres.iter().enumerate() {
        let others = centres.iter().enumerate().filter(|(j, _)| *j != i);
        let gap = others.map(|(_, q)| (*q - *p).norm()).fold(f64::INFINITY, f64::min);
        assert!((gap - 1.0).abs() < 0.1, "{gap}");
    }
}

/// Stops at the first step after the layout.
struct Stopper {
    steps: usize,
    preview: usize,
}

impl Watch<Snapshot<2>> for Stopper {
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> Snapshot<2>) -> ControlFlow<()> {
        self.steps += 1;
        self.preview = preview().placements.len();
        assert!((0.0..=1.0).contains(&progress.fraction));
        if progress.energy.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn an_observer_sees_previews_and_may_stop() {
    let exemplar = grid(8, |_, _| 0);
    let mut observer = Stopper { steps: 0, preview: 0 };
    let prepared = Prepared::new(exemplar.clone(), &irregular(), &Budget::default()).unwrap();
    let outcome = prepared.run(&Request::new(page(15.0, 15.0)), &mut observer).unwrap();
    assert_eq!(outcome.stopped, StopReason::Stopped);
    assert!(observer.steps > 1 && observer.preview > 100);
    assert!(!outcome.placements.is_empty());
}

#[test]
fn every_preset_and_component_gives_a_result() {
    let exemplar = grid(7, |x, y| (x + y) % 2);
    let settings = [
        ("matching", "hard"),
        ("search", "patchmatch"),
        ("search", "exhaustive"),
        ("initialisation", "random-copy"),
        ("initialisation", "white-noise"),
        ("existence", "fixed"),
        ("attributes", "kept"),
        ("levels", "1"),
        ("iterations", "0"),
    ];
    let request = Request::new(page(14.0, 14.0));
    let mut all: Vec<Params> = Params::PRESETS.iter().map(|preset| Params::preset(preset.name).unwrap()).collect();
    for (name, value) in settings {
        let mut params = irregular();
        params.set(name, value).unwrap();
        all.push(params);
    }
    for params in all {
        let outcome = Prepared::new(exemplar.clone(), &params, &Budget::default())
            .unwrap()
            .run(&request, &mut Unobserved)
            .unwrap();
        assert!((100..=320).contains(&outcome.placements.len()), "{params:?}: {}", outcome.placements.len());
    }
}

#[test]
fn a_grid_grows_out_of_white_noise() {
    let exemplar = grid(8, |_, _| 0);
    let mut params = irregular();
    params.set("initialisation", "white-noise").unwrap();
    let request = Request::new(page(20.0, 20.0));
    let outcome =
        Prepared::new(exemplar.clone(), &params, &Budget::default()).unwrap().run(&request, &mut Unobserved).unwrap();
    let gaps = nearest(&centres(&exemplar, &outcome));
    let regular = gaps.iter().filter(|(_, _, d)| (d - 1.0).abs() < 0.15).count();
    assert!(regular * 100 >= gaps.len() * 80, "{regular} of {}", gaps.len());
    // The energy falls from the first search to the last.
    let (first, last) = (outcome.energy[0].energy, outcome.energy[outcome.energy.len() - 1].energy);
    assert!(last < 0.5 * first, "{first} {last}");
}

#[test]
fn what_cannot_work_is_refused() {
    let one = Exemplar::from_points("one", &[Vector::xy(1.0, 1.0)], &[0], &["a".into()]);
    assert!(one.and_then(|e| Prepared::new(e, &irregular(), &Budget::default())).is_err());
    let exemplar = grid(5, |_, _| 0);
    let wide = Params { radius: Some(50.0), ..irregular() };
    assert!(Prepared::new(exemplar.clone(), &wide, &Budget::default()).unwrap_err().to_string().contains("radius"));
    let prepared = Prepared::new(exemplar.clone(), &irregular(), &Budget::default()).unwrap();
    let error = prepared.run(&Request::new(page(1e7, 1e7)), &mut Unobserved).unwrap_err();
    assert!(error.to_string().contains("over the limit"), "{error}");
}
