//! Reliefs at the sizes of [Duranleau 2008, table 1], what their steps take, and how time grows with the output.
//!
//! `cargo bench -p arabesque-reliefs`. The paper has, on an Athlon 64 at 2.2 GHz: a height field of 33 194 points continued to 87 101 in 30.7 s, chain
//! mail of 71 454 points to 197 282 in 38.0 s and to 2 947 085 in 710.8 s, a weave of 43 592 points to 126 139 in 28.0 s, flowers of 37 473 points to
//! 68 290 in 36.0 s, and below 10 s for what is worked out before. Here that is `prepare`.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]
#![allow(missing_docs, reason = "the macros of divan make items without any")]

use std::{f64::consts::TAU, sync::LazyLock};

use arabesque_core::{Budget, Limits, PointSet, Stage, Stream, Unobserved, Vector};
use arabesque_reliefs::{Ground, Prepared, ReliefParams, ReliefRequest, Search};

fn main() {
    divan::main();
}

/// Points with normals of which those in the unit square are kept, `count` at most.
fn kept(points: Vec<(Vector<3>, Vector<3>)>, count: usize) -> PointSet<3> {
    let inside = |p: &Vector<3>| (0..2).all(|k| (0.0..1.0).contains(&p[k]));
    let mut points: Vec<_> = points.into_iter().filter(|(p, _)| inside(p)).collect();
    let mut stream = Stream::new(1, Stage::new(1), 0);
    for k in (1..points.len()).rev() {
        points.swap(k, stream.below(k + 1));
    }
    points.truncate(count);
    let (positions, normals) = points.into_iter().unzip();
    PointSet { normals: Some(normals), ..PointSet::at(positions) }
}

/// Waves of all directions and lengths.
fn terrain() -> PointSet<3> {
    let mut stream = Stream::new(2, Stage::new(1), 0);
    let waves: Vec<[f64; 4]> = (0..60)
        .map(|_| {
            let (way, pace) = (stream.range(0.0, TAU), stream.range(8.0, 45.0));
            [pace * way.cos(), pace * way.sin(), stream.range(0.0, TAU), 0.06 / pace]
        })
        .collect();
    let n = 183_u32;
    let at = |k: u32| {
        let mut along = |c: u32| (f64::from(c) + 0.5 + stream.range(-0.3, 0.3)) / f64::from(n);
        let (x, y) = (along(k % n), along(k / n));
        let (mut z, mut slope) = (0.0, [0.0; 2]);
        for [a, b, c, size] in &waves {
            let (sin, cos) = (a * x + b * y + c).sin_cos();
            z += size * cos;
            slope = [slope[0] - size * a * sin, slope[1] - size * b * sin];
        }
        (Vector([x, y, z]), Vector([-slope[0], -slope[1], 1.0]).unit())
    };
    kept((0..n * n).map(at).collect(), 33_194)
}

/// Points on a tube around a curve that is not upright anywhere.
fn tube(curve: impl Fn(f64) -> Vector<3>, radius: f64, (along, around): (u32, u32)) -> Vec<(Vector<3>, Vector<3>)> {
    let of = |k: u32| {
        let t = (f64::from(k / around) + 0.5) / f64::from(along);
        let angle = (f64::from(k % around) + 0.5 * f64::from(k / around % 2)) / f64::from(around) * TAU;
        let way = (curve(t + 1e-4) - curve(t - 1e-4)).unit();
        let u = way.cross(Vector([0.0, 0.0, 1.0])).unit();
        let normal = u * angle.cos() + u.cross(way) * angle.sin();
        (curve(t) + normal * radius, normal)
    };
    (0..along * around).map(of).collect()
}

/// Rings, each through its neighbours.
fn mail() -> PointSet<3> {
    let mut stream = Stream::new(3, Stage::new(1), 0);
    let side = 1.0 / 8.0;
    let mut points = Vec::new();
    for k in 0..110_i32 {
        let (i, j) = (k % 10 - 1, k / 10 - 1);
        let mut jitter = |size: f64| stream.range(-size, size);
        let middle = [i, j].map(|v| (f64::from(v) + 0.5) * side + jitter(0.03 * side));
        let lean: f64 = if (i + j) % 2 == 0 { 0.45 } else { -0.45 } + jitter(0.05);
        let ring = |t: f64| {
            let (sin, cos) = (TAU * t).sin_cos();
            let (x, y) = (0.72 * side * cos, 0.72 * side * sin);
            Vector([middle[0] + x * lean.cos(), middle[1] + y, x * lean.sin()])
        };
        points.extend(tube(ring, 0.13 * side, (80, 14)));
    }
    kept(points, 71_454)
}

/// Threads over and under one another.
fn weave() -> PointSet<3> {
    let mut stream = Stream::new(4, Stage::new(1), 0);
    let side = 1.0 / 9.0;
    let mut points = Vec::new();
    for k in 0..20_u32 {
        let (number, is_weft) = (k / 2, k % 2 == 1);
        let middle = f64::from(number) * side + stream.range(-0.04 * side, 0.04 * side);
        let start = if (number % 2 == 0) == is_weft { 0.0 } else { 0.5 * TAU };
        let thread = |t: f64| {
            let x = 1.2 * t - 0.1;
            let z = 0.28 * side * (0.5 * TAU * x / side + start).cos();
            let y = middle + 0.02 * side * (7.0 * x + f64::from(k)).sin();
            if is_weft { Vector([y, x, z]) } else { Vector([x, y, z]) }
        };
        points.extend(tube(thread, 0.24 * side, (132, 22)));
    }
    kept(points, 43_592)
}

/// Loose pieces with five petals.
fn flowers() -> PointSet<3> {
    let mut stream = Stream::new(5, Stage::new(1), 0);
    let side = 1.0 / 8.0;
    let mut points = Vec::new();
    for k in 0..64_u32 {
        let row = k / 8;
        let mut jitter = |size: f64| stream.range(-size, size);
        let x = (f64::from(k % 8) + 0.5 + 0.5 * f64::from(row % 2)) * side + jitter(0.08 * side);
        let middle = Vector([x, (f64::from(row) + 0.5) * side + jitter(0.08 * side), jitter(0.02 * side)]);
        let (turn, size) = (jitter(0.5 * TAU), 0.4 * side * (1.0 + jitter(0.1)));
        let at = |u: f64, a: f64| {
            let r = size * (0.7 + 0.3 * (5.0 * (a - turn)).cos()) * (1.0 - u * u).max(0.0).sqrt();
            middle + Vector([r * a.cos(), r * a.sin(), 0.3 * size * u + 0.3 * r])
        };
        for _ in 0..600 {
            let (u, a) = (stream.range(-0.99, 0.99), stream.range(0.0, TAU));
            let (e, p) = (1e-4, at(u, a));
            let normal = (at(u, a + e) - p).cross(at(u + e, a) - p).unit_or_zero();
            points.push((p, normal));
        }
    }
    kept(points, 37_473)
}

/// A row of the table: a texture, and the side of a square that takes so many points.
struct Row {
    points: PointSet<3>,
    prepared: Prepared,
    side: f64,
}

impl Row {
    fn new(points: PointSet<3>, wanted: f64) -> Self {
        let prepared = Prepared::new(&points, None, &ReliefParams::default(), &Budget::default()).unwrap();
        let side = (wanted / points.len() as f64).sqrt();
        Self { points, prepared, side }
    }

    fn run(&self, prepared: &Prepared, times: f64) -> usize {
        let side = self.side * times.sqrt();
        let budget = Budget::new(Limits { output_elements: 10_000_000, ..Limits::default() });
        let request = ReliefRequest { budget, ..ReliefRequest::new(Ground::Plane([side, side])) };
        prepared.run(&request, &mut Unobserved).unwrap().points.len()
    }

    fn with(&self, params: &ReliefParams) -> Prepared {
        Prepared::new(&self.points, None, params, &Budget::default()).unwrap()
    }
}

static ROWS: [LazyLock<Row>; 4] = [
    LazyLock::new(|| Row::new(terrain(), 87_101.0)),
    LazyLock::new(|| Row::new(mail(), 197_282.0)),
    LazyLock::new(|| Row::new(weave(), 126_139.0)),
    LazyLock::new(|| Row::new(flowers(), 68_290.0)),
];
const NAMES: [&str; 4] = ["height field", "mail", "weave", "flowers"];

fn row(name: &str) -> &'static Row {
    &ROWS[NAMES.iter().position(|n| *n == name).unwrap()]
}

/// What is worked out once.
#[divan::bench(args = NAMES, sample_count = 5)]
fn prepare(bencher: divan::Bencher<'_, '_>, name: &str) {
    let row = row(name);
    bencher.bench(|| row.with(&ReliefParams::default()).points());
}

/// The rows of the table.
#[divan::bench(args = NAMES, sample_count = 5)]
fn whole(bencher: divan::Bencher<'_, '_>, name: &str) {
    let row = row(name);
    bencher.bench(|| row.run(&row.prepared, 1.0));
}

/// How time grows: so many times the mail of the table. With 15 it is the large mail of the paper.
#[divan::bench(args = [1, 4, 15], sample_count = 1)]
fn larger(bencher: divan::Bencher<'_, '_>, times: u32) {
    let row = row("mail");
    bencher.bench(|| row.run(&row.prepared, f64::from(times)));
}

/// The mail of the table with one step left out, or done another way.
#[divan::bench(args = ["bending", "agreement of pairs", "spreading", "search by transforms", "search by going through all places"], sample_count = 3)]
fn without(bencher: divan::Bencher<'_, '_>, step: &str) {
    let row = row("mail");
    let usual = ReliefParams::default();
    let prepared = row.with(&match step {
        "bending" => ReliefParams { pairs: 4, ..usual },
        "agreement of pairs" => ReliefParams { rounds: 0, ..usual },
        "spreading" => ReliefParams { relax: 0, ..usual },
        "search by transforms" => ReliefParams { search: Search::Fft, ..usual },
        _ => ReliefParams { search: Search::Exhaustive, ..usual },
    });
    bencher.bench(|| row.run(&prepared, 1.0));
}
