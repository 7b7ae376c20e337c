//! Time of whole runs and of single stages on curves, for about 300 to 20 000 samples at the finest level.
//!
//! One thread, unless `RAYON_NUM_THREADS` says otherwise.

use arabesque_core::{Bounds, Budget, Class, Curve, Exemplar, Path, Stream, Vector};
use arabesque_patterns::{
    Params, Prepared, Repeats,
    stages::{Setup, Stage},
};
use divan::Bencher;

/// The engine alone: these patterns repeat, and would be continued by their repeat.
fn irregular() -> Params {
    Params { repeat: Repeats::Off, ..Params::default() }
}

/// Samples of the output at the finest level, about.
const SIZES: [usize; 4] = [300, 1_300, 5_000, 20_000];

/// Side of the exemplars.
const SIDE: f64 = 240.0;

fn exemplar(paths: Vec<Path<2>>) -> Exemplar<2> {
    let curves = paths.into_iter().map(|path| Curve { path, style: 0, width: 1.5, colour: [0.0; 3] });
    let styles = vec![Class { name: "line".into() }];
    let window = Bounds::new(Vector::ZERO, Vector::splat(SIDE));
    Exemplar::with_curves(
        "benchmark",
        arabesque_core::Contents { curves: curves.collect(), styles, ..arabesque_core::Contents::default() },
        window,
    )
    .expect("the exemplar is valid")
}

/// Hexagons whose corners lie a little off: many short strokes that meet three by three.
fn net() -> Exemplar<2> {
    let edge = 16.0;
    let (dx, dy) = (edge * 3.0_f64.sqrt(), 1.5 * edge);
    let node = |column: i32, row: i32, lower: bool| {
        let number = ((column + 64) * 256 + (row + 64) * 2 + i32::from(lower)) as u64;
        let mut stream = Stream::new(5, arabesque_core::Stage::TEST, number);
        let wobble = Vector::xy(stream.range(-1.0, 1.0), stream.range(-1.0, 1.0));
        let shift = 0.5 * f64::from(row.rem_euclid(2));
        let down = if lower { 0.5 * edge } else { 0.0 };
        Vector::xy((f64::from(column) + shift) * dx, f64::from(row) * dy - down) + wobble
    };
    let mut paths = Vec::new();
    for row in -1..12 {
        for column in -1..11 {
            let centre = node(column, row, true);
            // Each lower node is joined to the upper ones on its left and right, and to the one of the row before.
            let left = column - 1 + row.rem_euclid(2);
            let above = [node(left, row - 1, false), node(left + 1, row - 1, false)];
            let below = node(column, row, false);
            paths.extend(above.into_iter().chain([below]).map(|end| Path::polyline(&[centre, end])));
        }
    }
    exemplar(paths)
}

/// Wavy lines in two directions: long strokes that cross.
fn weave() -> Exemplar<2> {
    let wave = |k: i32, turn: bool| {
        let place = |i: i32| {
            let along = f64::from(i) * 6.0 - 12.0;
            let across = f64::from(k) * 20.0 + 3.0 * (along * 0.08 + f64::from(k) * 1.7).sin();
            if turn { Vector::xy(across, along) } else { Vector::xy(along, across) }
        };
        Path::polyline(&(0..44).map(place).collect::<Vec<_>>())
    };
    exemplar((0..13).flat_map(|k| [wave(k, false), wave(k, true)]).collect())
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

    #[divan::bench(sample_count = 5)]
    fn net(bencher: Bencher) {
        analyse(bencher, &super::net());
    }

    #[divan::bench(sample_count = 5)]
    fn weave(bencher: Bencher) {
        analyse(bencher, &super::weave());
    }
}

/// Whole runs with the default parameters.
mod whole {
    use super::*;

    fn fill(bencher: Bencher, exemplar: &Exemplar<2>, n: usize) {
        let setup = Setup::new(exemplar, n);
        bencher.bench_local(|| setup.fill());
    }

    #[divan::bench(args = SIZES, sample_count = 1)]
    fn net(bencher: Bencher, n: usize) {
        fill(bencher, &super::net(), n);
    }

    #[divan::bench(args = SIZES, sample_count = 1)]
    fn weave(bencher: Bencher, n: usize) {
        fill(bencher, &super::weave(), n);
    }
}

/// One stage at a time, on the net.
mod stage {
    use super::*;

    #[divan::bench(args = SIZES, sample_count = 2)]
    fn layout(bencher: Bencher, n: usize) {
        time_layout(bencher, &net(), n);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn search(bencher: Bencher, n: usize) {
        time(bencher, &net(), n, Stage::Search);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn matching(bencher: Bencher, n: usize) {
        time_matching(bencher, &net(), n);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn solve(bencher: Bencher, n: usize) {
        time(bencher, &net(), n, Stage::Solve);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn existence(bencher: Bencher, n: usize) {
        time(bencher, &net(), n, Stage::Existence);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn edges(bencher: Bencher, n: usize) {
        time(bencher, &net(), n, Stage::Edges);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn orientations(bencher: Bencher, n: usize) {
        time(bencher, &net(), n, Stage::Orientations);
    }

    #[divan::bench(args = SIZES, sample_count = 3)]
    fn reconstruct(bencher: Bencher, n: usize) {
        time(bencher, &net(), n, Stage::Reconstruct);
    }
}

fn main() {
    set_threads();
    divan::main();
}
