//! Tiles of the size that the repeat suggests are periodic, and hold every cell as the drawing has it.

use arabesque_core::{Bounds, Budget, Domain, Matrix, Outline, Request, ScalarField, Vector};
use arabesque_patterns::{Prepared, repeat::Explains};

use crate::{
    drawing::{Motif, Pattern, exemplar, noise, polygon, rectangle, xy},
    elements::{bricks, chess, drawn_by_hand, frame},
    groups,
    measure::{TOLERANCE, assert_same, centres, hausdorff, prepared, run},
    strokes::plaid,
};

fn torus(size: [f64; 2]) -> (Domain<2>, Bounds<2>) {
    let bounds = Bounds::new(Vector::ZERO, Vector(size));
    (Domain::Torus(bounds), bounds)
}

fn suggested(prepared: &Prepared<2>, window: &Bounds<2>, turn: &Matrix<2>, scale: f64) -> [f64; 2] {
    prepared.repeat().unwrap().seamless_tile(window.size(), turn, scale).unwrap()
}

/// Two by two copies of what lies in a tile.
fn copies(of: &[(Vector<2>, usize)], size: [f64; 2]) -> Vec<(Vector<2>, usize)> {
    let shifts = [[0.0, 0.0], [size[0], 0.0], [0.0, size[1]], size];
    shifts.iter().flat_map(|s| of.iter().map(move |(p, class)| (*p + Vector(*s), *class))).collect()
}

fn check(name: &str, pattern: &Pattern, least: [f64; 2]) {
    let window = frame(pattern, 1);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, name);
    let size = suggested(&prepared, &window, &Matrix::identity(), 1.0);
    for k in 0..2 {
        assert!((size[k] / least[k] - 1.0).abs() < 1e-3, "{name}: {size:?} for {least:?}");
    }
    let (domain, _) = torus(size);
    let outcome = run(&prepared, &Request::new(domain));
    assert!(outcome.warnings.is_empty(), "{name}: {:?}", outcome.warnings);
    // Laid side by side, the tiles show the drawing.
    let big = Bounds::new(Vector::ZERO, Vector(size) * 2.0);
    let by = Vector::ZERO - window.min;
    let found = copies(&centres(&exemplar, &outcome), size);
    let wanted = crate::measure::expected(pattern, by, &big);
    let inner = big.grown(-0.02 * pattern.shorter());
    assert_same(&found, &wanted, TOLERANCE * pattern.shorter(), |p| inner.contains(p), name);
}

#[test]
fn the_smallest_tile_of_elements_is_seamless() {
    let half = 0.75_f64.sqrt();
    let hexagons = Pattern::of_motifs(
        [xy(10.0, 0.0), xy(5.0, 10.0 * half)],
        vec![Motif { ring: polygon(Vector::ZERO, 5.0, 6, 0.5), class: 0 }],
    );
    let oblong = Pattern::of_motifs(
        [xy(30.0, 0.0), xy(10.0, 9.0)],
        vec![Motif { ring: rectangle(xy(1.0, 1.0), xy(20.0, 7.0)), class: 0 }],
    );
    check("chess", &chess().scaled(12.0), [24.0, 24.0]);
    check("bricks", &bricks().scaled(20.0), [40.0, 32.0]);
    check("hexagons", &hexagons, [10.0, 20.0 * half]);
    check("thirds of a shift", &oblong, [30.0, 27.0]);
    check("p4g", &groups::of_elements("p4g").scaled(80.0), [80.0, 80.0]);
    check("cmm", &groups::of_elements("cmm").scaled(60.0), [60.0, 78.0]);
}

#[test]
fn strokes_meet_around_the_back_of_a_tile() {
    let pattern = plaid().scaled(25.0);
    let window = frame(&pattern, 3);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "plaid");
    let size = suggested(&prepared, &window, &Matrix::identity(), 1.0);
    assert!((size[0] - 25.0).abs() < 0.01 && (size[1] - 25.0).abs() < 0.01, "{size:?}");
    let (domain, _) = torus(size);
    let mut outcome = run(&prepared, &Request::new(domain));
    let single = outcome.curves.clone();
    let moved =
        |by: Vector<2>| single.iter().map(move |c| arabesque_core::Drawn { path: c.path.map(|p| p + by), ..c.clone() });
    outcome.curves = (-2..4)
        .flat_map(|i| (-2..4).map(move |j| xy(f64::from(i) * size[0], f64::from(j) * size[1])))
        .flat_map(moved)
        .collect();
    let inner = Bounds::new(Vector::ZERO, Vector(size) * 2.0);
    let off = hausdorff(&pattern, &exemplar, &outcome, Vector::ZERO - window.min, &inner);
    assert!(off <= TOLERANCE * 25.0, "{off}");
}

#[test]
fn tiles_follow_constant_turns_and_scales() {
    let pattern = bricks().scaled(20.0);
    let window = frame(&pattern, 0);
    let exemplar = pattern.exemplar(window);
    let prepared = prepared(&exemplar, "bricks");
    let turn = Matrix::rotation(std::f64::consts::FRAC_PI_2);
    let size = suggested(&prepared, &window, &turn, 1.5);
    assert!((size[0] - 48.0).abs() < 0.01 && (size[1] - 60.0).abs() < 0.01, "{size:?}");
    let (domain, bounds) = torus(size);
    let mut request = Request::new(domain);
    request.fields.orientation = Some(arabesque_core::OrientationField::Constant(turn));
    request.fields.scale = ScalarField::Constant(1.5);
    let outcome = run(&prepared, &request);
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    assert_eq!(outcome.placements.len(), 2);
    assert!(outcome.placements.iter().all(|p| (p.transform.scale - 1.5).abs() < 1e-9));
    let covered: f64 =
        outcome.placements.iter().map(|p| exemplar.elements[p.source].outline.transformed(&p.transform).area()).sum();
    // Bricks of 36 x 12 in cells of 40 x 16.
    assert!((covered / bounds.measure() - 36.0 * 12.0 / (40.0 * 16.0)).abs() < 1e-3, "{covered}");
}

#[test]
fn what_varies_takes_a_tile_of_many_cells() {
    let window = Bounds::new(Vector::ZERO, xy(83.0, 71.0));
    let by_hand = exemplar(&drawn_by_hand(0.04, &window), &[], window);
    let rows = prepared(&by_hand, "rows");
    let size = suggested(&rows, &window, &Matrix::identity(), 1.0);
    assert!((size[0] / 80.0 - 1.0).abs() < 0.04 && (size[1] / 70.0 - 1.0).abs() < 0.04, "{size:?}");
    let (domain, _) = torus(size);
    let outcome = run(&rows, &Request::new(domain));
    assert_eq!(outcome.placements.len(), 56);
    let mut dots = Vec::new();
    for (i, j) in (0..8).flat_map(|i| (0..7).map(move |j| (i, j))) {
        let ring = polygon(xy(i as f64 * 10.0 + 5.0, j as f64 * 10.0 + 5.0), 3.0, 20, 0.0);
        dots.push((Outline { rings: vec![ring] }, ((noise(i, j, 9) + 1.0) * 2.0) as usize));
    }
    let window = Bounds::new(Vector::ZERO, xy(80.0, 70.0));
    let colours = prepared(&exemplar(&dots, &[], window), "colours");
    assert_eq!(colours.repeat().unwrap().explains, Explains::Places);
    assert_eq!(suggested(&colours, &window, &Matrix::identity(), 1.0).map(f64::round), [80.0, 70.0]);
}

#[test]
fn tiles_that_do_not_suit_are_told_with_those_that_do() {
    let pattern = bricks().scaled(20.0);
    let exemplar = pattern.exemplar(frame(&pattern, 2));
    let prepared = prepared(&exemplar, "bricks");
    let told = |size: [f64; 2]| -> Vec<String> {
        let outcome = run(&prepared, &Request::new(torus(size).0));
        outcome.warnings.iter().map(|w| format!("{}; {}", w.message, w.advice)).collect()
    };
    assert!(told([80.0, 64.0]).is_empty());
    let stretched = told([82.0, 64.0]);
    assert!(stretched[0].contains("2.5 %") && stretched[0].contains("80x64"), "{stretched:?}");
    let unfit = told([60.0, 45.0]);
    assert!(unfit[0].contains("does not suit") && unfit[0].contains("smallest 40x32"), "{unfit:?}");
}

#[test]
fn any_number_of_threads_gives_the_same() {
    let window = Bounds::new(Vector::ZERO, xy(83.0, 71.0));
    let exemplar = exemplar(&drawn_by_hand(0.05, &window), &[], window);
    let made = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let prepared = Prepared::new(exemplar.clone(), &Default::default(), &Budget::default()).unwrap();
            format!("{:?}", run(&prepared, &Request { seed: 3, ..Request::new(torus([160.0, 140.0]).0) }))
        })
    });
    assert_eq!(made[0], made[1]);
    assert_eq!(made[1], made[2]);
}

#[test]
fn stripes_fill_a_tile_of_any_length() {
    let window = Bounds::new(Vector::ZERO, xy(70.0, 40.0));
    let at = |k: usize| 3.0 + 20.0 * (k / 2) as f64 + 7.0 * (k % 2) as f64;
    let lines: Vec<_> = (0..7).map(|k| (vec![xy(at(k), 0.0), xy(at(k), 40.0)], k % 2)).collect();
    let exemplar = exemplar(&[], &lines, window);
    let prepared = prepared(&exemplar, "stripes");
    for length in [20.0, 33.0, 40.0, 75.0] {
        let outcome = run(&prepared, &Request::new(torus([60.0, length]).0));
        let total: f64 = outcome.curves.iter().map(|c| c.path.bounds().size()[1]).sum();
        // Six lines, none shorter than the tile, and none much longer.
        assert_eq!(outcome.curves.len(), 6, "{length}");
        assert!(total >= 6.0 * length - 1e-6 && total <= 6.0 * (length + 20.0), "{length}: {total}");
    }
}
