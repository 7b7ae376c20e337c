//! Whole runs on small exemplars: optimality, closing, avoidance, resuming, ends, transitions.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::ops::ControlFlow;

use arabesque_core::{
    Bounds, Budget, Error, Image, Path, Progress, Snapshot, Stage, StopReason, Stream, Unobserved, Vector, Watch,
    straight,
};
use arabesque_ribbons::{
    Canvas, Closing, Mask, Prepared, RibbonOutcome, RibbonParams, RibbonRequest, Search, StripExemplar, Width, render,
};
use proptest::prelude::*;

/// A wavy band with dots on it, different for every seed, on `width` x `height` transparent pixels.
fn strip(width: usize, height: usize, seed: u64) -> StripExemplar {
    let mut draw = Stream::new(seed, Stage::TEST, 0);
    let (phase, thick) = (draw.unit() * 6.0, 0.12 + 0.08 * draw.unit());
    let dots: Vec<(f64, u8)> =
        (0..width / 6).map(|_| (draw.unit() * width as f64, (draw.unit() * 255.0) as u8)).collect();
    let mut image = Image::transparent(width, height);
    for y in 0..height {
        for x in 0..width {
            let (px, py) = (x as f64, y as f64 / height as f64);
            let centre = 0.5 + 0.06 * (px * 0.25 + phase).sin();
            let dot = dots.iter().find(|d| (d.0 - px).abs() < 2.0);
            let half = thick + if dot.is_some() { 0.06 } else { 0.0 };
            let alpha = ((half - (py - centre).abs()) * height as f64 + 0.5).clamp(0.0, 1.0);
            let green = dot.map_or(90, |d| d.1);
            image.pixels[y * width + x] = [190, green, 40, (255.0 * alpha) as u8];
        }
    }
    StripExemplar::new(image)
}

fn line(points: &[(f64, f64)]) -> Path<2> {
    Path::polyline(&points.iter().map(|&(x, y)| Vector::xy(x, y)).collect::<Vec<_>>())
}

/// A closed curve of four cubics around (x, y).
fn ring(x: f64, y: f64, radius: f64) -> Path<2> {
    let (k, r) = (0.552_284_75 * radius, radius);
    let p = |dx: f64, dy: f64| Vector::xy(x + dx, y + dy);
    let cubics = vec![
        [p(r, 0.0), p(r, k), p(k, r), p(0.0, r)],
        [p(0.0, r), p(-k, r), p(-r, k), p(-r, 0.0)],
        [p(-r, 0.0), p(-r, -k), p(-k, -r), p(0.0, -r)],
        [p(0.0, -r), p(k, -r), p(r, -k), p(r, 0.0)],
    ];
    Path { cubics, closed: true }
}

fn request(path: Path<2>) -> RibbonRequest<2> {
    RibbonRequest::new(vec![("curve".into(), path)])
}

fn run(exemplar: &StripExemplar, params: &RibbonParams, request: &RibbonRequest<2>) -> RibbonOutcome<2> {
    Prepared::new(vec![exemplar.clone()], params.clone(), &Budget::default())
        .unwrap()
        .run(request, &mut Unobserved)
        .unwrap()
}

fn plain() -> RibbonParams {
    RibbonParams {
        step: Some(6.0),
        repetition: 0.0,
        variety: 0.0,
        centring: 0.0,
        wander: Some(1.0),
        ..RibbonParams::default()
    }
}

#[test]
fn a_straight_ribbon_shows_the_exemplar_as_it_is() {
    let exemplar = strip(60, 24, 3);
    let outcome = run(&exemplar, &plain(), &request(line(&[(0.0, 12.0), (48.0, 12.0)])));
    assert!(outcome.ribbons[0].cost < 1e-6, "{}", outcome.ribbons[0].cost);
    let columns: Vec<f64> = outcome.ribbons[0].pieces.iter().map(|p| p.patch.texture[0][0]).collect();
    assert!(columns.windows(2).all(|w| (w[1] - w[0] - 6.0).abs() < 1e-9), "{columns:?}");
}

#[test]
fn a_closed_ribbon_ends_as_it_begins() {
    let exemplar = strip(60, 24, 5);
    for closing in [Closing::Quick, Closing::Exact] {
        let params = RibbonParams { closing, wander: Some(0.1), ..plain() };
        let outcome = run(&exemplar, &params, &request(ring(60.0, 60.0, 25.0)));
        let ribbon = &outcome.ribbons[0];
        assert!(ribbon.closed);
        let (first, last) = (&ribbon.pieces[0].patch, &ribbon.pieces[ribbon.pieces.len() - 1].patch);
        assert!(
            (last.corners[1] - first.corners[0]).norm() < 1e-9 && (last.corners[2] - first.corners[3]).norm() < 1e-9
        );
    }
}

#[test]
fn the_exact_cycle_is_no_worse_than_the_quick_one_and_as_good_as_the_best_of_all() {
    let exemplar = strip(26, 16, 8);
    let wanted = request(ring(40.0, 40.0, 14.0));
    let cost = |closing, search| {
        let params = RibbonParams { closing, search, wander: Some(0.12), ..plain() };
        run(&exemplar, &params, &wanted).ribbons[0].cost
    };
    let (quick, exact) = (cost(Closing::Quick, Search::Bounded), cost(Closing::Exact, Search::Bounded));
    assert!(exact <= quick);
    assert_eq!(exact, cost(Closing::Exact, Search::Exhaustive));
    assert_eq!(exact, best_cycle(&exemplar, &wanted));
}

/// The cheapest cycle by fixing the first piece to every position in turn and closing exactly.
fn best_cycle(exemplar: &StripExemplar, wanted: &RibbonRequest<2>) -> f64 {
    let params = RibbonParams { closing: Closing::Exact, search: Search::Exhaustive, ..plain() };
    let prepared = Prepared::new(vec![exemplar.clone()], params, &Budget::default()).unwrap();
    let (width, height) = (exemplar.image.width, exemplar.image.height as i64);
    let starts = (0..width).flat_map(|x| (-2..=height / 4).map(move |y| (x, y)));
    let costs = starts.filter_map(|first| {
        let fixed = RibbonRequest { first: Some(first), ..wanted.clone() };
        prepared.run(&fixed, &mut Unobserved).ok().map(|o| o.ribbons[0].cost)
    });
    costs.fold(f64::INFINITY, f64::min)
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let exemplar = strip(60, 24, 7);
    let wanted = request(line(&[(10.0, 30.0), (60.0, 20.0), (90.0, 60.0)]));
    let params = RibbonParams { step: Some(5.0), ..RibbonParams::default() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&exemplar, &params, &wanted)).ribbons
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(8));
}

#[test]
fn a_run_that_goes_on_from_another_equals_a_full_one() {
    let exemplar = strip(60, 24, 9);
    let prepared =
        Prepared::new(vec![exemplar], RibbonParams { step: Some(6.0), ..RibbonParams::default() }, &Budget::default())
            .unwrap();
    let before = request(line(&[(10.0, 40.0), (120.0, 40.0), (170.0, 80.0)]));
    let after = request(line(&[(10.0, 40.0), (120.0, 40.0), (170.0, 20.0)]));
    let first = prepared.run(&before, &mut Unobserved).unwrap();
    let resumed = prepared.resume(&after, &first.memory, &mut Unobserved).unwrap();
    let full = prepared.run(&after, &mut Unobserved).unwrap();
    assert!(resumed.memory.resumed >= 10, "{}", resumed.memory.resumed);
    assert_eq!(resumed.ribbons, full.ribbons);
}

fn blocked(mask: &Mask, outcome: &RibbonOutcome<2>, exemplar: &StripExemplar, scale: f64) -> usize {
    let size = mask.bounds.size();
    let canvas = Canvas {
        origin: mask.bounds.min,
        width: (size[0] * scale) as usize,
        height: (size[1] * scale) as usize,
        pixels_per_unit: scale,
    };
    // Drawn without the mask: the pattern itself must stay off it.
    let image = render(&outcome.ribbons, std::slice::from_ref(exemplar), None, &canvas, &Budget::default()).unwrap();
    let centre = |k: usize| {
        let (x, y) = (k % canvas.width, k / canvas.width);
        canvas.origin + Vector::xy(x as f64 + 0.5, y as f64 + 0.5) * (1.0 / scale)
    };
    image.pixels.iter().enumerate().filter(|(k, p)| p[3] > 0 && mask.blocks(centre(*k))).count()
}

/// A round region to avoid.
fn spot(x: f64, y: f64, radius: f64) -> Mask {
    let bounds = Bounds { min: Vector::ZERO, max: Vector::xy(200.0, 100.0) };
    let inside = |k: usize| Vector::xy((k % 200) as f64 + 0.5 - x, (k / 200) as f64 + 0.5 - y).norm() < radius;
    Mask { bounds, width: 200, height: 100, blocked: (0..200 * 100).map(inside).collect() }
}

#[test]
fn the_pattern_goes_around_what_is_to_be_avoided() {
    let exemplar = strip(80, 24, 11);
    let mask = spot(100.0, 44.0, 5.0);
    let params = RibbonParams { step: Some(5.0), width: Width::Constant(44.0), ..RibbonParams::default() };
    let wanted = RibbonRequest { avoid: Some(mask.clone()), ..request(line(&[(10.0, 50.0), (190.0, 50.0)])) };
    let outcome = run(&exemplar, &params, &wanted);
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    for scale in [1.0, 2.0] {
        assert_eq!(blocked(&mask, &outcome, &exemplar, scale), 0, "{scale}");
    }
    let free = run(&exemplar, &params, &request(line(&[(10.0, 50.0), (190.0, 50.0)])));
    assert!(blocked(&mask, &free, &exemplar, 1.0) > 0);
}

#[test]
fn no_way_through_is_an_error_that_names_the_piece_and_relaxing_cuts_it() {
    let exemplar = strip(60, 24, 2);
    let mask = spot(100.0, 50.0, 30.0);
    let wanted = RibbonRequest { avoid: Some(mask.clone()), ..request(line(&[(10.0, 50.0), (190.0, 50.0)])) };
    let params = RibbonParams { step: Some(5.0), ..RibbonParams::default() };
    let prepared = Prepared::new(vec![exemplar.clone()], params.clone(), &Budget::default()).unwrap();
    let error = prepared.run(&wanted, &mut Unobserved).unwrap_err();
    assert!(matches!(error, Error::NoResult { .. }));
    let text = error.to_string();
    assert!(text.contains("curve: piece 12 of 36, at 67.5,50.0") && text.contains("--relax"), "{text}");
    let relaxed = run(&exemplar, &RibbonParams { relax: true, ..params }, &wanted);
    assert_eq!(relaxed.warnings.len(), 1);
    let canvas = Canvas { origin: Vector::ZERO, width: 200, height: 100, pixels_per_unit: 1.0 };
    let image = render(&relaxed.ribbons, &[exemplar], Some(&mask), &canvas, &Budget::default()).unwrap();
    assert!(image.pixels.iter().enumerate().all(|(k, p)| p[3] == 0 || !mask.blocked[k]));
}

#[test]
fn pieces_before_and_after_a_cut_one_are_as_cheap_as_others() {
    let exemplar = strip(120, 40, 2);
    let wanted = request(line(&[(10.0, 50.0), (590.0, 50.0)]));
    let params = RibbonParams { step: Some(5.0), relax: true, ..RibbonParams::default() };
    let work = |wanted: &RibbonRequest<2>| {
        let budget = Budget::default();
        run(&exemplar, &params, &RibbonRequest { budget: budget.clone(), ..wanted.clone() });
        budget.work()
    };
    let free = work(&wanted);
    // Through a wall there is no way at all.
    let wall =
        Mask { blocked: (0..200 * 100).map(|k| (80..120).contains(&(k % 200))).collect(), ..spot(0.0, 0.0, 0.0) };
    let cut = work(&RibbonRequest { avoid: Some(wall), ..wanted });
    assert!(cut < 2 * free, "{cut} units of work, {free} where nothing is in the way");
}

#[test]
fn ends_are_shown_at_the_ends_and_nowhere_else() {
    let exemplar = StripExemplar { start: Some(0..20), end: Some(70..90), ..strip(90, 24, 4) };
    let outcome = run(
        &exemplar,
        &RibbonParams { step: Some(5.0), ..RibbonParams::default() },
        &request(line(&[(0.0, 20.0), (150.0, 20.0)])),
    );
    let x: Vec<f64> = outcome.ribbons[0].pieces.iter().map(|p| p.patch.texture[0][0] - 0.5).collect();
    assert_eq!(x[..4], [0.0, 5.0, 10.0, 15.0]);
    assert_eq!(x[x.len() - 4..], [69.0, 74.0, 79.0, 84.0]);
    assert!(x[4..x.len() - 4].iter().all(|x| (20.0..=65.0).contains(x)), "{x:?}");
}

#[test]
fn several_exemplars_pass_into_one_another() {
    let exemplars = vec![strip(60, 24, 20), strip(60, 20, 21)];
    let params = RibbonParams { step: Some(6.0), ..RibbonParams::default() };
    let prepared = Prepared::new(exemplars, params, &Budget::default()).unwrap();
    let wanted = RibbonRequest { changes: vec![0.5], ..request(line(&[(0.0, 20.0), (300.0, 20.0)])) };
    let outcome = prepared.run(&wanted, &mut Unobserved).unwrap();
    let sources: Vec<usize> = outcome.ribbons[0].pieces.iter().map(|p| p.patch.source).collect();
    assert_eq!((sources[0], sources[sources.len() - 1]), (0, 1));
    assert!(sources[..10].iter().all(|&s| s == 0) && sources[40..].iter().all(|&s| s == 1), "{sources:?}");
}

#[test]
fn a_first_piece_can_be_fixed() {
    let wanted = RibbonRequest { first: Some((17, 1)), ..request(line(&[(0.0, 12.0), (60.0, 12.0)])) };
    let outcome = run(&strip(60, 24, 6), &plain(), &wanted);
    assert_eq!(outcome.ribbons[0].pieces[0].patch.texture[0], Vector::xy(17.5, 1.0));
}

#[test]
fn repetition_is_penalised() {
    let exemplar = strip(60, 24, 12);
    let wanted = request(line(&[(0.0, 20.0), (120.0, 20.0), (200.0, 80.0)]));
    let repeats = |repetition| {
        let params = RibbonParams { repetition, variety: 0.0, step: Some(6.0), ..RibbonParams::default() };
        let x: Vec<f64> =
            run(&exemplar, &params, &wanted).ribbons[0].pieces.iter().map(|p| p.patch.texture[0][0]).collect();
        let pairs = (0..x.len()).flat_map(|i| (i.saturating_sub(8)..i).map(move |j| (i, j)));
        pairs.filter(|&(i, j)| (x[i] - x[j]).abs() < 3.0).count()
    };
    assert!(repeats(4.0) < repeats(0.0), "{} {}", repeats(4.0), repeats(0.0));
}

struct StopAfter(usize, usize);

impl Watch<Snapshot<2>> for StopAfter {
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> Snapshot<2>) -> ControlFlow<()> {
        assert_eq!(preview().patches.len(), progress.count);
        self.1 += 1;
        if self.1 == self.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn a_run_that_is_stopped_gives_back_the_ribbon_so_far() {
    let prepared = Prepared::new(vec![strip(60, 24, 1)], plain(), &Budget::default()).unwrap();
    let outcome = prepared.run(&request(line(&[(0.0, 20.0), (120.0, 20.0)])), &mut StopAfter(7, 0)).unwrap();
    assert_eq!((outcome.ribbons[0].pieces.len(), outcome.stopped), (7, StopReason::Stopped));
}

#[test]
fn curves_in_space_get_a_strip() {
    let points: Vec<Vector<3>> = (0..40)
        .map(|k| {
            let t = f64::from(k) * 0.3;
            Vector([40.0 * t.cos(), 40.0 * t.sin(), 6.0 * t])
        })
        .collect();
    let wanted = RibbonRequest::new(vec![("helix".into(), Path::polyline(&points))]);
    let prepared = Prepared::new(
        vec![strip(60, 24, 1)],
        RibbonParams { step: Some(6.0), ..RibbonParams::default() },
        &Budget::default(),
    )
    .unwrap();
    let outcome = prepared.run_in_space(&wanted, &mut Unobserved).unwrap();
    for pair in outcome.ribbons[0].pieces.windows(2) {
        assert_eq!(pair[0].patch.corners[1], pair[1].patch.corners[0]);
        let edge = pair[0].patch.corners[3] - pair[0].patch.corners[0];
        assert!((edge.norm() - 24.0).abs() < 1e-6);
    }
}

#[test]
fn unusable_exemplars_are_refused() {
    let blank = StripExemplar::new(Image::transparent(40, 20));
    let opaque = StripExemplar::new(Image { pixels: vec![[9, 9, 9, 255]; 800], width: 40, height: 20 });
    let large = StripExemplar::new(Image::transparent(2000, 800));
    for (exemplar, word) in [(blank, "every pixel is transparent"), (opaque, "--relax"), (large, "transparent")] {
        let error = Prepared::new(vec![exemplar], RibbonParams::default(), &Budget::default()).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
    let mut large = strip(2000, 200, 1);
    large.end = None;
    let error = Prepared::new(vec![large], RibbonParams::default(), &Budget::default()).unwrap_err();
    assert!(matches!(error, Error::Limit { .. }) && error.to_string().contains("--coarse 2"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// The bounded search finds what the naive programme finds, to the last bit: the cost and the path.
    #[test]
    fn bounds_lose_nothing(
        seed in 0_u64..1000,
        bend in -40.0..40.0_f64,
        closed: bool,
        repetition in prop::sample::select(vec![0.0, 1.0]),
        context in prop::sample::select(vec![0.0, 1.0]),
        avoid: bool,
    ) {
        let exemplar = strip(36, 18, seed);
        let path = if closed { ring(50.0, 50.0, 22.0) } else { line(&[(10.0, 50.0), (50.0, 50.0), (90.0, 50.0 + bend)]) };
        let mask = avoid.then(|| spot(60.0, 42.0, 1.5));
        let wanted = RibbonRequest { avoid: mask, seed, ..request(path) };
        let solve = |search| {
            let params = RibbonParams { search, repetition, context, relax: true, step: Some(5.0), ..RibbonParams::default() };
            run(&exemplar, &params, &wanted).ribbons
        };
        prop_assert_eq!(solve(Search::Bounded), solve(Search::Exhaustive));
    }

    /// Whatever the curve, every piece lies where its ribbon is, shows a place in its exemplar and meets the next one.
    #[test]
    fn pieces_meet(seed in 0_u64..1000, x in 60.0..140.0_f64, y in 20.0..80.0_f64) {
        let exemplar = strip(48, 20, seed);
        let params = RibbonParams { relax: true, step: Some(5.0), ..RibbonParams::default() };
        let outcome = run(&exemplar, &params, &request(line(&[(10.0, 50.0), (x, y), (190.0, 50.0)])));
        for pair in outcome.ribbons[0].pieces.windows(2) {
            prop_assert_eq!(pair[0].patch.corners[1], pair[1].patch.corners[0]);
            prop_assert_eq!(pair[0].patch.corners[2], pair[1].patch.corners[3]);
        }
        for piece in &outcome.ribbons[0].pieces {
            prop_assert!(piece.patch.texture.iter().all(|p| (0.0..=48.0).contains(&p[0])));
            let p = piece.patch.corners[0];
            prop_assert!((piece.to_canvas(piece.to_exemplar(p)) - p).norm() < 1e-6);
        }
    }
}

#[test]
fn a_closed_square_turns_its_corners() {
    let c = [(20.0, 20.0), (120.0, 20.0), (120.0, 120.0), (20.0, 120.0), (20.0, 20.0)].map(|(x, y)| Vector::xy(x, y));
    let path = Path { cubics: c.windows(2).map(|w| straight(w[0], w[1])).collect(), closed: true };
    let outcome = run(&strip(80, 16, 3), &RibbonParams::default(), &request(path));
    assert!(outcome.ribbons[0].closed && outcome.ribbons[0].pieces.len() == 250);
}
