//! Runs that are stopped at any check, and runs with too little work or memory: valid pieces or a clean error, the same for any number
//! of threads.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use arabesque_core::{Bounds, Budget, Error, Image, Limits, Path, Result, StopReason, Unobserved, Vector, straight};
use arabesque_ribbons::{
    Canvas, Closing, Mask, Prepared, Ribbon, RibbonOutcome, RibbonParams, RibbonRequest, StripExemplar, render_rows,
};

/// Beads on a thread, 40 x 18 pixels.
fn exemplar() -> StripExemplar {
    let mut image = Image::transparent(40, 18);
    for (k, pixel) in image.pixels.iter_mut().enumerate() {
        let (x, y) = ((k % 40) as f64, (k / 40) as f64 - 8.5);
        let bead = 5.0 - ((x - 5.0).rem_euclid(10.0) - 5.0).hypot(y);
        if bead > 0.0 || y.abs() < 2.0 {
            *pixel = [(x * 6.0) as u8, 120, 40, 255];
        }
    }
    StripExemplar::new(image)
}

fn prepared(closing: Closing) -> Prepared {
    let params = RibbonParams { step: Some(6.0), relax: true, closing, ..RibbonParams::default() };
    Prepared::new(vec![exemplar()], params, &Budget::default()).unwrap()
}

fn wave() -> Path<2> {
    Path::polyline(&[(10.0, 30.0), (60.0, 40.0), (90.0, 24.0)].map(|(x, y)| Vector::xy(x, y)))
}

fn square() -> Path<2> {
    let c = [(30.0, 20.0), (70.0, 20.0), (70.0, 60.0), (30.0, 60.0), (30.0, 20.0)].map(|(x, y)| Vector::xy(x, y));
    Path { cubics: c.windows(2).map(|w| straight(w[0], w[1])).collect(), closed: true }
}

/// A spot beside the way.
fn spot() -> Mask {
    let blocked = (0..100 * 80).map(|k| (k % 100_usize).abs_diff(48) < 3 && (k / 100_usize).abs_diff(31) < 3).collect();
    Mask { bounds: Bounds::new(Vector::ZERO, Vector::xy(100.0, 80.0)), width: 100, height: 80, blocked }
}

fn plane(path: Path<2>, budget: Budget) -> RibbonRequest<2> {
    let curves = vec![("first".into(), path.clone()), ("second".into(), path.map(|p| p + Vector::xy(200.0, 0.0)))];
    RibbonRequest { avoid: Some(spot()), budget, ..RibbonRequest::new(curves) }
}

fn on<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// Pieces that meet, lie in the exemplar, and are no more than there should be; an end that is told, or nothing and the reason.
fn check<const D: usize>(outcome: &Result<RibbonOutcome<D>>, whole: &[Ribbon<D>]) {
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(error) => {
            assert!(matches!(error, Error::Stopped { .. } | Error::Limit { .. }), "{error}");
            return;
        }
    };
    assert!(!outcome.ribbons.is_empty() && outcome.ribbons.len() <= whole.len());
    for (ribbon, full) in outcome.ribbons.iter().zip(whole) {
        assert!(!ribbon.pieces.is_empty() && ribbon.pieces.len() <= full.pieces.len());
        for (piece, there) in ribbon.pieces.iter().zip(&full.pieces) {
            assert_eq!(piece.patch.corners, there.patch.corners);
            assert!(piece.patch.texture.iter().all(|p| (0.0..=40.0).contains(&p[0])));
        }
    }
    let cut = outcome.ribbons.len() < whole.len()
        || outcome.ribbons.iter().zip(whole).any(|(a, b)| a.pieces.len() < b.pieces.len());
    assert!(!cut || matches!(outcome.stopped, StopReason::Stopped | StopReason::Limit));
}

fn same<const D: usize>(a: &Result<RibbonOutcome<D>>, b: &Result<RibbonOutcome<D>>) {
    match (a, b) {
        (Ok(a), Ok(b)) => {
            assert_eq!(a.ribbons, b.ribbons);
            assert_eq!((a.stopped, &a.warnings), (b.stopped, &b.warnings));
        }
        (Err(a), Err(b)) => assert_eq!(a.to_string(), b.to_string()),
        (a, b) => panic!("{:?} beside {:?}", a.as_ref().err(), b.as_ref().err()),
    }
}

/// Some numbers up to `last`, the first ones all.
fn numbers(last: u64) -> impl Iterator<Item = u64> {
    (1..=last).filter(move |n| *n < 12 || n % (last / 14).max(1) == 0)
}

fn stop_everywhere<const D: usize>(run: impl Fn(Budget) -> Result<RibbonOutcome<D>> + Sync) {
    let counting = Budget::stopping_at(Limits::default(), u64::MAX);
    let whole = run(counting.clone()).unwrap();
    assert_eq!(whole.stopped, StopReason::Finished);
    let (mut some, mut none) = (0, 0);
    for n in numbers(counting.checks()) {
        let [one, three] = [1, 3].map(|threads| on(threads, || run(Budget::stopping_at(Limits::default(), n))));
        check(&one, &whole.ribbons);
        same(&one, &three);
        match one {
            Ok(outcome) if outcome.stopped == StopReason::Stopped => some += 1,
            Ok(_) => {}
            Err(_) => none += 1,
        }
    }
    assert!(some > 2 && none > 0, "{some} with pieces, {none} without");
}

#[test]
fn runs_along_open_curves_stop_at_any_check() {
    let prepared = prepared(Closing::Quick);
    stop_everywhere(|budget| prepared.run(&plane(wave(), budget), &mut Unobserved));
}

#[test]
fn runs_along_closed_curves_stop_at_any_check() {
    let prepared = prepared(Closing::Exact);
    stop_everywhere(|budget| prepared.run(&plane(square(), budget), &mut Unobserved));
}

#[test]
fn runs_in_space_stop_at_any_check() {
    let prepared = prepared(Closing::Quick);
    let points: Vec<Vector<3>> =
        (0..30).map(|k| f64::from(k) * 0.3).map(|t| Vector([20.0 * t.cos(), 20.0 * t.sin(), 4.0 * t])).collect();
    let request = RibbonRequest::new(vec![("helix".into(), Path::polyline(&points))]);
    stop_everywhere(|budget| prepared.run_in_space(&RibbonRequest { budget, ..request.clone() }, &mut Unobserved));
}

#[test]
fn work_that_is_used_up_leaves_the_pieces_so_far_and_a_warning() {
    let prepared = prepared(Closing::Quick);
    let limited = |work| Budget::new(Limits { work, work_per_element: 0, ..Limits::default() });
    let whole = prepared.run(&plane(wave(), Budget::default()), &mut Unobserved).unwrap();
    let mut warned = 0;
    for work in (1..12).chain((12..60).step_by(8)) {
        let [one, three] =
            [1, 3].map(|threads| on(threads, || prepared.run(&plane(wave(), limited(work)), &mut Unobserved)));
        check(&one, &whole.ribbons);
        same(&one, &three);
        if let Ok(outcome) = one
            && outcome.stopped == StopReason::Limit
        {
            assert!(outcome.warnings.iter().any(|w| w.advice.contains("--limit work=")), "{:?}", outcome.warnings);
            warned += 1;
        }
    }
    assert!(warned > 0);
}

#[test]
fn memory_is_held_while_pieces_are_laid_and_given_back() {
    let budget = Budget::new(Limits { memory: 1 << 20, ..Limits::default() });
    let outcome = prepared(Closing::Quick).run(&plane(wave(), budget.clone()), &mut Unobserved);
    let whole = prepared(Closing::Quick).run(&plane(wave(), Budget::default()), &mut Unobserved).unwrap();
    check(&outcome, &whole.ribbons);
    drop(outcome);
    assert!(budget.hold("all of it", 1 << 20).is_ok());
}

#[test]
fn pictures_stop_between_rows_and_count_their_work() {
    let ribbons = prepared(Closing::Quick).run(&plane(wave(), Budget::default()), &mut Unobserved).unwrap().ribbons;
    let canvas = Canvas { origin: Vector::ZERO, width: 300, height: 240, pixels_per_unit: 3.0 };
    let draw = |budget: &Budget| {
        let mut rows = Vec::new();
        let drawn = render_rows((&ribbons, &[exemplar()]), None, &canvas, budget, &mut |row| {
            rows.push(row.to_vec());
            Ok(())
        });
        drawn.map(|()| rows)
    };
    let whole = draw(&Budget::default()).unwrap();
    assert_eq!((whole.len(), whole[0].len()), (240, 300));
    assert!(whole.iter().flatten().any(|p| p[3] > 0));
    let counting = Budget::stopping_at(Limits::default(), u64::MAX);
    assert_eq!(on(3, || draw(&counting)).unwrap(), whole);
    let mut stopped = 0;
    for n in numbers(counting.checks()) {
        match draw(&Budget::stopping_at(Limits::default(), n)) {
            Err(error) => {
                assert!(matches!(error, Error::Stopped { .. }), "{error}");
                stopped += 1;
            }
            // Too late for anything to be left.
            Ok(rows) => assert_eq!(rows, whole),
        }
    }
    assert!(stopped > 20);
    let little = Budget::new(Limits { work: 1, ..Limits::default() });
    assert!(matches!(draw(&little), Err(Error::Limit { .. })));
}
