//! Exemplars that no honest drawing is like: handled, or refused with a word that says what is there. What bounds them is counted, not
//! timed.

#![allow(clippy::unwrap_used, reason = "a test may panic, its helpers as well")]

use arabesque_core::{
    Bounds, Budget, Class, Contents, Curve, Domain, Element, Error, Exemplar, Limits, Outcome, Outline, Path, Request,
    Role, Similarity, StopReason, Unobserved, Vector,
};
use arabesque_patterns::{Params, Prepared, Repeats};

fn page(side: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::splat(side))
}

fn square(class: usize, centre: Vector<2>, half: f64) -> Element<2> {
    let corner = |(x, y): (f64, f64)| centre + Vector::xy(x, y) * half;
    let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec();
    Element {
        class,
        centre,
        pose: Similarity::shift(centre),
        outline: Outline { rings: vec![ring] },
        colour: [0.0; 3],
        lean: [Vector::ZERO; 3],
        role: Role::Source,
    }
}

fn drawing(elements: Vec<Element<2>>, curves: Vec<Curve<2>>, side: f64) -> Exemplar<2> {
    let most = elements.iter().map(|e| e.class).max().unwrap_or(0);
    let classes = (0..=most).map(|c| Class { name: c.to_string() }).collect();
    let styles = vec![Class { name: "line".into() }];
    Exemplar::with_curves("t", Contents { elements, classes, curves, styles, ..Contents::default() }, page(side))
        .unwrap()
}

fn line(points: &[(f64, f64)]) -> Curve<2> {
    let points: Vec<_> = points.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
    Curve { path: Path::polyline(&points), style: 0, width: 0.5, colour: [0.0; 3] }
}

/// The engine alone: these patterns repeat, and would be continued by their repeat.
fn irregular() -> Params {
    Params { repeat: Repeats::Off, ..Params::default() }
}

fn analysed(exemplar: Exemplar<2>) -> Result<Prepared<2>, Error> {
    Prepared::new(exemplar, &Params::default(), &Budget::default())
}

fn filled(prepared: &Prepared<2>, limits: Limits) -> Result<Outcome<2>, Error> {
    prepared.run(&Request { budget: Budget::new(limits), ..Request::new(Domain::Box(page(100.0))) }, &mut Unobserved)
}

fn dots() -> Vec<Element<2>> {
    (0..36)
        .map(|k| square(0, Vector::xy(f64::from(k % 6), f64::from(k / 6)) * 20.0 + Vector::splat(10.0), 3.0))
        .collect()
}

fn refused(made: Result<Prepared<2>, Error>) -> String {
    made.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn elements_at_one_place_are_refused() {
    for count in [2, 500, 20_000] {
        let exemplar = drawing(vec![square(0, Vector::xy(60.0, 60.0), 5.0); count], Vec::new(), 120.0);
        let told = refused(analysed(exemplar));
        assert!(told.contains(&format!("all {count} elements lie at one place")), "{told}");
    }
}

#[test]
fn heaps_are_refused() {
    let at = |k: usize| if k.is_multiple_of(2) { Vector::xy(20.0, 20.0) } else { Vector::xy(90.0, 70.0) };
    let told = refused(analysed(drawing((0..20_000).map(|k| square(0, at(k), 1.0)).collect(), Vec::new(), 120.0)));
    assert!(told.contains("10000 elements lie in one heap, around ["), "{told}");
}

#[test]
fn elements_on_a_line_are_an_exemplar() {
    let elements = (0..300).map(|k| square(0, Vector::xy(0.4 * f64::from(k), 60.0), 0.1)).collect();
    let prepared = analysed(drawing(elements, Vec::new(), 120.0)).unwrap();
    let limits = Limits { work: 200, work_per_element: 0, ..Limits::default() };
    assert!(!filled(&prepared, limits).unwrap().placements.is_empty());
}

#[test]
fn an_element_far_larger_than_the_frame_is_not_copied() {
    for half in [1e4, 1e6, 1e9] {
        let elements = dots().into_iter().chain([square(1, Vector::xy(60.0, 60.0), half)]).collect();
        let prepared = analysed(drawing(elements, Vec::new(), 120.0)).unwrap();
        let outcome = filled(&prepared, Limits { work: 2000, ..Limits::default() }).unwrap();
        assert_eq!(outcome.stopped, StopReason::Finished);
        assert!((15..40).contains(&outcome.placements.len()), "{}", outcome.placements.len());
        assert!(outcome.placements.iter().all(|p| p.source < 36));
        assert!(outcome.warnings.iter().any(|w| w.message.contains("far larger than the frame")));
    }
    let elements = (0..4).map(|k| square(0, Vector::xy(30.0 * f64::from(k), 60.0), 1e6)).collect();
    assert!(refused(analysed(drawing(elements, Vec::new(), 120.0))).contains("every element is far larger"));
}

#[test]
fn elements_of_no_size_are_points() {
    let elements = dots().into_iter().map(|e| square(0, e.centre, 0.0)).collect();
    let outcome = filled(&analysed(drawing(elements, Vec::new(), 120.0)).unwrap(), Limits::default()).unwrap();
    assert!((15..40).contains(&outcome.placements.len()));
}

#[test]
fn every_element_may_be_a_class_of_its_own() {
    let elements = (0..3000).map(|k| square(k, Vector::xy((k % 60) as f64, (k / 60) as f64) * 2.0, 0.5)).collect();
    let budget = Budget::default();
    let prepared = Prepared::new(drawing(elements, Vec::new(), 120.0), &irregular(), &budget).unwrap();
    assert_eq!(prepared.samples_per_element().len(), 3000);
    assert!(budget.work() < 5_000_000_000, "{}", budget.work());
}

#[test]
fn curves_on_top_of_one_another_are_refused() {
    let told = refused(analysed(drawing(Vec::new(), vec![line(&[(5.0, 50.0), (95.0, 55.0)]); 3000], 100.0)));
    assert!(told.contains("curves on top of one another") && told.contains("draw each of them once"), "{told}");
}

#[test]
fn curves_that_all_meet_in_one_place_are_refused() {
    let spoke = |k: usize| {
        let (s, c) = (k as f64 / 2000.0 * std::f64::consts::PI).sin_cos();
        line(&[(50.0 - 45.0 * c, 50.0 - 45.0 * s), (50.0 + 45.0 * c, 50.0 + 45.0 * s)])
    };
    assert!(matches!(analysed(drawing(Vec::new(), (0..2000).map(spoke).collect(), 100.0)), Err(Error::Limit { .. })));
}

#[test]
fn a_curve_that_crosses_itself_all_over_is_refused() {
    let zigzag: Vec<_> = (0..1200)
        .map(|k| {
            let at = 5.0 + 90.0 * f64::from(k) / 1200.0;
            if k < 600 {
                (2.0 * at - 5.0, if k % 2 == 0 { 5.0 } else { 95.0 })
            } else {
                (if k % 2 == 0 { 5.0 } else { 95.0 }, 2.0 * at - 95.0)
            }
        })
        .collect();
    assert!(matches!(analysed(drawing(Vec::new(), vec![line(&zigzag)], 100.0)), Err(Error::Limit { .. })));
}

#[test]
fn knobs_at_their_largest_end_with_a_warning() {
    let params =
        Params { samples: Some(64), coarse_neighbours: 200.0, fine_neighbours: 200.0, iterations: 1000, ..irregular() };
    let prepared = Prepared::new(drawing(dots(), Vec::new(), 120.0), &params, &Budget::default()).unwrap();
    let limits = Limits { work: 300, work_per_element: 0, ..Limits::default() };
    let outcome = filled(&prepared, limits).unwrap();
    assert_eq!(outcome.stopped, StopReason::Limit);
    assert!(
        outcome.warnings.iter().any(|w| w.advice.contains("raise the limit with --limit work=")),
        "{:?}",
        outcome.warnings
    );
    assert!((15..40).contains(&outcome.placements.len()));
}

#[test]
fn a_frame_far_larger_than_its_elements_is_handled() {
    let elements = (0..9).map(|k| square(0, Vector::splat(5e5) + Vector::xy(f64::from(k % 3), f64::from(k / 3)), 0.2));
    let prepared = analysed(drawing(elements.collect(), Vec::new(), 1e6)).unwrap();
    let request = Request::new(Domain::Box(page(2e6)));
    let outcome = prepared.run(&request, &mut Unobserved).unwrap();
    assert!(!outcome.placements.is_empty());
}

#[test]
fn too_many_neighbours_are_refused_before_the_memory_is_gone() {
    let limits = Limits { memory: 64 << 20, ..Limits::default() };
    let params = Params { samples: Some(64), coarse_neighbours: 200.0, fine_neighbours: 200.0, ..irregular() };
    let made = Prepared::new(drawing(dots(), Vec::new(), 120.0), &params, &Budget::new(limits));
    let told = refused(made);
    assert!(told.contains("neighbourhoods of the exemplar") && told.contains("--limit memory="), "{told}");
}
