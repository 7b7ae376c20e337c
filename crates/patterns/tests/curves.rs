//! Whole runs on small nets.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use arabesque_core::{
    Border, Bounds, Budget, Class, Curve, Domain, Drawn, Exemplar, Measured, Outcome, Path, Request, Stage, Stream,
    Unobserved, Vector,
};
use arabesque_patterns::{Params, Prepared, Repeats};

/// The engine alone: these patterns repeat, and would be continued by their repeat.
fn irregular() -> Params {
    Params { repeat: Repeats::Off, ..Params::default() }
}

fn page(w: f64, h: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(w, h))
}

fn curve<const D: usize>(points: &[Vector<D>], closed: bool) -> Curve<D> {
    let mut points = points.to_vec();
    if closed {
        points.push(points[0]);
    }
    Curve { path: Path { closed, ..Path::polyline(&points) }, style: 0, width: 1.0, colour: [0.0; 3] }
}

fn exemplar(curves: Vec<Curve<2>>, window: Bounds<2>) -> Exemplar<2> {
    Exemplar::with_curves(
        "t",
        arabesque_core::Contents {
            curves,
            styles: vec![Class { name: "line".into() }],
            ..arabesque_core::Contents::default()
        },
        window,
    )
    .unwrap()
}

/// A square grid of `n` by `n` cells of side 10, its lines shifted at random by up to `wobble`.
fn grid(n: usize, wobble: f64) -> Exemplar<2> {
    let side = 10.0 * n as f64;
    let mut random = Stream::new(7, Stage::TEST, 0);
    let mut curves = Vec::new();
    for k in 0..n {
        let at = 10.0 * k as f64 + 5.0;
        let mut points = |horizontal: bool| -> Vec<Vector<2>> {
            let along = (0..=2 * n).map(|i| 5.0 * i as f64);
            along
                .map(|t| {
                    let across = at + random.range(-wobble, wobble);
                    if horizontal { Vector::xy(t, across) } else { Vector::xy(across, t) }
                })
                .collect()
        };
        curves.push(curve(&points(true), false));
        curves.push(curve(&points(false), false));
    }
    exemplar(curves, page(side, side))
}

fn fill(exemplar: &Exemplar<2>, params: &Params, request: &Request<2>) -> Outcome<2> {
    Prepared::new(exemplar.clone(), params, &Budget::default()).unwrap().run(request, &mut Unobserved).unwrap()
}

fn length<const D: usize>(outcome: &Outcome<D>) -> f64 {
    outcome.curves.iter().map(|d| Measured::new(d.path.clone(), 1e-3).length()).sum()
}

/// Ends of strokes that lie inside, farther than `rim` from the border.
fn loose_ends(outcome: &Outcome<2>, domain: &Domain<2>, rim: f64) -> usize {
    let ends = outcome.curves.iter().filter(|d| !d.path.closed).flat_map(|d| [d.path.start(), d.path.end()]);
    ends.flatten().filter(|p| domain.signed_distance(*p) > rim).count()
}

#[test]
fn a_grid_stays_a_grid_of_long_strokes() {
    let domain = Domain::Box(page(200.0, 160.0));
    let outcome = fill(&grid(7, 0.6), &irregular(), &Request::new(domain.clone()));
    // 20 lines down and 16 across, each a single stroke from side to side; the border may leave a scrap or two.
    assert!((36..=40).contains(&outcome.curves.len()), "{}", outcome.curves.len());
    assert!(loose_ends(&outcome, &domain, 1.0) <= 2);
    let total = 20.0 * 160.0 + 16.0 * 200.0;
    assert!((length(&outcome) / total - 1.0).abs() < 0.06, "{}", length(&outcome));
}

#[test]
fn the_energy_falls_level_by_level() {
    // From disorder, where there is something to gain at every level.
    let mut params = irregular();
    params.set("initialisation", "random-copy").unwrap();
    params.set("regrowth", "off").unwrap();
    let outcome = fill(&grid(7, 0.6), &params, &Request::new(Domain::Box(page(150.0, 150.0))));
    for level in 0..3 {
        let energies: Vec<f64> = outcome.energy.iter().filter(|e| e.level == level).map(|e| e.energy).collect();
        assert!(energies.len() >= 2, "level {level}: {energies:?}");
        let rise = energies.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max);
        assert!(rise <= 1.05, "level {level}: {energies:?}");
        assert!(energies.last() < energies.first(), "level {level}: {energies:?}");
    }
}

#[test]
fn a_torus_joins_its_strokes_exactly() {
    let domain = Domain::Torus(page(100.0, 80.0));
    let outcome = fill(&grid(7, 0.5), &irregular(), &Request::new(domain.clone()));
    for drawn in outcome.curves.iter().filter(|d| !d.path.closed) {
        let (a, b) = (drawn.path.start().unwrap(), drawn.path.end().unwrap());
        assert!(domain.offset(a, b).norm() < 1e-9, "a stroke that ends on a torus of a grid: {a:?} {b:?}");
    }
    assert!((length(&outcome) / 1600.0 - 1.0).abs() < 0.08, "{}", length(&outcome));
}

#[test]
fn rings_stay_whole() {
    let ring = |cx: f64, cy: f64| {
        let points: Vec<_> = (0..24)
            .map(|k| {
                let turn = f64::from(k) * std::f64::consts::TAU / 24.0;
                Vector::xy(cx + 4.0 * turn.cos(), cy + 4.0 * turn.sin())
            })
            .collect();
        curve(&points, true)
    };
    let rings = (0..49).map(|k| ring(f64::from(k % 7) * 12.0 + 6.0, f64::from(k / 7) * 12.0 + 6.0)).collect();
    let exemplar = exemplar(rings, page(84.0, 84.0));
    let request = Request { border: Border::Cross, ..Request::new(Domain::Box(page(150.0, 120.0))) };
    let outcome = fill(&exemplar, &irregular(), &request);
    let whole = outcome.curves.iter().filter(|d| d.path.closed).count();
    assert!(whole >= 100, "{whole} of {}", outcome.curves.len());
    for drawn in outcome.curves.iter().filter(|d| d.path.closed) {
        let size = drawn.path.bounds().size();
        assert!((size[0] - 8.0).abs() < 1.0 && (size[1] - 8.0).abs() < 1.0, "{size:?}");
    }
}

#[test]
fn corners_stay_corners() {
    let zigzag = |y: f64| {
        let points: Vec<_> = (0..=16).map(|k| Vector::xy(f64::from(k) * 5.0, y + f64::from(k % 2) * 5.0)).collect();
        curve(&points, false)
    };
    let exemplar = exemplar((0..10).map(|k| zigzag(f64::from(k) * 8.0 + 1.0)).collect(), page(80.0, 80.0));
    let outcome = fill(&exemplar, &irregular(), &Request::new(Domain::Box(page(160.0, 80.0))));
    let mut corners = 0;
    for drawn in &outcome.curves {
        for pair in drawn.path.cubics.windows(2) {
            let (come, go) = (pair[0][3] - pair[0][2], pair[1][1] - pair[1][0]);
            let cosine = come.dot(go) / (come.norm() * go.norm());
            corners += usize::from(cosine.abs() < 0.3);
        }
    }
    // Ten zigzags with a corner every five units.
    assert!((250..=330).contains(&corners), "{corners}");
}

#[test]
fn what_the_user_drew_stays_and_is_joined() {
    let exemplar = grid(7, 0.5);
    let drawn = |y: f64| Drawn {
        path: Path::polyline(&[Vector::xy(0.0, y), Vector::xy(60.0, y)]),
        source: 0,
        scale: 1.0,
        frozen: None,
    };
    let frozen: Vec<_> = (0..6).map(|k| drawn(10.0 * f64::from(k) + 5.0)).collect();
    let domain = Domain::Box(Bounds::new(Vector::xy(60.0, 0.0), Vector::xy(140.0, 60.0)));
    let request = Request { frozen_curves: frozen.clone(), ..Request::new(domain) };
    let outcome = fill(&exemplar, &irregular(), &request);
    let kept: Vec<_> = outcome.curves.iter().filter(|d| d.frozen.is_some()).collect();
    assert_eq!(kept.len(), 6);
    assert!(kept.iter().zip(&frozen).all(|(a, b)| a.path == b.path));
    // Every line is taken up where it was left off, to the last bit.
    let ends: Vec<_> = frozen.iter().map(|d| d.path.end().unwrap()).collect();
    let free = outcome.curves.iter().filter(|d| d.frozen.is_none());
    let starts: Vec<_> = free.flat_map(|d| [d.path.start().unwrap(), d.path.end().unwrap()]).collect();
    let joined = ends.iter().filter(|e| starts.contains(e)).count();
    assert!(joined >= 5, "{joined} of 6: {starts:?}");
}

/// What is left of a path outside a box, for horizontal and vertical lines that cross it once at most.
fn outside(path: &Path<2>, hole: &Bounds<2>) -> Vec<Path<2>> {
    let points = path.flatten(1e-3);
    let parts = points.split(|p| hole.grown(-1e-9).contains(*p)).filter(|part| part.len() > 1);
    parts.map(Path::polyline).collect()
}

/// Blocks of five lines each, across and down by turns, like a parquet floor.
fn parquet(n: usize) -> Exemplar<2> {
    let mut random = Stream::new(7, Stage::TEST, 0);
    let mut curves = Vec::new();
    for block in 0..n * n {
        let (i, j) = (block % n, block / n);
        let corner = Vector::xy(22.0 * i as f64, 22.0 * j as f64);
        for k in 0..5 {
            let across = 4.0 * f64::from(k) + 3.0 + random.range(-0.4, 0.4);
            // In small steps, so that a cut goes through a point.
            let line: Vec<_> = (0..=18).map(|t| (2.0 + f64::from(t), across)).collect();
            let turned =
                line.iter().map(|&(a, b)| corner + if (i + j) % 2 == 0 { Vector::xy(a, b) } else { Vector::xy(b, a) });
            curves.push(curve(&turned.collect::<Vec<_>>(), false));
        }
    }
    exemplar(curves, page(22.0 * n as f64, 22.0 * n as f64))
}

/// Fills a hole of an exemplar from what lies around it, which stays.
fn mended(whole: &Exemplar<2>, hole: Bounds<2>, seed: u64) -> Outcome<2> {
    let left =
        |c: &Curve<2>| outside(&c.path, &hole).into_iter().map(|path| Curve { path, ..c.clone() }).collect::<Vec<_>>();
    let curves: Vec<_> = whole.curves.iter().flat_map(left).collect();
    let kept =
        curves.iter().enumerate().map(|(k, c)| Drawn { path: c.path.clone(), source: k, scale: 1.0, frozen: None });
    let request =
        Request { frozen_curves: kept.collect(), known: Some(whole.window), seed, ..Request::new(Domain::Box(hole)) };
    let exemplar = Exemplar { hole: Some(hole), ..exemplar(curves, whole.window) };
    fill(&exemplar, &irregular(), &request)
}

#[test]
fn a_hole_is_filled_from_what_is_around_it() {
    let hole = Bounds::new(Vector::xy(30.0, 30.0), Vector::xy(70.0, 70.0));
    let outcome = mended(&grid(10, 0.4), hole, 0);
    let new: Vec<_> = outcome.curves.iter().filter(|d| d.frozen.is_none()).collect();
    // Four lines each way, from side to side and not beyond.
    assert!((8..=9).contains(&new.len()), "{}", new.len());
    let inside = hole.grown(1e-6);
    assert!(new.iter().all(|d| d.path.flatten(0.1).into_iter().all(|p| inside.contains(p))));
    let ends: Vec<_> = new.iter().flat_map(|d| [d.path.start(), d.path.end()]).flatten().collect();
    let is_cut = |d: &&Drawn<2>| d.frozen.is_some();
    let cuts = outcome.curves.iter().filter(is_cut).flat_map(|d| [d.path.start(), d.path.end()]).flatten();
    let on_hole: Vec<_> = cuts.filter(|p| hole.signed_distance(*p).abs() < 1e-6).collect();
    let met = on_hole.iter().filter(|p| ends.contains(p)).count();
    assert!(on_hole.len() == 16 && met >= 15, "{met} of {}", on_hole.len());
}

#[test]
fn ends_beside_one_another_make_no_endless_stroke() {
    // From disorder, where many ends come to lie beside others.
    let mut params = irregular();
    params.set("initialisation", "random-copy").unwrap();
    params.set("regrowth", "off").unwrap();
    let outcome = fill(&parquet(7), &params, &Request::new(Domain::Box(page(200.0, 200.0))));
    let length = |d: &Drawn<2>| Measured::new(d.path.clone(), 1e-3).length();
    let longest = outcome.curves.iter().map(length).fold(0.0, f64::max);
    assert!(longest < 3.0 * 18.0, "{longest}");
}

#[test]
fn the_number_of_threads_makes_no_difference() {
    let exemplar = grid(6, 0.6);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&exemplar, &irregular(), &Request::new(Domain::Box(page(120.0, 90.0)))).curves)
    };
    let one = run(1);
    [2, 3, 8].into_iter().for_each(|threads| assert_eq!(one, run(threads), "{threads} threads"));
}

#[test]
fn every_component_can_be_left_out() {
    let exemplar = grid(6, 0.5);
    let settings = [
        ("edges", "off"),
        ("orientations", "off"),
        ("shapes", "off"),
        ("mending", "off"),
        ("matching", "hard"),
        ("existence", "fixed"),
        ("initialisation", "white-noise"),
        ("initialisation", "random-copy"),
        ("search", "patchmatch"),
        ("levels", "1"),
        ("coarsening", "1.5"),
        ("spacing", "6"),
    ];
    for (name, value) in settings {
        let mut params = irregular();
        params.set(name, value).unwrap();
        let outcome = fill(&exemplar, &params, &Request::new(Domain::Box(page(60.0, 60.0))));
        assert!(length(&outcome) > 250.0, "{name}={value}: {}", length(&outcome));
    }
    for preset in Params::PRESETS {
        let params = Params::preset(preset.name).unwrap();
        let outcome = fill(&exemplar, &params, &Request::new(Domain::Box(page(60.0, 60.0))));
        assert!(!outcome.curves.is_empty(), "{}", preset.name);
    }
}

#[test]
fn a_lattice_in_space_goes_on() {
    let mut curves = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            let (a, b) = (f64::from(i) * 10.0 + 5.0, f64::from(j) * 10.0 + 5.0);
            for axis in 0..3 {
                let end = |t: f64| {
                    let mut p = [a, b, a];
                    p[axis] = t;
                    p[(axis + 1) % 3] = a;
                    p[(axis + 2) % 3] = b;
                    Vector(p)
                };
                curves.push(curve(&[end(0.0), end(40.0)], false));
            }
        }
    }
    let window = Bounds::new(Vector([0.0; 3]), Vector([40.0; 3]));
    let styles = vec![Class { name: "bar".into() }];
    let exemplar = Exemplar::with_curves(
        "t",
        arabesque_core::Contents { curves, styles, ..arabesque_core::Contents::default() },
        window,
    )
    .unwrap();
    let domain = Domain::Box(Bounds::new(Vector([0.0; 3]), Vector([60.0, 60.0, 40.0])));
    let prepared = Prepared::new(exemplar.clone(), &irregular(), &Budget::default()).unwrap();
    let outcome = prepared.run(&Request::new(domain), &mut Unobserved).unwrap();
    // 6 x 4 bars of 60 twice, 6 x 6 bars of 40.
    let total = 2.0 * 24.0 * 60.0 + 36.0 * 40.0;
    assert!((length(&outcome) / total - 1.0).abs() < 0.15, "{} of {total}", length(&outcome));
}

#[test]
fn curves_that_never_repeat_are_warned_of() {
    let mut random = Stream::new(3, Stage::TEST, 0);
    let points: Vec<_> = (0..12).map(|_| Vector::xy(random.range(5.0, 95.0), random.range(5.0, 95.0))).collect();
    let exemplar = exemplar(vec![curve(&points, false)], page(100.0, 100.0));
    let outcome = fill(&exemplar, &irregular(), &Request::new(Domain::Box(page(150.0, 150.0))));
    assert!(outcome.warnings.iter().any(|w| w.message.contains("nothing to repeat")), "{:?}", outcome.warnings);
}

#[test]
fn curves_outside_the_frame_are_refused() {
    let exemplar =
        exemplar(vec![curve(&[Vector::xy(-50.0, -50.0), Vector::xy(-10.0, -20.0)], false)], page(10.0, 10.0));
    let error = Prepared::new(exemplar.clone(), &irregular(), &Budget::default()).unwrap_err();
    assert!(error.to_string().contains("outside the frame"), "{error}");
}
