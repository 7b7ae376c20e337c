//! Tiles, bricks, hexagons and other elements on lattices: each at its place, of its kind, from any seed, without drift.

use arabesque_core::{Bounds, Domain, Exemplar, Outline, Request, Vector};
use arabesque_patterns::repeat::Explains;

use crate::{
    drawing::{Motif, Pattern, exemplar, noise, polygon, rectangle, xy},
    measure::{TOLERANCE, assert_same, centres, expected, page, prepared, run},
};

fn motif(ring: Vec<Vector<2>>, class: usize) -> Motif {
    Motif { ring, class }
}

/// A chessboard of squares of side 1.
pub(crate) fn chess() -> Pattern {
    let square = |x: f64, y: f64, class| motif(rectangle(xy(x, y), xy(x + 1.0, y + 1.0)), class);
    Pattern::of_motifs([xy(1.0, 1.0), xy(1.0, -1.0)], vec![square(0.0, 0.0, 0), square(1.0, 0.0, 1)])
}

/// Blocks of a quilt, each of four triangles in two colours that meet in its middle.
fn quilt() -> Pattern {
    let corners = rectangle(xy(0.0, 0.0), xy(1.0, 1.0));
    let triangle = |k: usize| motif(vec![corners[k], corners[(k + 1) % 4], xy(0.5, 0.5)], k % 2);
    Pattern::of_motifs([xy(1.0, 0.0), xy(0.0, 1.0)], (0..4).map(triangle).collect())
}

/// Hexagons that touch, in three colours.
fn hexagons() -> Pattern {
    let half = 0.75_f64.sqrt();
    let (a, b) = (xy(1.0, 0.0), xy(0.5, half));
    let hexagon = |k: usize| motif(polygon(a * k as f64, 0.5 / half, 6, std::f64::consts::FRAC_PI_6), k);
    Pattern::of_motifs([a + b, b * 2.0 - a], (0..3).map(hexagon).collect())
}

/// Bricks in bond.
pub(crate) fn bricks() -> Pattern {
    Pattern::of_motifs([xy(2.0, 0.0), xy(1.0, 0.8)], vec![motif(rectangle(xy(0.1, 0.1), xy(1.9, 0.7)), 0)])
}

/// Scales that overlap: each a disc and a ring within it.
fn scales() -> Pattern {
    let discs = vec![motif(polygon(xy(0.0, 0.0), 1.0, 40, 0.0), 0), motif(polygon(xy(0.0, 0.0), 0.6, 40, 0.0), 1)];
    Pattern::of_motifs([xy(2.0, 0.0), xy(1.0, 0.5)], discs)
}

/// Dots in half drop, two colours by turns.
fn half_drop() -> Pattern {
    let dot = |x: f64, y: f64, class| motif(polygon(xy(x, y), 0.3, 24, 0.0), class);
    Pattern::of_motifs([xy(2.0, 0.0), xy(0.0, 2.6)], vec![dot(0.0, 0.0, 0), dot(1.0, 1.3, 0), dot(1.0, 0.2, 1)])
}

/// Width and height of frames in periods along the axes.
const PERIODS: [[f64; 2]; 5] = [[2.4, 2.1], [4.3, 2.6], [3.1, 2.9], [2.7, 4.1], [1.9, 2.3]];

/// The shortest period of a pattern along an axis.
fn period(pattern: &Pattern, axis: usize) -> f64 {
    let nodes = (-6..=6).flat_map(|i| (-6..=6).map(move |j| [i, j]));
    let along = nodes.map(|node| pattern.at(node)).filter(|v| v[1 - axis].abs() < 1e-6 * pattern.shorter());
    along.map(|v| v[axis]).filter(|l| *l > 1e-6 * pattern.shorter()).fold(f64::INFINITY, f64::min)
}

/// A frame of an odd size with its corner somewhere.
pub(crate) fn frame(pattern: &Pattern, k: usize) -> Bounds<2> {
    let size = xy(period(pattern, 0), period(pattern, 1)).zip(Vector(PERIODS[k % 5]), |a, b| a * b);
    let corner = xy(-0.31, 0.47) * pattern.shorter();
    Bounds::new(corner, corner + size)
}

fn check(name: &str, pattern: &Pattern, k: usize, periods: f64) {
    let window = frame(pattern, k);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, name);
    let unit = pattern.shorter();
    let page = page(periods * unit, 0.4 * periods * unit);
    let wanted = expected(pattern, page.min - window.min, &page);
    for seed in 0..5 {
        let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
        let found = centres(&exemplar, &outcome);
        assert_same(&found, &wanted, TOLERANCE * unit, |p| page.contains(p), &format!("{name}, seed {seed}"));
        assert!(outcome.warnings.is_empty(), "{name}: {:?}", outcome.warnings);
    }
}

#[test]
fn ordinary_tilings_are_continued_exactly() {
    let all = [
        ("chess", chess()),
        ("quilt", quilt()),
        ("hexagons", hexagons()),
        ("bricks", bricks()),
        ("scales", scales()),
        ("half drop", half_drop()),
    ];
    for (k, (name, pattern)) in all.into_iter().enumerate() {
        for (n, scale) in [0.5, 20.0, 500.0].into_iter().enumerate() {
            // What is larger than a cell takes a larger frame to be seen whole.
            let k = if name == "scales" { 3 } else { k + n };
            check(name, &pattern.scaled(scale), k, 13.7);
        }
    }
}

#[test]
fn a_hundred_cells_do_not_drift() {
    check("chess", &chess().scaled(31.0), 1, 110.0);
    check("bricks", &bricks().scaled(0.7), 3, 110.0);
}

/// Rows of dots, each a little off, as a hand draws them.
pub(crate) fn drawn_by_hand(jitter: f64, window: &Bounds<2>) -> Vec<(arabesque_core::Outline<2>, usize)> {
    let mut dots = Vec::new();
    for (i, j) in (-2..40).flat_map(|i| (-2..40).map(move |j| (i, j))) {
        let off = xy(noise(i, j, 1), noise(i, j, 2)) * (jitter * 1.2);
        let place = xy(i as f64 + 0.5, j as f64 + 0.5) * 10.0 + off * 10.0;
        let ring = polygon(place, 2.5 + 0.2 * noise(i, j, 3), 20, 0.0);
        let outline = arabesque_core::Outline { rings: vec![ring] };
        if outline.bounds().intersects(window) {
            dots.push((outline, 0));
        }
    }
    dots
}

#[test]
fn rows_drawn_by_hand_stay_rows_and_stay_drawn_by_hand() {
    let window = Bounds::new(Vector::ZERO, xy(83.0, 71.0));
    for jitter in [0.01, 0.05] {
        let exemplar = exemplar(&drawn_by_hand(jitter, &window), &[], window);
        let prepared = prepared(&exemplar, "rows");
        let repeat = prepared.repeat().unwrap();
        assert!((repeat.lattice.cell() - 100.0).abs() < 3.0, "{:?}", repeat.lattice);
        let page = page(240.0, 160.0);
        for seed in 0..5 {
            let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
            let found = centres(&exemplar, &outcome);
            let nodes: Vec<_> = (-1..26).flat_map(|i| (-1..18).map(move |j| (i, j))).collect();
            let lattice = repeat.lattice.vectors;
            // The rows follow the vectors that were found; where the first of them is, the hand has decided.
            let start = found[0].0;
            let at = |(i, j): (i64, i64)| start + lattice[0] * i as f64 + lattice[1] * j as f64;
            let wanted: Vec<_> = nodes.iter().map(|&(i, j)| (at((i - 2, j - 2)), 0)).collect();
            let slack = (0.02 + 3.5 * jitter) * 10.0;
            let inner = page.grown(-10.0);
            let name = format!("rows with jitter {jitter}, seed {seed}");
            assert_same(&found, &wanted, slack, |p| inner.contains(p), &name);
            let off: f64 = found.iter().map(|(p, _)| nearest(*p, &wanted)).sum::<f64>() / found.len() as f64;
            assert!(off > 0.2 * jitter * 10.0, "{name}: the hand is gone, {off}");
        }
    }
}

fn nearest(p: Vector<2>, of: &[(Vector<2>, usize)]) -> f64 {
    of.iter().map(|(q, _)| (*q - p).norm()).fold(f64::INFINITY, f64::min)
}

#[test]
fn cells_at_random_stay_on_their_lattice() {
    // Truchet's tile, one half black, turned at random.
    let window = Bounds::new(xy(0.3, 0.2), xy(6.9, 5.6));
    let mut tiles = Vec::new();
    for (i, j) in (-1..9).flat_map(|i| (-1..8).map(move |j| (i, j))) {
        let corners = rectangle(xy(i as f64, j as f64), xy(i as f64 + 1.0, j as f64 + 1.0));
        let turn = ((noise(i, j, 5) + 1.0) * 2.0) as usize % 4;
        let ring = vec![corners[turn], corners[(turn + 1) % 4], corners[(turn + 2) % 4]];
        tiles.push((arabesque_core::Outline { rings: vec![ring] }, 0));
    }
    let exemplar = exemplar(&tiles, &[], window);
    let prepared = prepared(&exemplar, "Truchet");
    assert!((prepared.repeat().unwrap().lattice.cell() - 1.0).abs() < 1e-6);
    let page = page(14.0, 9.0);
    for seed in 0..5 {
        let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
        // Every tile has its own square, and every square its tile.
        let boxes = outcome.placements.iter().map(|p| {
            let outline = exemplar.elements[p.source].outline.transformed(&p.transform);
            (outline.bounds().centre(), 0)
        });
        let found: Vec<_> = boxes.collect();
        let centre = |i: i64, j: i64| xy(i as f64 + 0.5 - 0.3, j as f64 + 0.5 - 0.2);
        let wanted: Vec<_> = (-1..16).flat_map(|i| (-1..11).map(move |j| (centre(i, j), 0))).collect();
        assert_same(&found, &wanted, TOLERANCE, |p| page.contains(p), &format!("Truchet, seed {seed}"));
        let turned: std::collections::BTreeSet<_> = outcome.placements.iter().map(|p| p.source).collect();
        assert!(turned.len() > 4, "{turned:?}");
    }
}

/// Planks at the places of a grid of 20 by 20, in four colours at random, each lying or standing and off its place by `hand`.
fn planks(hand: f64, is_lying: impl Fn(i64, i64) -> bool) -> (Exemplar<2>, Bounds<2>) {
    let window = Bounds::new(Vector::ZERO, xy(170.0, 150.0));
    let plank = |(i, j): (i64, i64)| {
        let half = if is_lying(i, j) { xy(9.0, 4.0) } else { xy(4.0, 9.0) };
        let at = xy(20.0 * i as f64 + 5.0, 20.0 * j as f64 + 5.0) + xy(noise(i, j, 3), noise(i, j, 4)) * hand;
        (Outline { rings: vec![rectangle(at - half, at + half)] }, ((noise(i, j, 8) + 1.0) * 1.999) as usize)
    };
    let all: Vec<_> = (-1..10).flat_map(|i| (-1..9).map(move |j| (i, j))).map(plank).collect();
    let seen: Vec<_> = all.into_iter().filter(|(outline, _)| outline.bounds().intersects(&window)).collect();
    (exemplar(&seen, &[], window), window)
}

#[test]
fn planks_laid_two_ways_keep_to_them_in_any_colours() {
    for hand in [0.0, 0.6] {
        let (exemplar, window) = planks(hand, |i, j| (i + j) % 2 == 0);
        let prepared = prepared(&exemplar, "planks");
        let repeat = prepared.repeat().unwrap();
        assert_eq!(repeat.explains, Explains::Places, "{hand}");
        assert!((repeat.lattice.cell() / 800.0 - 1.0).abs() < 0.02, "{hand}: {:?}", repeat.lattice);
        let page = page(300.0, 260.0);
        for seed in 0..3 {
            let outcome = run(&prepared, &Request { seed, ..Request::new(Domain::Box(page)) });
            for placement in &outcome.placements {
                let element = &exemplar.elements[placement.source];
                let size = element.outline.bounds().size();
                let at = placement.transform.apply(element.centre) + window.min;
                let [i, j] = [0, 1].map(|k| ((at[k] - page.min[k] - 5.0) / 20.0).round() as i64);
                assert_eq!(size[0] > size[1], (i + j) % 2 == 0, "{hand}, seed {seed}: {at:?}");
            }
        }
    }
}

#[test]
fn planks_turned_at_random_keep_to_places_alone() {
    let (exemplar, _) = planks(0.0, |i, j| noise(i, j, 5) > 0.0);
    let prepared = prepared(&exemplar, "planks");
    let repeat = prepared.repeat().unwrap();
    assert_eq!(repeat.explains, Explains::Places);
    assert!((repeat.lattice.cell() / 400.0 - 1.0).abs() < 1e-6, "{:?}", repeat.lattice);
}
