//! Time of the final clearance check, with and without something to mend. One thread, unless `RAYON_NUM_THREADS` says
//! otherwise.

use arabesque_core::{
    Bounds, Class, Domain, Element, Exemplar, Matrix, Outline, Placement, Request, Role, Similarity, Stage, Stream,
    Vector,
};
use arabesque_patterns::stages::Clearing;
use divan::Bencher;

/// Corners of an outline.
const CORNERS: u32 = 24;

/// Farthest that an element lies from its grid node.
const WOBBLE: f64 = 0.4;

/// Elements of the output.
const SIZES: [usize; 3] = [1_000, 10_000, 100_000];

fn leaf(centre: Vector<2>, size: f64) -> Outline<2> {
    let corner = |k: u32| {
        let turn = f64::from(k) / f64::from(CORNERS) * std::f64::consts::TAU;
        centre + Vector::xy(size * turn.cos(), 0.4 * size * turn.sin())
    };
    Outline { rings: vec![(0..CORNERS).map(corner).collect()] }
}

/// Sixteen leaves in two sizes, well apart.
fn exemplar() -> Exemplar<2> {
    let element = |k: usize| {
        let centre = Vector::xy((k % 4) as f64 + 0.5, (k / 4) as f64 + 0.5) * 5.0;
        let outline = leaf(centre, 1.0 + 0.8 * (k % 2) as f64);
        Element {
            class: k % 2,
            centre,
            pose: Similarity::identity(),
            outline,
            colour: [0.0; 3],
            lean: [Vector::ZERO; 3],
            role: Role::Source,
        }
    };
    let classes = ["small", "large"].map(|name| Class { name: name.into() });
    let window = Bounds::new(Vector::ZERO, Vector::splat(20.0));
    Exemplar::new("benchmark", (0..16).map(element).collect(), classes.into(), window).expect("the exemplar is valid")
}

/// `n` leaves near the nodes of a grid with `spacing`.
fn scattered(exemplar: &Exemplar<2>, n: usize, spacing: f64) -> Vec<Placement<2>> {
    let mut stream = Stream::new(9, Stage::TEST, 0);
    let columns = (n as f64).sqrt().ceil() as usize;
    let mut place = |k: usize| {
        let node = Vector::xy((k % columns) as f64 + 0.5, (k / columns) as f64 + 0.5) * spacing;
        let target = node + Vector::xy(stream.range(-WOBBLE, WOBBLE), stream.range(-WOBBLE, WOBBLE));
        let source = stream.below(exemplar.elements.len());
        let turn = Matrix::rotation(stream.range(-0.3, 0.3));
        let transform = Similarity::about(exemplar.elements[source].centre, target, turn, 1.0);
        Placement { source, transform, control: Vec::new(), frozen: None }
    };
    (0..n).map(&mut place).collect()
}

fn mend(bencher: Bencher, n: usize, spacing: f64) {
    let exemplar = exemplar();
    let placements = scattered(&exemplar, n, spacing);
    let page = Bounds::new(Vector::ZERO, Vector::splat(spacing * (n as f64).sqrt().ceil()));
    let request = Request::new(Domain::Torus(page));
    let measured = Clearing::new(&exemplar);
    bencher
        .with_inputs(|| placements.clone())
        .bench_local_values(|mut placements| measured.repair(&request, &mut placements));
}

/// Few elements overlap.
#[divan::bench(args = SIZES, sample_count = 10)]
fn loose(bencher: Bencher, n: usize) {
    mend(bencher, n, 4.0);
}

/// Every third element overlaps another.
#[divan::bench(args = SIZES, sample_count = 5)]
fn crowded(bencher: Bencher, n: usize) {
    mend(bencher, n, 3.2);
}

fn main() {
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");
    }
    divan::main();
}
