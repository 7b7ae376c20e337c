#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use arabesque_core::{
    Bounds, Budget, Class, Contents, Curve, Domain, Exemplar, Path, Request, Stage, Stream, Unobserved, Vector,
};

use super::Abreast;

const SIDE: f64 = 200.0;

/// Strokes in a frame; every fourth in a style of its own.
fn drawn(lines: &[Vec<Vector<2>>]) -> Exemplar<2> {
    let curve = |(k, line): (usize, &Vec<Vector<2>>)| {
        let style = usize::from(k % 4 == 0);
        Curve { path: Path::polyline(line), style, width: 1.0, colour: [0.0; 3] }
    };
    let curves = lines.iter().enumerate().map(curve).collect();
    let styles = ["thin", "thick"].map(|name| Class { name: name.into() }).to_vec();
    let contents = Contents { curves, styles, ..Contents::default() };
    Exemplar::with_curves("t", contents, page(SIDE, SIDE)).unwrap()
}

fn page(width: f64, height: f64) -> Bounds<2> {
    Bounds::new(Vector::ZERO, Vector::xy(width, height))
}

/// Contour lines that nowhere come nearer than three to one another, with this slope, cut by the frame.
fn contours(slope: f64, turn: impl Fn(Vector<2>) -> Vector<2>) -> Vec<Vec<Vector<2>>> {
    let mut stream = Stream::new(3, Stage::TEST, 0);
    let waves: Vec<[f64; 4]> = (0..4)
        .map(|_| [stream.range(0.02, 0.06), stream.range(-0.02, 0.02), stream.range(0.0, 6.0), stream.range(1.0, 2.0)])
        .collect();
    let height = |level: f64, x: f64| {
        level + slope * x + waves.iter().map(|[a, b, c, d]| d * (a * x + b * level + c).sin()).sum::<f64>()
    };
    let line = |k: i32| {
        let all = (0..=100).map(|n| Vector::xy(0.02 * SIDE * f64::from(n) * 0.5, 0.0));
        let all = all.map(|p| Vector::xy(p[0], height(10.0 * f64::from(k), p[0])));
        all.filter(|p| (-1.0..=SIDE + 1.0).contains(&p[1])).map(&turn).collect::<Vec<_>>()
    };
    (-30..60).map(line).filter(|line| line.len() > 3).collect()
}

fn filled(exemplar: &Exemplar<2>, domain: Domain<2>, seed: u64) -> Vec<(Vec<Vector<2>>, usize)> {
    let lines = Abreast::new(exemplar, &Budget::default()).unwrap().unwrap();
    let request = Request { seed, ..Request::new(domain) };
    let outcome = lines.fill(exemplar, &request, &mut Unobserved).unwrap().unwrap();
    outcome.curves.iter().map(|c| (c.path.flatten(0.05), exemplar.curves[c.source].style)).collect()
}

/// Where lines pass a place along x, from the lowest on, with their styles.
fn column(lines: &[(Vec<Vector<2>>, usize)], x: f64) -> Vec<(f64, usize)> {
    let mut passed: Vec<(f64, usize)> = Vec::new();
    for (line, style) in lines {
        let pairs = line.windows(2).filter(|w| (w[0][0] < x) != (w[1][0] < x));
        passed.extend(pairs.map(|w| (w[0][1] + (w[1][1] - w[0][1]) * (x - w[0][0]) / (w[1][0] - w[0][0]), *style)));
    }
    passed.sort_by(|a, b| a.0.total_cmp(&b.0));
    passed
}

#[test]
fn contour_lines_end_at_the_border_alone_and_keep_apart() {
    for slope in [0.0, 0.4] {
        let exemplar = drawn(&contours(slope, |p| p));
        for seed in 0..3 {
            let made = filled(&exemplar, Domain::Box(page(431.0, 327.0)), seed);
            let at_border = |p: Vector<2>| p[0].min(431.0 - p[0]).min(p[1]).min(327.0 - p[1]) < 0.1;
            assert!(made.iter().all(|(line, _)| at_border(line[0]) && at_border(*line.last().unwrap())), "{seed}");
            for k in 1..40 {
                let passed = column(&made, f64::from(k) * 10.7);
                assert!((28..=37).contains(&passed.len()), "{seed}: {} lines at {k}", passed.len());
                assert!(passed.windows(2).all(|w| w[1].0 - w[0].0 > 3.0), "{seed}: {passed:?}");
            }
        }
    }
}

#[test]
fn every_fourth_line_stays_the_fourth() {
    let exemplar = drawn(&contours(0.0, |p| p));
    for domain in [Domain::Box(page(300.0, 300.0)), Domain::Torus(page(300.0, 240.0))] {
        let passed = column(&filled(&exemplar, domain, 2), 150.0);
        let thick: Vec<usize> = passed.iter().enumerate().filter(|(_, p)| p.1 == 1).map(|(k, _)| k).collect();
        assert!(thick.len() >= 5 && thick.windows(2).all(|w| w[1] - w[0] == 4), "{thick:?}");
    }
}

#[test]
fn lines_close_up_on_a_tile_also_where_they_slant() {
    for slope in [0.0, 0.4] {
        let exemplar = drawn(&contours(slope, |p| p));
        let (width, height) = (263.0, 241.0);
        let made = filled(&exemplar, Domain::Torus(page(width, height)), 1);
        for (line, style) in &made {
            let end = *line.last().unwrap() - Vector::xy(width, 0.0);
            let meets = |(other, s): &&(Vec<Vector<2>>, usize)| {
                let apart = end - other[0];
                let around = apart[1] - (apart[1] / height).round() * height;
                s == style && apart[0].abs() < 1e-6 && around.abs() < 1e-6
            };
            assert_eq!(made.iter().filter(meets).count(), 1, "{slope}");
        }
    }
}

#[test]
fn upright_lines_are_found_and_turn_with_the_page() {
    let exemplar = drawn(&contours(0.0, |p| Vector::xy(p[1], p[0])));
    let made = filled(&exemplar, Domain::Box(page(250.0, 400.0)), 0);
    let turned: Vec<_> =
        made.into_iter().map(|(l, s)| (l.iter().map(|p| Vector::xy(p[1], p[0])).collect(), s)).collect();
    assert!((22..=29).contains(&column(&turned, 200.0).len()));
}

#[test]
fn lines_that_cross_end_or_are_straight_are_something_else() {
    let is_found = |lines: &[Vec<Vector<2>>]| Abreast::new(&drawn(lines), &Budget::default()).unwrap().is_some();
    let lines = contours(0.0, |p| p);
    assert!(is_found(&lines));
    let mut crossed = lines.clone();
    crossed.push(vec![Vector::xy(0.0, 20.0), Vector::xy(100.0, 90.0), Vector::xy(SIDE, 180.0)]);
    assert!(!is_found(&crossed));
    let mut short = lines.clone();
    short[8].truncate(50);
    assert!(!is_found(&short));
    let mut back = lines.clone();
    let beyond = back[8][50][1];
    back[8].insert(50, Vector::xy(40.0, beyond));
    assert!(!is_found(&back));
    let straight = |k: i32| (0..2).map(|n| Vector::xy(SIDE * f64::from(n), f64::from(k * k))).collect();
    assert!(!is_found(&(1..14).map(straight).collect::<Vec<_>>()));
}
