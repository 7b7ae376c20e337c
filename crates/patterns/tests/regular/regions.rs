//! Regions that are filled again come back as the repeat has them, and lattices that fields bend hold together.

use std::sync::Arc;

use arabesque_core::{
    Border, Bounds, Budget, Domain, Drawn, Exemplar, Grid, GridIndex, Matrix, OrientationField, Outcome, Path,
    Placement, Request, ScalarField, Shape, Similarity, Vector,
};
use arabesque_patterns::{Params, Prepared};

use crate::{
    drawing::{Pattern, cut, xy},
    elements::{bricks, chess, frame},
    measure::{TOLERANCE, assert_same, centres, expected, hausdorff, page, prepared, run},
    strokes::{chevrons, honeycomb, plaid},
};

/// The drawing in a frame with a hole, and the request to fill it again from what stays.
fn with_hole(pattern: &Pattern, window: Bounds<2>, hole: Bounds<2>, seed: u64) -> (Exemplar<2>, Request<2>) {
    let mut exemplar = pattern.exemplar(window);
    exemplar.elements.retain(|e| !hole.contains(e.centre));
    exemplar.hole = Some(hole);
    let mut request = Request::new(Domain::Region(Arc::new(Shape::rectangle(hole).unwrap())));
    (request.border, request.known, request.seed) = (Border::Cross, Some(window), seed);
    let whole = (0..exemplar.elements.len()).filter(|&k| exemplar.elements[k].role == arabesque_core::Role::Source);
    let stays = |source| Placement { source, transform: Similarity::identity(), control: Vec::new(), frozen: None };
    request.frozen = whole.map(stays).collect();
    for (source, curve) in exemplar.curves.iter().enumerate() {
        for part in outside(&curve.path.flatten(1e-6), &hole) {
            request.frozen_curves.push(Drawn { path: Path::polyline(&part), source, scale: 1.0, frozen: None });
        }
    }
    (exemplar, request)
}

/// The parts of a line outside of a box.
fn outside(line: &[Vector<2>], hole: &Bounds<2>) -> Vec<Vec<Vector<2>>> {
    let far = 1e6;
    let [low, high] = [hole.min, hole.max];
    let beside = [
        Bounds::new(xy(-far, -far), xy(low[0], far)),
        Bounds::new(xy(high[0], -far), xy(far, far)),
        Bounds::new(xy(low[0], -far), xy(high[0], low[1])),
        Bounds::new(xy(low[0], high[1]), xy(high[0], far)),
    ];
    beside.iter().flat_map(|part| cut(line, part)).collect()
}

/// Regions of a frame of some periods: in the middle, at a corner, flat, and along the places of the lattice.
fn holes(window: &Bounds<2>, unit: f64) -> [Bounds<2>; 4] {
    let at = |x: f64, y: f64, w: f64, h: f64| {
        let corner = window.min + xy(x, y) * unit;
        Bounds::new(corner, corner + xy(w, h) * unit)
    };
    [at(3.1, 2.7, 3.3, 2.9), at(-0.5, -0.4, 3.7, 3.1), at(2.2, 3.3, 5.1, 1.2), at(3.0, 3.0, 3.0, 3.0)]
}

#[test]
fn elements_in_a_region_come_back_in_their_places() {
    for (name, pattern) in [("chess", chess().scaled(10.0)), ("bricks", bricks().scaled(9.0))] {
        let unit = pattern.shorter();
        let window = Bounds::new(Vector::ZERO, xy(9.3, 8.1) * unit);
        for (k, hole) in holes(&window, unit).into_iter().enumerate() {
            let (exemplar, request) = with_hole(&pattern, window, hole, k as u64);
            let outcome = run(&prepared(&exemplar, name), &request);
            let wanted = expected(&pattern, Vector::ZERO, &window);
            let inner = |p: Vector<2>| window.signed_distance(p) > unit;
            let found = centres(&exemplar, &outcome);
            assert_same(&found, &wanted, TOLERANCE * unit, inner, &format!("{name}, region {k}"));
        }
    }
}

#[test]
fn strokes_in_a_region_go_on_in_what_stays() {
    let all = [("plaid", plaid()), ("honeycomb", honeycomb()), ("chevrons", chevrons())];
    for (name, pattern) in all.map(|(name, pattern)| (name, pattern.scaled(20.0))) {
        let unit = pattern.shorter();
        let window = Bounds::new(Vector::ZERO, xy(9.3, 8.1) * unit);
        for (k, hole) in holes(&window, unit).into_iter().enumerate() {
            let (exemplar, request) = with_hole(&pattern, window, hole, k as u64);
            let outcome = run(&prepared(&exemplar, name), &request);
            let inside = Bounds::new(hole.min.zip(window.min, f64::max), hole.max).grown(-0.01 * unit);
            let off = hausdorff(&pattern, &exemplar, &outcome, Vector::ZERO, &inside);
            assert!(off <= TOLERANCE * unit, "{name}, region {k}: {:.4} of a period off", off / unit);
            let ends = outcome.curves.iter().flat_map(|c| [c.path.start().unwrap(), c.path.end().unwrap()]);
            let is_inside =
                |p: &Vector<2>| hole.signed_distance(*p) > 0.02 * unit && window.signed_distance(*p) > 0.02 * unit;
            // Three strokes of a honeycomb end in each of its corners.
            assert!(name == "honeycomb" || !ends.into_iter().any(|p| is_inside(&p)), "{name}, region {k}");
        }
    }
}

#[test]
fn strokes_that_stay_are_kept_and_the_rest_of_the_lattice_is_drawn_around_them() {
    let pattern = honeycomb().scaled(20.0);
    let window = frame(&pattern, 1);
    let exemplar = pattern.exemplar(window);
    let page = page(120.0, 90.0);
    let by = page.min - window.min;
    let mut request = Request::new(Domain::Box(page));
    let there = Bounds::new(xy(30.0, 20.0), xy(80.0, 60.0));
    let kept = pattern.lines(&Bounds::new(there.min - by, there.max - by));
    request.frozen_curves = kept
        .iter()
        .map(|(line, _)| Path::polyline(&line.iter().map(|p| *p + by).collect::<Vec<_>>()))
        .map(|path| Drawn { path, source: 0, scale: 1.0, frozen: None })
        .collect();
    let outcome = run(&prepared(&exemplar, "honeycomb"), &request);
    let kept = outcome.curves.iter().filter(|c| c.frozen.is_some());
    assert_eq!(kept.count(), request.frozen_curves.len());
    let off = hausdorff(&pattern, &exemplar, &outcome, by, &page);
    assert!(off <= TOLERANCE * pattern.shorter(), "{off}");
}

/// A field of directions over a page.
fn turned(page: Bounds<2>, angle: impl Fn(Vector<2>) -> f64) -> OrientationField<2> {
    let mut field = Grid { bounds: page, nodes: [101, 81], values: vec![Matrix::identity(); 101 * 81] };
    for k in 0..field.values.len() {
        field.values[k] = Matrix::rotation(angle(field.node(k)));
    }
    OrientationField::Grid(field)
}

fn told(outcome: &Outcome<2>) -> &str {
    outcome.warnings.iter().map(|w| w.message.as_str()).find(|m| m.contains("stretch")).unwrap_or("")
}

#[test]
fn a_gentle_field_bends_the_lattice_and_breaks_it_nowhere() {
    let pattern = chess().scaled(8.0);
    let exemplar = pattern.exemplar(frame(&pattern, 0));
    let prepared = prepared(&exemplar, "chess");
    let page = page(160.0, 120.0);
    let mut request = Request::new(Domain::Box(page));
    request.fields.orientation = Some(turned(page, |p| 0.08 * (p[0] / 40.0).sin()));
    let outcome = run(&prepared, &request);
    assert!(told(&outcome).ends_with("break it nowhere"), "{}", told(&outcome));
    let places: Vec<_> =
        centres(&exemplar, &outcome).into_iter().filter(|(p, _)| page.signed_distance(*p) > 12.0).collect();
    let all = centres(&exemplar, &outcome);
    let points: Vec<_> = all.iter().map(|(p, _)| *p).collect();
    let index = GridIndex::new(&points, 8.0, &Domain::Box(page.grown(20.0)));
    assert!(places.len() > 100);
    for (p, class) in places {
        // Every square has four of the other colour beside it, about as far away as on the board.
        let mut beside = Vec::new();
        index.within(p, 9.4, |k, offset| beside.extend((offset.norm() > 1.0).then_some((all[k].1, offset.norm()))));
        assert_eq!(beside.len(), 4, "{p:?}");
        assert!(beside.iter().all(|(other, apart)| *other != class && *apart > 6.8));
    }
}

#[test]
fn strokes_bent_by_a_gentle_field_stay_whole() {
    let pattern = chevrons().scaled(12.0);
    let exemplar = pattern.exemplar(frame(&pattern, 1));
    let page = page(150.0, 110.0);
    let mut request = Request::new(Domain::Box(page));
    request.fields.orientation = Some(turned(page, |p| 0.01 * (p[1] / 40.0).cos()));
    let outcome = run(&prepared(&exemplar, "chevrons"), &request);
    let ends = outcome.curves.iter().flat_map(|c| [c.path.start().unwrap(), c.path.end().unwrap()]);
    assert!(outcome.curves.len() > 10 && ends.into_iter().all(|p| page.signed_distance(p) < 0.1));
}

#[test]
fn a_scale_that_grows_breaks_the_lattice_along_few_lines_and_threads_change_nothing() {
    let pattern = chess().scaled(6.0);
    let exemplar = pattern.exemplar(frame(&pattern, 0));
    let prepared = prepared(&exemplar, "chess");
    let page = page(160.0, 100.0);
    let mut request = Request::new(Domain::Box(page));
    let values = vec![0.7, 1.6, 0.7, 1.6];
    request.fields.scale = ScalarField::Grid(Grid { bounds: page, nodes: [2, 2], values });
    let pools = [1, 2, 8].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    let all = pools.map(|pool| pool.install(|| run(&prepared, &request)));
    assert!(all[1].placements == all[0].placements && all[2].placements == all[0].placements);
    assert!(told(&all[0]).contains("break it along"), "{}", told(&all[0]));
    let covered: f64 = all[0]
        .placements
        .iter()
        .map(|p| exemplar.elements[p.source].outline.transformed(&p.transform))
        .map(|outline| outline.intersection(&Shape::rectangle(page).unwrap().outline().clone()).area())
        .sum();
    assert!((0.8..1.15).contains(&(covered / page.measure())), "{}", covered / page.measure());
}

#[test]
fn a_field_that_turns_around_a_place_all_over_is_left_to_the_engine_or_broken() {
    let pattern = bricks().scaled(3.0);
    let exemplar = pattern.exemplar(frame(&pattern, 0));
    let prepared = Prepared::new(exemplar, &Params::default(), &Budget::default()).unwrap();
    let page = page(60.0, 50.0);
    let mut request = Request::new(Domain::Box(page));
    request.fields.orientation = Some(turned(page, |p| 40.0 * (p[0] * 0.9).sin() * (p[1] * 1.1).cos()));
    let outcome = run(&prepared, &request);
    assert!(outcome.warnings.iter().any(|w| w.message.contains("no lattice can follow")), "{:?}", outcome.warnings);
}
