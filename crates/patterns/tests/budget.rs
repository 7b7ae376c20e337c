//! Runs that are cut short: by a request to stop at any check, and by limits. What they leave is a valid outcome or a clean error, and
//! the same for any number of threads.

#![allow(clippy::unwrap_used, reason = "a test may panic, its helpers as well")]

use std::sync::Arc;

use arabesque_core::{
    Area, Border, Bounds, Budget, Class, Contents, Curve, Domain, Element, Error, Exemplar, FillRule, Limits, Outcome,
    Outline, Path, Request, Role, Shape, Similarity, Stage, StopReason, Stream, Unobserved, Vector,
};
use arabesque_patterns::{Compiled, Initialisation, Params, Prepared, Repeats, Search};

/// No more checks of one run are tried than this; of more, an even selection.
const TRIED: u64 = 40;

fn page(w: f64, h: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(w, h))
}

/// Rows of squares a little off, in two classes.
fn squares(n: usize) -> Vec<Element<2>> {
    let mut random = Stream::new(4, Stage::TEST, 0);
    (0..n * n)
        .map(|k| {
            let centre = Vector::xy((k % n) as f64 * 10.0 + 5.0, (k / n) as f64 * 10.0 + 5.0);
            let centre = centre + Vector::xy(random.range(-1.0, 1.0), random.range(-1.0, 1.0));
            let half = 2.0 + (k % 2) as f64;
            let corner = |(x, y): (f64, f64)| centre + Vector::xy(x, y) * half;
            let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec();
            Element {
                class: k % 2,
                centre,
                pose: Similarity::shift(centre),
                outline: Outline { rings: vec![ring] },
                colour: [0.0; 3],
                lean: [Vector::ZERO; 3],
                role: Role::Source,
            }
        })
        .collect()
}

fn line<const D: usize>(points: &[Vector<D>]) -> Curve<D> {
    Curve { path: Path::polyline(points), style: 0, width: 0.5, colour: [0.0; 3] }
}

/// Lines across and down, with a bend each.
fn lines(n: usize) -> Vec<Curve<2>> {
    let side = 10.0 * n as f64;
    let across = (0..n).map(|k| 10.0 * k as f64 + 5.0);
    let pair = |at: f64| {
        let bend = [(0.0, at), (0.4 * side, at + 1.0), (side, at)];
        [line(&bend.map(|(x, y)| Vector::xy(x, y))), line(&bend.map(|(x, y)| Vector::xy(y, x)))]
    };
    across.flat_map(pair).collect()
}

fn exemplar(elements: Vec<Element<2>>, curves: Vec<Curve<2>>, side: f64) -> Arc<Exemplar<2>> {
    let class = |name: &str| Class { name: name.into() };
    let contents = Contents {
        elements,
        classes: vec![class("a"), class("b")],
        curves,
        styles: vec![class("line")],
        areas: Vec::new(),
    };
    Arc::new(Exemplar::with_curves("t", contents, page(side, side)).unwrap())
}

fn small() -> Params {
    Params { repeat: Repeats::Off, levels: 2, iterations: 2, ..Params::default() }
}

fn elements() -> (Prepared<2>, Request<2>) {
    let prepared = Prepared::new(exemplar(squares(5), Vec::new(), 50.0), &small(), &Budget::default()).unwrap();
    (prepared, Request { border: Border::Inside, ..Request::new(Domain::Box(page(70.0, 60.0))) })
}

fn curves() -> (Prepared<2>, Request<2>) {
    let params = Params { coarsening: 1.3, ..small() };
    let prepared = Prepared::new(exemplar(Vec::new(), lines(4), 40.0), &params, &Budget::default()).unwrap();
    (prepared, Request::new(Domain::Box(page(60.0, 50.0))))
}

fn mixture() -> (Prepared<2>, Request<2>) {
    let elements: Vec<_> = squares(4).into_iter().step_by(3).collect();
    let prepared = Prepared::new(exemplar(elements, lines(4), 40.0), &small(), &Budget::default()).unwrap();
    let round: Vec<_> = (0..40).map(|k| f64::from(k) / 40.0 * std::f64::consts::TAU).collect();
    let ring: Vec<_> = round.iter().map(|a| Vector::xy(30.0 + 28.0 * a.cos(), 30.0 + 28.0 * a.sin())).collect();
    let disc = Domain::Region(Arc::new(Shape::new(&[ring], FillRule::NonZero).unwrap()));
    (prepared, Request { border: Border::Turn, ..Request::new(disc) })
}

fn space() -> (Prepared<3>, Request<3>) {
    let places = (0..64).map(|k| Vector([k % 4, k / 4 % 4, k / 16].map(f64::from))).collect::<Vec<_>>();
    let class_of: Vec<_> = (0..64).map(|k| k % 2).collect();
    let salt = Exemplar::from_points("t", &places, &class_of, &["a".into(), "b".into()]).unwrap();
    let prepared = Prepared::new(salt, &small(), &Budget::default()).unwrap();
    (prepared, Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(4.0)))))
}

fn from_noise() -> (Prepared<2>, Request<2>) {
    let params = Params { initialisation: Initialisation::WhiteNoise, search: Search::PatchMatch, ..small() };
    let prepared = Prepared::new(exemplar(squares(6), Vec::new(), 60.0), &params, &Budget::default()).unwrap();
    (prepared, Request::new(Domain::Torus(page(60.0, 60.0))))
}

/// Stripes of a filled area from side to side, one below every row of squares.
fn stripes(n: usize) -> Vec<Area<2>> {
    let side = 10.0 * n as f64;
    let stripe = |k: usize| {
        let (low, high) = (10.0 * k as f64, 10.0 * k as f64 + 1.5);
        let ring = [(0.0, low), (side, low), (side, high), (0.0, high)].map(|(x, y)| Vector::xy(x, y)).to_vec();
        Area { outline: Outline { rings: vec![ring] }, style: 0, colour: [0.0; 3] }
    };
    (0..n).map(stripe).collect()
}

/// An exemplar of 50 by 50 that repeats exactly, with what is asked for: rows of squares, a net, stripes.
fn repeating(has_squares: bool, has_lines: bool, has_stripes: bool) -> Prepared<2> {
    let mut squares = if has_squares { squares(5) } else { Vec::new() };
    for (k, square) in squares.iter_mut().enumerate() {
        let place = Vector::xy((k % 5) as f64 * 10.0 + 5.0, (k / 5) as f64 * 10.0 + 5.0);
        (square.centre, square.pose, square.class) = (place, Similarity::shift(place), 0);
        let corner = |(x, y): (f64, f64)| place + Vector::xy(x, y) * 2.5;
        square.outline.rings = vec![[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec()];
    }
    let straight = |at: f64| {
        let ends = [(0.0, at), (50.0, at)];
        [line(&ends.map(|(x, y)| Vector::xy(x, y))), line(&ends.map(|(x, y)| Vector::xy(y, x)))]
    };
    let lines = if has_lines { (0..5).flat_map(|k| straight(10.0 * f64::from(k) + 9.0)).collect() } else { Vec::new() };
    let class = |name: &str| Class { name: name.into() };
    let contents = Contents {
        elements: squares,
        classes: vec![class("a")],
        curves: lines,
        styles: vec![class("line")],
        areas: if has_stripes { stripes(5) } else { Vec::new() },
    };
    let exemplar = Exemplar::with_curves("t", contents, page(50.0, 50.0)).unwrap();
    // What does not repeat would be refused.
    let params = Params { repeat: Repeats::Exact, ..Params::default() };
    Prepared::new(Arc::new(exemplar), &params, &Budget::default()).unwrap()
}

/// A square with a square hole.
fn frame() -> Domain<2> {
    let square = |low: f64, high: f64| {
        [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Vector::xy(x, y)).to_vec()
    };
    Domain::Region(Arc::new(Shape::new(&[square(0.0, 93.0), square(31.0, 57.0)], FillRule::EvenOdd).unwrap()))
}

/// A run on so many threads. The exemplar is as nobody used it before: what a run finds out about it is kept.
fn run<const D: usize>(
    (prepared, request): &(Prepared<D>, Request<D>),
    budget: &Budget,
    threads: usize,
) -> Result<Outcome<D>, Error>
where
    Vector<D>: Compiled<D>,
{
    let (prepared, request) = (prepared.clone(), Request { budget: budget.clone(), ..request.clone() });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| prepared.run(&request, &mut Unobserved))
}

/// What there is to say about an outcome, in words that are the same when it is the same.
fn told<const D: usize>(made: &Result<Outcome<D>, Error>) -> String {
    match made {
        Ok(o) => {
            format!("{:?} {:?} {:?} {:?} {:?} {:?}", o.stopped, o.placements, o.curves, o.areas, o.energy, o.warnings)
        }
        Err(error) => error.to_string(),
    }
}

/// Whether everything in an outcome is finite, known, and in the domain as far as the rule of the border asks for it.
fn check_valid<const D: usize>(outcome: &Outcome<D>, request: &Request<D>) {
    for placement in &outcome.placements {
        let transform = &placement.transform;
        assert!(transform.translation.is_finite() && transform.scale > 0.0, "{placement:?}");
    }
    for drawn in &outcome.curves {
        assert!(!drawn.path.is_empty() && drawn.path.cubics.iter().flatten().all(|p| p.is_finite()));
        let ends = drawn.path.cubics.iter().flat_map(|c| [c[0], c[3]]);
        assert!(
            request.domain.period().is_some() || ends.into_iter().all(|p| request.domain.signed_distance(p) > -1e-6)
        );
    }
}

/// Stops a run at an even selection of its checks, and holds what comes out against the rules, and against the same with more threads.
fn check_stops<const D: usize>(case: &(Prepared<D>, Request<D>), check: impl Fn(&Outcome<D>))
where
    Vector<D>: Compiled<D>,
{
    let (early, late) = stops(case, check);
    assert!(3 * late > early, "{early} {late}");
}

/// The same, with how many runs left nothing and how many something; both do.
fn stops<const D: usize>(case: &(Prepared<D>, Request<D>), check: impl Fn(&Outcome<D>)) -> (u32, u32)
where
    Vector<D>: Compiled<D>,
{
    let endless = Budget::stopping_at(Limits::default(), u64::MAX);
    let whole = run(case, &endless, 1).unwrap();
    assert_eq!(whole.stopped, StopReason::Finished);
    check(&whole);
    let total = endless.checks();
    let more = Budget::stopping_at(Limits::default(), u64::MAX);
    assert_eq!(told(&run(case, &more, 3)), told(&Ok(whole)));
    assert_eq!(more.checks(), total, "the number of checks depends on the threads");
    let (mut early, mut late) = (0, 0);
    for n in (1..=total).step_by((total.div_ceil(TRIED)) as usize) {
        let one = run(case, &Budget::stopping_at(Limits::default(), n), 1);
        let three = run(case, &Budget::stopping_at(Limits::default(), n), 3);
        assert_eq!(told(&one), told(&three), "stopped at check {n} of {total}");
        match one {
            Ok(outcome) => {
                late += 1;
                assert_eq!(outcome.stopped, StopReason::Stopped, "{n}");
                assert!(!(outcome.placements.is_empty() && outcome.curves.is_empty() && outcome.areas.is_empty()));
                check_valid(&outcome, &case.1);
                check(&outcome);
            }
            Err(Error::Stopped { .. }) => early += 1,
            Err(other) => panic!("check {n} of {total}: {other}"),
        }
    }
    assert!(early > 0 && late > 0, "{early} {late}");
    (early, late)
}

#[test]
fn elements_that_are_stopped_lie_inside() {
    let case = elements();
    let exemplar = exemplar(squares(5), Vec::new(), 50.0);
    check_stops(&case, |outcome| {
        for p in &outcome.placements {
            let ink = exemplar.elements[p.source].outline.transformed(&p.transform);
            assert!(ink.points().all(|q| case.1.domain.signed_distance(q) >= -1e-6), "{p:?}");
        }
    });
}

#[test]
fn curves_that_are_stopped_are_whole() {
    check_stops(&curves(), |outcome| assert!(outcome.placements.is_empty()));
}

#[test]
fn mixtures_that_are_stopped_are_whole() {
    check_stops(&mixture(), |_| {});
}

#[test]
fn repeats_that_are_stopped_are_whole() {
    for (squares, lines, stripes) in
        [(true, false, false), (false, true, false), (false, true, true), (true, true, false), (true, true, true)]
    {
        let prepared = repeating(squares, lines, stripes);
        for domain in [Domain::Box(page(93.0, 81.0)), Domain::Torus(page(80.0, 70.0)), frame()] {
            let case = (prepared.clone(), Request::new(domain));
            // Half of the checks of so short a run come before there is anything.
            stops(&case, |outcome| {
                let is_whole = outcome.stopped == StopReason::Finished;
                assert!(!is_whole || outcome.placements.is_empty() != squares);
                assert!(!is_whole || outcome.curves.is_empty() != lines);
                assert!(!is_whole || outcome.areas.is_empty() != stripes);
            });
        }
    }
}

#[test]
fn points_in_space_that_are_stopped_lie_in_the_box() {
    let case = space();
    check_stops(&case, |outcome| {
        assert!(outcome.placements.iter().all(|p| p.source < 64));
    });
}

#[test]
fn a_start_from_noise_can_be_stopped() {
    check_stops(&from_noise(), |_| {});
}

#[test]
fn a_larger_page_can_be_stopped_anywhere() {
    let case = (curves().0, Request::new(Domain::Box(page(150.0, 90.0))));
    let endless = Budget::stopping_at(Limits::default(), u64::MAX);
    run(&case, &endless, 3).unwrap();
    let mut random = Stream::new(11, Stage::TEST, 0);
    for _ in 0..6 {
        let n = 1 + random.below(endless.checks() as usize) as u64;
        let [one, three] = [1, 3].map(|threads| run(&case, &Budget::stopping_at(Limits::default(), n), threads));
        assert_eq!(told(&one), told(&three), "{n}");
        one.iter().for_each(|outcome| check_valid(outcome, &case.1));
    }
}

#[test]
fn limits_of_work_give_the_best_so_far_with_a_warning() {
    let case = elements();
    let mut reasons = Vec::new();
    for work in [1, 2, 4, 8, 16, 32, 64, 10_000] {
        let limits = Limits { work, work_per_element: 0, ..Limits::default() };
        let [one, three] = [1, 3].map(|threads| run(&case, &Budget::new(limits), threads));
        assert_eq!(told(&one), told(&three), "{work}");
        match one {
            Ok(outcome) => {
                check_valid(&outcome, &case.1);
                let told = outcome.warnings.iter().any(|w| w.advice.contains("--limit work="));
                assert_eq!(told, outcome.stopped == StopReason::Limit, "{work}");
                reasons.push(outcome.stopped);
            }
            Err(Error::Limit { advice, .. }) => assert!(advice.contains("--limit work=")),
            Err(other) => panic!("{other}"),
        }
    }
    assert_eq!(reasons.first(), Some(&StopReason::Limit));
    assert_eq!(reasons.last(), Some(&StopReason::Finished));
}

#[test]
fn a_watch_that_breaks_before_anything_lies_there_is_told_that_it_stopped() {
    let (prepared, mut request) = elements();
    request.budget = Budget::default();
    request.budget.stopper().stop(arabesque_core::Cause::Time);
    let error = prepared.run(&request, &mut Unobserved).unwrap_err();
    assert!(matches!(error, Error::Stopped { cause: arabesque_core::Cause::Time, .. }), "{error}");
}

#[test]
fn what_is_found_out_about_an_exemplar_does_not_change_what_is_made() {
    let (prepared, request) = curves();
    let first = prepared.run(&request, &mut Unobserved);
    assert_eq!(told(&prepared.run(&request, &mut Unobserved)), told(&first));
}
