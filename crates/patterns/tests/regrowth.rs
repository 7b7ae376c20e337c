//! Starts in disorder, grown anew.

#![allow(clippy::unwrap_used, reason = "a test may panic, its helpers as well")]

use arabesque_core::{
    Bounds, Budget, Class, Curve, Domain, Drawn, Exemplar, Outcome, Path, Request, Stage, Stream, Unobserved, Vector,
};
use arabesque_patterns::{Params, Prepared, Repeats};

/// The engine alone: these patterns repeat, and would be continued by their repeat.
fn irregular() -> Params {
    Params { repeat: Repeats::Off, ..Params::default() }
}

fn page(w: f64, h: f64) -> Domain<2> {
    Domain::Box(Bounds::new(Vector::ZERO, Vector::xy(w, h)))
}

/// Bricks: seven rows of height 10, joints 20 apart, every second row shifted by half a brick, lines a little unsteady.
fn bricks() -> Exemplar<2> {
    let mut random = Stream::new(7, Stage::TEST, 0);
    let mut curves = Vec::new();
    let mut line = |points: &[Vector<2>]| {
        curves.push(Curve { path: Path::polyline(points), style: 0, width: 1.0, colour: [0.0; 3] });
    };
    for row in 0..8 {
        let y = 10.0 * f64::from(row) + 5.0;
        let across: Vec<_> = (0..=16).map(|i| Vector::xy(5.0 * f64::from(i), y + random.range(-0.4, 0.4))).collect();
        line(&across);
        for joint in 0..4 {
            let x = 20.0 * f64::from(joint) + 10.0 * f64::from(row % 2) + 3.0 + random.range(-0.4, 0.4);
            let foot = (y + 10.0).min(80.0);
            line(&[Vector::xy(x, y), Vector::xy(x, foot)]);
        }
    }
    let window = Bounds::new(Vector::ZERO, Vector::xy(80.0, 80.0));
    let styles = vec![Class { name: "line".into() }];
    Exemplar::with_curves(
        "bricks",
        arabesque_core::Contents { curves, styles, ..arabesque_core::Contents::default() },
        window,
    )
    .unwrap()
}

fn fill(settings: &[(&str, &str)], request: &Request<2>) -> Outcome<2> {
    let mut params = irregular();
    settings.iter().for_each(|(name, value)| params.set(name, value).unwrap());
    Prepared::new(bricks(), &params, &Budget::default()).unwrap().run(request, &mut Unobserved).unwrap()
}

/// Energy of the last search.
fn final_energy(outcome: &Outcome<2>) -> f64 {
    outcome.energy.last().unwrap().energy
}

#[test]
fn a_start_in_noise_comes_into_order() {
    let request = Request::new(page(200.0, 160.0));
    let grown = fill(&[("initialisation", "white-noise")], &request);
    let plain = fill(&[("initialisation", "white-noise"), ("regrowth", "off")], &request);
    let patches = fill(&[], &request);
    let (grown, plain, patches) = (final_energy(&grown), final_energy(&plain), final_energy(&patches));
    assert!(grown < 0.5 * plain && grown < 2.0 * patches, "{grown} regrown, {plain} not, {patches} from patches");
}

#[test]
fn patches_that_agree_are_not_grown_anew() {
    let request = Request::new(page(120.0, 100.0));
    let [on, off] = ["on", "off"].map(|value| fill(&[("regrowth", value)], &request));
    assert_eq!(on.curves, off.curves);
}

#[test]
fn regrowth_keeps_what_is_drawn_and_takes_it_up() {
    let drawn = |row: u32| Drawn {
        path: Path::polyline(&[
            Vector::xy(0.0, 10.0 * f64::from(row) + 5.0),
            Vector::xy(50.0, 10.0 * f64::from(row) + 5.0),
        ]),
        source: 0,
        scale: 1.0,
        frozen: None,
    };
    let frozen: Vec<_> = (0..10).map(drawn).collect();
    let domain = Domain::Box(Bounds::new(Vector::xy(50.0, 0.0), Vector::xy(200.0, 100.0)));
    let request = Request { frozen_curves: frozen.clone(), ..Request::new(domain) };
    let outcome = fill(&[("initialisation", "white-noise")], &request);
    let kept: Vec<_> = outcome.curves.iter().filter(|d| d.frozen.is_some()).map(|d| &d.path).collect();
    assert!(kept.iter().copied().eq(frozen.iter().map(|d| &d.path)));
    let free = outcome.curves.iter().filter(|d| d.frozen.is_none());
    let ends: Vec<_> = free.flat_map(|d| [d.path.start().unwrap(), d.path.end().unwrap()]).collect();
    let joined = frozen.iter().filter(|d| ends.contains(&d.path.end().unwrap())).count();
    assert!(joined >= 8, "{joined} of 10");
}

#[test]
fn the_number_of_threads_makes_no_difference() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill(&[("initialisation", "white-noise")], &Request::new(page(120.0, 90.0))).curves)
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
}

#[test]
fn progress_never_goes_back() {
    struct Fractions(Vec<f64>);
    impl arabesque_core::Watch<arabesque_core::Snapshot<2>> for Fractions {
        fn step(
            &mut self,
            progress: &arabesque_core::Progress,
            _: &dyn Fn() -> arabesque_core::Snapshot<2>,
        ) -> std::ops::ControlFlow<()> {
            assert!(progress.done <= progress.total, "{progress:?}");
            self.0.push(progress.fraction);
            std::ops::ControlFlow::Continue(())
        }
    }
    let mut params = irregular();
    params.set("initialisation", "white-noise").unwrap();
    let mut seen = Fractions(Vec::new());
    Prepared::new(bricks(), &params, &Budget::default())
        .unwrap()
        .run(&Request::new(page(200.0, 160.0)), &mut seen)
        .unwrap();
    assert!(seen.0.windows(2).all(|pair| pair[0] <= pair[1]), "{:?}", seen.0);
    assert!(seen.0.iter().all(|f| (0.0..=1.0).contains(f)));
}
