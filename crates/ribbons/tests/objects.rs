//! Strips of separate objects: whole, apart, with the gaps of the exemplar, round corners and in closed curves.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod curves;

use arabesque_core::{Bounds, Budget, Error, Image, Path, Unobserved, Vector};
use arabesque_ribbons::{
    Canvas, Mask, Prepared, Ribbon, RibbonOutcome, RibbonParams, RibbonRequest, StripExemplar, Width, render,
};
use curves::{polyline, ring, square};

/// Widths of the objects, and gaps between them, in pixels.
const WIDTHS: [usize; 6] = [12, 20, 28, 12, 28, 20];
const GAPS: [usize; 5] = [8, 14, 10, 12, 8];
const HEIGHT: usize = 40;

/// Blocks of ink in the middle half of the strip, each of a colour of its own.
fn blocks(widths: &[usize], gaps: &[usize]) -> StripExemplar {
    let width = widths.iter().chain(gaps).sum::<usize>() + 10;
    let mut image = Image::transparent(width, HEIGHT);
    let mut x = 5;
    for (k, &w) in widths.iter().enumerate() {
        for column in x..x + w {
            for y in 10..30 {
                image.pixels[y * width + column] = [40 * k as u8, 90, 200, 255];
            }
        }
        x += w + gaps.get(k).copied().unwrap_or(0);
    }
    StripExemplar::new(image)
}

fn request(path: Path<2>, seed: u64) -> RibbonRequest<2> {
    RibbonRequest { seed, ..RibbonRequest::new(vec![("curve".into(), path)]) }
}

fn run(exemplar: &StripExemplar, params: &RibbonParams, request: &RibbonRequest<2>) -> RibbonOutcome<2> {
    let prepared = Prepared::new(vec![exemplar.clone()], params.clone(), &Budget::default()).unwrap();
    prepared.run(request, &mut Unobserved).unwrap()
}

fn laid(exemplar: &StripExemplar, path: &Path<2>, seed: u64) -> Ribbon<2> {
    let outcome = run(exemplar, &RibbonParams::default(), &request(path.clone(), seed));
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    outcome.ribbons[0].clone()
}

/// The areas of connected ink in a picture, in pixels.
fn areas(image: &Image) -> Vec<usize> {
    let mut seen: Vec<bool> = image.pixels.iter().map(|p| p[3] < 128).collect();
    let mut areas = Vec::new();
    for start in 0..seen.len() {
        if seen[start] {
            continue;
        }
        let (mut area, mut open) = (0, vec![start]);
        seen[start] = true;
        while let Some(k) = open.pop() {
            area += 1;
            let (x, y) = (k % image.width, k / image.width);
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, 1), (-1, 1), (1, -1)] {
                let (Some(x), Some(y)) = (x.checked_add_signed(dx), y.checked_add_signed(dy)) else { continue };
                if x < image.width && y < image.height && !seen[y * image.width + x] {
                    seen[y * image.width + x] = true;
                    open.push(y * image.width + x);
                }
            }
        }
        areas.push(area);
    }
    areas
}

fn picture(exemplar: &StripExemplar, ribbon: &Ribbon<2>, size: usize) -> Image {
    let canvas = Canvas { origin: Vector::ZERO, width: 2 * size, height: 2 * size, pixels_per_unit: 2.0 };
    render(std::slice::from_ref(ribbon), std::slice::from_ref(exemplar), None, &canvas, &Budget::default()).unwrap()
}

#[test]
fn objects_are_whole_and_apart_on_curves_of_every_kind() {
    let exemplar = blocks(&WIDTHS, &GAPS);
    let curves = [
        ("straight", polyline(&[(20.0, 60.0), (330.0, 60.0)])),
        ("corner", polyline(&[(20.0, 40.0), (200.0, 40.0), (80.0, 300.0)])),
        ("reversal", polyline(&[(20.0, 40.0), (300.0, 60.0), (40.0, 120.0)])),
        ("ring", ring(170.0, 110.0)),
        ("small ring", ring(170.0, 50.0)),
        ("square", square(60.0, 280.0)),
    ];
    for (name, path) in curves {
        for seed in 0..5 {
            let ribbon = laid(&exemplar, &path, seed);
            let found = areas(&picture(&exemplar, &ribbon, 350));
            assert_eq!(found.len(), ribbon.pieces.len(), "{name}, seed {seed}: touching or cut");
            assert!(found.len() >= 4, "{name}, seed {seed}: {found:?}");
            for area in found {
                let whole = WIDTHS.iter().any(|w| (area as f64 / (4 * w * 20) as f64 - 1.0).abs() < 0.06);
                assert!(whole, "{name}, seed {seed}: {area}");
            }
        }
    }
}

/// The gaps along a straight or circular ribbon of rigid objects, from the ends of their ink.
fn gaps(ribbon: &Ribbon<2>, closed: bool, measure: impl Fn(Vector<2>, Vector<2>) -> f64) -> Vec<f64> {
    let ends: Vec<[Vector<2>; 2]> = ribbon
        .pieces
        .iter()
        .map(|piece| {
            let [from, to] = [0, 1].map(|k| piece.patch.texture[k][0]);
            // Half a pixel of room on both sides.
            [from + 0.5, to - 0.5].map(|x| piece.to_canvas(Vector::xy(x, 0.5 * HEIGHT as f64)))
        })
        .collect();
    let n = ends.len();
    (0..if closed { n } else { n - 1 }).map(|k| measure(ends[k][1], ends[(k + 1) % n][0])).collect()
}

#[test]
fn gaps_are_those_of_the_exemplar() {
    let exemplar = blocks(&WIDTHS, &GAPS);
    for seed in 0..5 {
        let ribbon = laid(&exemplar, &polyline(&[(20.0, 60.0), (620.0, 60.0)]), seed);
        let straight = gaps(&ribbon, false, |a, b| b[0] - a[0]);
        assert!(straight.iter().all(|gap| (7.99..=14.01).contains(gap)), "seed {seed}: {straight:?}");
        let varied = straight.iter().any(|gap| (gap - straight[0]).abs() > 1.0);
        assert!(varied, "seed {seed}: {straight:?}");
        // Within the curve, and at most as far from both ends as an object and a gap are long.
        let x = |k: usize| ribbon.pieces[k].patch.corners;
        assert!((20.0..62.0).contains(&(x(0)[0][0] + 0.5)), "{:?}", x(0));
        assert!((578.0..=620.0).contains(&(x(ribbon.pieces.len() - 1)[1][0] - 0.5)));

        let centre = Vector::xy(170.0, 170.0);
        let ribbon = laid(&exemplar, &ring(170.0, 120.0), seed);
        let round = gaps(&ribbon, true, |a, b| (a - centre).angle_to(b - centre) * 120.0);
        // The objects are straight, so that the inner corners of neighbours are nearer than their ends.
        assert!(round.iter().all(|gap| (7.9..=16.0).contains(gap)), "seed {seed}: {round:?}");
    }
}

#[test]
fn equal_gaps_stay_equal_and_a_closed_curve_shares_out_what_is_left() {
    let exemplar = blocks(&[20; 5], &[16; 4]);
    let open = laid(&exemplar, &polyline(&[(0.0, 60.0), (300.0, 60.0)]), 1);
    let straight = gaps(&open, false, |a, b| b[0] - a[0]);
    assert!(straight.len() == 7 && straight.iter().all(|gap| (gap - 16.0).abs() < 0.01), "{straight:?}");
    let centre = Vector::xy(170.0, 170.0);
    let closed = laid(&exemplar, &ring(170.0, 100.0), 1);
    let round = gaps(&closed, true, |a, b| (a - centre).angle_to(b - centre) * 100.0);
    let (least, most) = (round.iter().copied().fold(f64::MAX, f64::min), round.iter().copied().fold(0.0, f64::max));
    assert!(least > 15.5 && most - least < 0.5, "{round:?}");
}

#[test]
fn long_objects_bend_and_short_ones_stay_rigid() {
    let exemplar = blocks(&[120, 14, 100, 14], &[10, 10, 10]);
    let ribbon = laid(&exemplar, &ring(170.0, 110.0), 3);
    let found = areas(&picture(&exemplar, &ribbon, 350));
    assert!(ribbon.pieces.len() > 3 * found.len(), "{} {found:?}", ribbon.pieces.len());
    let like = |area: usize, w: f64| (area as f64 / (80.0 * w) - 1.0).abs() < 0.06;
    assert!(found.iter().all(|&a| like(a, 120.0) || like(a, 100.0) || like(a, 14.0)), "{found:?}");
    let rigid = ribbon.pieces.iter().filter(|p| (p.patch.texture[1][0] - p.patch.texture[0][0] - 15.0).abs() < 1e-9);
    assert_eq!(rigid.count(), found.iter().filter(|&&a| like(a, 14.0)).count());
}

fn refused(exemplar: &StripExemplar, params: RibbonParams, request: &RibbonRequest<2>) -> String {
    let prepared = Prepared::new(vec![exemplar.clone()], params, &Budget::default()).unwrap();
    let error = prepared.run(request, &mut Unobserved).unwrap_err();
    assert!(matches!(error, Error::NoResult { .. }), "{error}");
    error.to_string()
}

#[test]
fn a_curve_without_room_is_told() {
    let exemplar = blocks(&WIDTHS, &GAPS);
    let short = request(polyline(&[(0.0, 60.0), (9.0, 60.0)]), 0);
    let text = refused(&exemplar, RibbonParams::default(), &short);
    assert!(text.contains("curve stays empty") && text.contains("9 long") && text.contains("12"), "{text}");
    let narrow = RibbonParams { width: Width::Constant(10.0), ..RibbonParams::default() };
    let long = request(polyline(&[(0.0, 60.0), (300.0, 60.0)]), 0);
    assert!(refused(&exemplar, narrow, &long).contains("narrower than the objects"));
    let tight = request(ring(40.0, 8.0), 0);
    assert!(refused(&blocks(&[30; 3], &[10; 2]), RibbonParams::default(), &tight).contains("bent more tightly"));
    // Another curve that has room is still laid.
    let curves = vec![
        ("short".to_owned(), polyline(&[(0.0, 60.0), (9.0, 60.0)])),
        ("long".to_owned(), polyline(&[(0.0, 120.0), (300.0, 120.0)])),
    ];
    let outcome = run(&exemplar, &RibbonParams::default(), &RibbonRequest::new(curves));
    assert!(outcome.warnings.len() == 1 && outcome.warnings[0].message.starts_with("short stays empty"));
    assert!(outcome.ribbons[0].pieces.is_empty() && outcome.ribbons[1].pieces.len() > 5);
}

#[test]
fn objects_keep_off_what_is_to_be_avoided_and_off_other_curves() {
    let exemplar = blocks(&WIDTHS, &GAPS);
    let bounds = Bounds { min: Vector::ZERO, max: Vector::xy(400.0, 100.0) };
    let blocked = (0..400 * 100).map(|k| (180..220).contains(&(k % 400))).collect();
    let mask = Mask { bounds, width: 400, height: 100, blocked };
    let wanted = RibbonRequest { avoid: Some(mask), ..request(polyline(&[(10.0, 50.0), (390.0, 50.0)]), 2) };
    let ribbon = &run(&exemplar, &RibbonParams::default(), &wanted).ribbons[0];
    let clear = |x: [f64; 2]| x[1] <= 180.6 || x[0] >= 219.4;
    assert!(ribbon.pieces.iter().all(|p| clear([p.patch.corners[0][0], p.patch.corners[1][0]])));

    let cross = polyline(&[(20.0, 170.0), (320.0, 170.0)]);
    let other = polyline(&[(170.0, 20.0), (170.0, 320.0)]);
    let outcome =
        run(&exemplar, &RibbonParams::default(), &RibbonRequest::new(vec![("a".into(), cross), ("b".into(), other)]));
    let all = Ribbon {
        pieces: outcome.ribbons.iter().flat_map(|r| r.pieces.clone()).collect(),
        ..outcome.ribbons[0].clone()
    };
    assert_eq!(areas(&picture(&exemplar, &all, 350)).len(), all.pieces.len());
}

#[test]
fn ends_and_the_first_object_are_where_they_are_asked_for() {
    let exemplar = StripExemplar { start: Some(0..20), end: Some(137..175), ..blocks(&WIDTHS, &GAPS) };
    let ribbon = laid(&exemplar, &polyline(&[(0.0, 60.0), (400.0, 60.0)]), 0);
    let from = |k: usize| ribbon.pieces[k].patch.texture[0][0] + 0.5;
    let n = ribbon.pieces.len();
    assert_eq!((from(0), ribbon.pieces[0].patch.corners[0][0]), (5.0, -0.5));
    assert!((1..n).all(|k| from(k) != 5.0), "only at the start");
    let wanted = RibbonRequest { first: Some((60, 0)), ..request(polyline(&[(0.0, 60.0), (400.0, 60.0)]), 0) };
    let ribbon = &run(&blocks(&WIDTHS, &GAPS), &RibbonParams::default(), &wanted).ribbons[0];
    assert_eq!(ribbon.pieces[0].patch.texture[0][0] + 0.5, 59.0);
}
