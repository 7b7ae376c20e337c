//! Time of whole runs on elements, of single stages, and of runs with single stages left out or replaced.
//!
//! One thread, unless `RAYON_NUM_THREADS` says otherwise.

use arabesque_core::{
    Bounds, Budget, Class, Domain, Element, Exemplar, Outcome, Outline, Request, Role, Similarity, Stream, Unobserved,
    Vector,
};
use arabesque_patterns::{
    Params, Prepared, Repeats,
    stages::{Setup, Stage},
};
use divan::Bencher;

/// The engine alone: these patterns repeat, and would be continued by their repeat.
fn irregular() -> Params {
    Params { repeat: Repeats::Off, ..Params::default() }
}

/// Elements of the output.
const SIZES: [usize; 3] = [100, 1_000, 10_000];

/// A hexagonal grid of 72 points.
fn hexagonal() -> Exemplar<2> {
    let node = |k: u32| {
        let (column, row) = (f64::from(k % 8), f64::from(k / 8));
        Vector::xy(column + 0.25 + 0.5 * (row % 2.0), (row + 0.5) * 0.75_f64.sqrt())
    };
    points((0..72).map(node).collect(), 1)
}

/// 90 points at random that keep a distance, in three classes.
fn scattered() -> Exemplar<2> {
    points(spread(90, 10.0, 0.75), 3)
}

/// 80 discs of several sizes in two classes, with outlines of 24 corners.
fn discs() -> Exemplar<2> {
    let mut stream = Stream::new(4, arabesque_core::Stage::TEST, 1);
    let centres = spread(80, 10.0, 0.8);
    let elements = centres.iter().enumerate().map(|(k, &centre)| {
        let radius = stream.range(0.2, 0.38);
        let corner = |c: u32| {
            let turn = f64::from(c) / 24.0 * std::f64::consts::TAU;
            centre + Vector::xy(turn.cos(), turn.sin()) * radius
        };
        let outline = Outline { rings: vec![(0..24).map(corner).collect()] };
        Element {
            class: k % 2,
            centre,
            pose: Similarity::identity(),
            outline,
            colour: [0.5; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    });
    let window = Bounds::new(Vector::ZERO, Vector::splat(10.0));
    Exemplar::new("benchmark", elements.collect(), classes(2), window).expect("the exemplar is valid")
}

fn points(points: Vec<Vector<2>>, count: usize) -> Exemplar<2> {
    let class_of: Vec<_> = (0..points.len()).map(|k| k % count).collect();
    let names: Vec<_> = classes(count).into_iter().map(|class| class.name).collect();
    Exemplar::from_points("benchmark", &points, &class_of, &names).expect("the exemplar is valid")
}

fn classes(count: usize) -> Vec<Class> {
    (0..count).map(|k| Class { name: format!("class {k}") }).collect()
}

/// Up to `count` points in a square of `side`, no two nearer than `distance`.
fn spread(count: usize, side: f64, distance: f64) -> Vec<Vector<2>> {
    let mut stream = Stream::new(4, arabesque_core::Stage::TEST, 0);
    let mut found: Vec<Vector<2>> = Vec::new();
    for _ in 0..100 * count {
        let p = Vector::xy(stream.range(0.5, side - 0.5), stream.range(0.5, side - 0.5));
        if found.len() < count && found.iter().all(|&q| (p - q).norm() >= distance) {
            found.push(p);
        }
    }
    found
}

/// A square page for about `n` elements.
fn page(exemplar: &Exemplar<2>, n: usize) -> Request<2> {
    let side = exemplar.spacing() * (n as f64).sqrt();
    Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(side))))
}

fn params(settings: &[(&str, &str)]) -> Params {
    let mut params = irregular();
    for (name, value) in settings {
        params.set(name, value).expect("the setting exists");
    }
    params
}

fn fill(bencher: Bencher, exemplar: &Exemplar<2>, n: usize, settings: &[(&str, &str)]) {
    let prepared =
        Prepared::new(exemplar.clone(), &params(settings), &Budget::default()).expect("the exemplar can be analysed");
    let request = page(exemplar, n);
    bencher.bench_local(|| -> Outcome<2> { prepared.run(&request, &mut Unobserved).expect("the page can be filled") });
}

/// Times one stage for about `n` samples.
fn time(bencher: Bencher, exemplar: &Exemplar<2>, n: usize, stage: Stage) {
    Setup::new(exemplar, n).with(|bench| {
        let fresh = bencher.with_inputs(|| bench.before(stage));
        fresh.bench_local_values(|mut output| {
            output.run(stage);
            output
        });
    });
}

fn time_layout(bencher: Bencher, exemplar: &Exemplar<2>, n: usize) {
    Setup::new(exemplar, n).with(|bench| bencher.bench_local(|| bench.lay_out()));
}

fn time_matching(bencher: Bencher, exemplar: &Exemplar<2>, n: usize) {
    Setup::new(exemplar, n).with(|bench| {
        let mut pairings = bench.pairings();
        bencher.bench_local(|| pairings.run());
    });
}

/// One thread, unless `RAYON_NUM_THREADS` says otherwise.
fn set_threads() {
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");
    }
}

/// Analysing the exemplar.
mod prepare {
    use super::*;

    fn analyse(bencher: Bencher, exemplar: &Exemplar<2>) {
        let params = irregular();
        bencher.bench_local(|| Prepared::new(exemplar.clone(), &params, &Budget::default()));
    }

    #[divan::bench(sample_count = 20)]
    fn hexagonal(bencher: Bencher) {
        analyse(bencher, &super::hexagonal());
    }

    #[divan::bench(sample_count = 20)]
    fn scattered(bencher: Bencher) {
        analyse(bencher, &super::scattered());
    }

    #[divan::bench(sample_count = 20)]
    fn discs(bencher: Bencher) {
        analyse(bencher, &super::discs());
    }
}

/// Whole runs with the default parameters.
mod whole {
    use super::*;

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn hexagonal(bencher: Bencher, n: usize) {
        fill(bencher, &super::hexagonal(), n, &[]);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn scattered(bencher: Bencher, n: usize) {
        fill(bencher, &super::scattered(), n, &[]);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn discs(bencher: Bencher, n: usize) {
        fill(bencher, &super::discs(), n, &[]);
    }

    #[divan::bench(args = [100_000], sample_count = 1)]
    fn many_discs(bencher: Bencher, n: usize) {
        fill(bencher, &super::discs(), n, &[]);
    }
}

/// One stage at a time, on discs.
mod stage {
    use super::*;

    /// Elements of the output.
    const SIZES: [usize; 4] = [100, 1_000, 10_000, 100_000];

    #[divan::bench(args = SIZES, sample_count = 1)]
    fn layout(bencher: Bencher, n: usize) {
        time_layout(bencher, &discs(), n);
    }

    #[divan::bench(args = SIZES, sample_count = 2)]
    fn search(bencher: Bencher, n: usize) {
        time(bencher, &discs(), n, Stage::Search);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn matching(bencher: Bencher, n: usize) {
        time_matching(bencher, &discs(), n);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn solve(bencher: Bencher, n: usize) {
        time(bencher, &discs(), n, Stage::Solve);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn existence(bencher: Bencher, n: usize) {
        time(bencher, &discs(), n, Stage::Existence);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn reconstruct(bencher: Bencher, n: usize) {
        time(bencher, &discs(), n, Stage::Reconstruct);
    }
}

/// One stage left out or replaced, on discs.
mod without {
    use super::*;

    const N: [usize; 1] = [2_000];

    /// Everything, to compare with.
    #[divan::bench(args = N, sample_count = 3)]
    fn a_change(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[]);
    }

    /// The first layout alone.
    #[divan::bench(args = N, sample_count = 3)]
    fn optimisation(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("iterations", "0"), ("existence", "fixed"), ("clearance", "ignored")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn patches_in_the_layout(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("initialisation", "white-noise")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn coherence_in_the_search(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("search", "patchmatch")]);
    }

    #[divan::bench(args = N, sample_count = 1)]
    fn shortcuts_in_the_search(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("search", "exhaustive")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn optimal_matching(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("matching", "hard")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn adding_and_removing(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("existence", "fixed")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn exchanging(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("attributes", "kept")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn clearance(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("clearance", "ignored")]);
    }

    #[divan::bench(args = N, sample_count = 3)]
    fn levels(bencher: Bencher, n: usize) {
        fill(bencher, &discs(), n, &[("levels", "1")]);
    }
}

fn main() {
    set_threads();
    divan::main();
}
