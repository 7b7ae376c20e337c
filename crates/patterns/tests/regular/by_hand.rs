//! Rows by hand: lattices of all five Bravais types with jitter, with things missing and of several kinds, are found with the
//! right cell; places that keep to no lattice are not.

use arabesque_core::{Bounds, Budget, Exemplar, Outline, Vector};
use arabesque_patterns::{
    regular,
    repeat::{Explains, Extent, Repeat},
};

use crate::{
    drawing::{exemplar, noise, polygon, xy},
    random::agree,
};

/// Numbers in [0, 1) that look random, the same each time.
pub(crate) struct Numbers(u64, i64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed, 0)
    }

    pub(crate) fn unit(&mut self) -> f64 {
        self.1 += 1;
        (0.5 * (noise(self.1, 77, self.0) + 1.0)).clamp(0.0, 0.999_999)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// A vector of which the length is 1 in root mean square, in all directions alike.
    fn normal(&mut self) -> Vector<2> {
        let length = (-(1.0 - self.unit()).ln()).sqrt();
        let angle = std::f64::consts::TAU * self.unit();
        xy(angle.cos(), angle.sin()) * length
    }
}

const TYPES: [&str; 5] = ["oblique", "rectangular", "centred", "square", "hexagonal"];

fn vectors(kind: usize, numbers: &mut Numbers) -> [Vector<2>; 2] {
    let ratio = numbers.between(1.15, 2.0);
    let tau = std::f64::consts::TAU;
    let (angle, ratio) = match kind {
        0 => (numbers.between(0.19, 0.22) * tau, ratio),
        1 => (0.25 * tau, ratio),
        2 => ((0.5 / ratio).acos(), ratio),
        3 => (0.25 * tau, 1.0),
        _ => (tau / 6.0, 1.0),
    };
    let (start, scale) = (numbers.between(0.0, tau), numbers.between(0.5, 50.0));
    let at = |angle: f64, length: f64| xy(angle.cos(), angle.sin()) * (length * scale);
    [at(start, 1.0), at(start + angle, ratio)]
}

/// How kinds lie at the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Dealt {
    One,
    InTurn,
    AtRandom,
}

/// Rows by hand: what they look like, the lattice of the places, and that of the kinds.
fn rows(bravais: usize, dealt: Dealt, seed: u64) -> (Exemplar<2>, [[Vector<2>; 2]; 2]) {
    let mut numbers = Numbers::new(seed * 131 + bravais as u64);
    let [a, b] = vectors(bravais, &mut numbers);
    let (kinds, jitter) = (2 + numbers.below(3), numbers.between(0.0, 0.08) * a.norm().min(b.norm()));
    let count = numbers.between(30.0, 300.0) * if dealt == Dealt::InTurn { 0.3 * kinds as f64 + 0.7 } else { 1.0 };
    let side = (count.clamp(30.0, 300.0) * a.cross(b).abs()).sqrt();
    let shape = numbers.between(0.75, 1.3);
    let window = Bounds::new(Vector::ZERO, xy(side * shape, side / shape));
    let start = window.centre() + a * numbers.unit() + b * numbers.unit();
    let reach = (4.0 * side / a.norm().min(b.norm())) as i64;
    let slant = numbers.below(kinds) as i64;
    let mut outlines = Vec::new();
    for (i, j) in (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| (i, j))) {
        let place = start + a * i as f64 + b * j as f64;
        if !window.grown(a.norm()).contains(place) {
            continue;
        }
        let place = place + numbers.normal() * jitter;
        let kind = match dealt {
            Dealt::One => 0,
            Dealt::InTurn => (i + slant * j).rem_euclid(kinds as i64) as usize,
            Dealt::AtRandom => numbers.below(kinds),
        };
        let is_missing = numbers.unit() < 0.05;
        let ring = polygon(place, 0.25 * a.norm().min(b.norm()), 5 + 3 * kind, 0.3);
        let outline = Outline { rings: vec![ring] };
        if !is_missing && outline.bounds().intersects(&window) {
            outlines.push((outline, kind));
        }
    }
    let of_kinds = match dealt {
        Dealt::InTurn => [a * kinds as f64, b - a * slant as f64],
        Dealt::One | Dealt::AtRandom => [a, b],
    };
    (exemplar(&outlines, &[], window), [[a, b], of_kinds])
}

fn is_right(found: Option<&Repeat>, dealt: Dealt, [a, b]: [Vector<2>; 2]) -> bool {
    let explains = if dealt == Dealt::AtRandom { Explains::Places } else { Explains::Everything };
    let wanted = arabesque_patterns::repeat::Lattice::new(a, b).unwrap();
    found.is_some_and(|found| found.explains == explains && agree(&found.lattice, &wanted, 0.03))
}

#[test]
fn rows_by_hand_are_found_with_the_right_cell() {
    let (mut tried, mut wrong) = (0, Vec::new());
    for (bravais, name) in TYPES.iter().enumerate() {
        for dealt in [Dealt::One, Dealt::InTurn, Dealt::AtRandom] {
            for seed in 0..SEEDS {
                let (exemplar, [_, of_kinds]) = rows(bravais, dealt, seed);
                let found = repeat_of(&exemplar);
                tried += 1;
                if !is_right(found.as_ref(), dealt, of_kinds) {
                    let found = found.map(|f| (f.lattice.vectors, f.explains, f.jitter));
                    let count = exemplar.elements.len();
                    wrong.push(format!("{name} {dealt:?} {seed}: {count} things, {found:?} for {of_kinds:?}"));
                }
            }
        }
    }
    assert!(wrong.len() * 50 <= tried, "{} of {tried}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Drawings of each sort.
const SEEDS: u64 = 20;

/// Polygons of so many corners at the places of a grid of 10 x 10, from (10, 10).
fn grid(columns: i64, rows: i64, window: Bounds<2>, class: impl Fn(i64, i64) -> usize) -> Exemplar<2> {
    let all = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
    let dot = |(i, j): (i64, i64)| {
        let place = xy(10.0 * i as f64 + 10.0, 10.0 * j as f64 + 10.0);
        (Outline { rings: vec![polygon(place, 3.0, 5, 0.3)] }, class(i, j))
    };
    exemplar(&all.map(dot).collect::<Vec<_>>(), &[], window)
}

fn repeat_of(exemplar: &Exemplar<2>) -> Option<Repeat> {
    regular(exemplar, &Budget::default()).unwrap().map(|regular| regular.repeat().clone())
}

fn repeat(exemplar: &Exemplar<2>) -> Repeat {
    repeat_of(exemplar).expect("a repeat")
}

#[test]
fn one_odd_dot_is_no_part_of_the_repeat_and_those_that_come_back_are() {
    let window = Bounds::new(Vector::ZERO, xy(80.0, 70.0));
    let chequer = |i: i64, j: i64| ((i + j) % 2) as usize;
    let found = repeat(&grid(7, 6, window, |i, j| if (i, j) == (3, 2) { 2 } else { chequer(i, j) }));
    assert_eq!(found.explains, Explains::Everything);
    assert!((found.lattice.cell() - 200.0).abs() < 1e-6 && found.share < 1.0, "{found:?}");
    let window = Bounds::new(Vector::ZERO, xy(90.0, 70.0));
    let found = repeat(&grid(8, 6, window, |i, j| if (i % 4, j % 4) == (1, 1) { 2 } else { chequer(i, j) }));
    assert!((found.lattice.cell() - 1600.0).abs() < 1e-6, "{found:?}");
}

#[test]
fn rows_with_a_margin_go_on_and_two_rows_are_a_frieze() {
    let window = Bounds::new(xy(-20.0, 0.0), xy(120.0, 130.0));
    for (rows, extent) in [(8, Extent::Plane), (3, Extent::Plane), (2, Extent::Frieze), (1, Extent::Frieze)] {
        let found = repeat(&grid(10, rows, window, |_, _| 0));
        assert_eq!(found.extent, extent, "{rows} rows");
    }
}

/// Places that keep to no lattice.
#[test]
fn dots_that_crowd_on_a_line_are_a_frieze_with_their_own_step() {
    let (step, window) = (0.05, Bounds::new(Vector::ZERO, xy(100.0, 10.0)));
    let dot = |k: i64| (Outline { rings: vec![polygon(xy((k as f64 + 0.5) * step, 5.0), 0.02, 5, 0.3)] }, 0);
    let found = repeat(&exemplar(&(0..2000).map(dot).collect::<Vec<_>>(), &[], window));
    let along = found.lattice.vectors.into_iter().map(|v| v.norm()).fold(f64::INFINITY, f64::min);
    assert!((along - step).abs() < 1e-3 * step, "{along}");
}

fn scatter(kind: usize, seed: u64) -> Exemplar<2> {
    let mut numbers = Numbers::new(seed * 977 + kind as u64);
    let window = Bounds::new(Vector::ZERO, xy(100.0, numbers.between(60.0, 110.0)));
    let count = numbers.between(20.0, 300.0);
    let spacing = (window.measure() / count).sqrt();
    let mut places: Vec<Vector<2>> = Vec::new();
    let centres: Vec<_> = (0..6).map(|_| xy(100.0 * numbers.unit(), window.max[1] * numbers.unit())).collect();
    if kind == 3 {
        // A grid of which each place is moved by up to a quarter of the spacing, and more, along both axes.
        let far = numbers.between(0.25, 0.5) * spacing;
        for (i, j) in (0..40).flat_map(|i| (0..40).map(move |j| (i, j))) {
            let off = xy(numbers.between(-far, far), numbers.between(-far, far));
            places.push(xy(i as f64 + 0.5, j as f64 + 0.5) * spacing + off);
        }
    }
    let apart = if kind == 1 { numbers.between(0.6, 0.8) * spacing } else { 0.0 };
    for _ in 0..30 * count as usize {
        let place = match kind {
            2 => centres[numbers.below(6)] + numbers.normal() * 15.0,
            _ => xy(100.0 * numbers.unit(), window.max[1] * numbers.unit()),
        };
        if kind != 3 && places.len() < count as usize && places.iter().all(|q| (*q - place).norm() >= apart) {
            places.push(place);
        }
    }
    let kinds = 1 + numbers.below(3);
    let outline = |p: &Vector<2>| Outline { rings: vec![polygon(*p, 0.2 * spacing, 12, 0.0)] };
    let outlines: Vec<_> = places.iter().map(|p| (outline(p), numbers.below(kinds))).collect();
    let shown: Vec<_> = outlines.into_iter().filter(|(o, _)| o.bounds().intersects(&window)).collect();
    exemplar(&shown, &[], window)
}

#[test]
fn scatter_keeps_to_no_rows() {
    let (mut tried, mut wrong) = (0, Vec::new());
    for (kind, name) in ["uniform", "blue noise", "clustered", "a shaken grid"].iter().enumerate() {
        for seed in 0..6 * SEEDS {
            let exemplar = scatter(kind, seed);
            tried += 1;
            if let Some(found) = repeat_of(&exemplar) {
                wrong.push(format!("{name} {seed}: {} things, {found:?}", exemplar.elements.len()));
            }
        }
    }
    assert!(wrong.len() * 100 < tried, "{} of {tried}:\n{}", wrong.len(), wrong.join("\n"));
}
