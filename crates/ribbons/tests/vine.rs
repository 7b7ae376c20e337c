//! A stem that wanders over the width of its strip: it must go on from piece to piece, and where a closed curve closes.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod curves;

use arabesque_core::{Budget, Image, Unobserved, Vector};
use arabesque_ribbons::{Piece, Prepared, Ribbon, RibbonParams, RibbonRequest, StripExemplar};
use curves::{polyline, ring, square};

/// A stem 4 pixels thick that rises and falls `reach` pixels around the middle of a strip.
fn vine(width: usize, height: usize, period: f64, reach: f64) -> StripExemplar {
    let mut image = Image::transparent(width, height);
    for x in 0..width {
        let t = (x as f64 + 0.5) / period * std::f64::consts::TAU;
        // Not the same twice, as drawn by hand.
        let centre = 0.5 * height as f64 + reach * (t.sin() + 0.2 * (0.37 * t).sin());
        for y in 0..height {
            let alpha = (2.0 - (y as f64 + 0.5 - centre).abs() + 0.5).clamp(0.0, 1.0);
            image.pixels[y * width + x] = [60, 110, 40, (255.0 * alpha) as u8];
        }
    }
    StripExemplar::new(image)
}

/// Where the ink crosses a line from `top` to `bottom` as a piece shows it: the middle of its alpha, in user units from the top.
fn crossing(image: &Image, piece: &Piece<2>, [top, bottom]: [Vector<2>; 2]) -> f64 {
    let length = (bottom - top).norm();
    let n = (length * 8.0) as usize;
    let (mut sum, mut moment) = (0.0, 0.0);
    for k in 0..n {
        let share = (k as f64 + 0.5) / n as f64;
        let q = piece.bent(piece.to_exemplar(top + (bottom - top) * share));
        let alpha = alpha(image, q);
        sum += alpha;
        moment += alpha * share * length;
    }
    moment / sum
}

fn alpha(image: &Image, q: Vector<2>) -> f64 {
    let (x, y) = (q[0] - 0.5, q[1] - 0.5);
    let at = |x: f64, y: f64| {
        let inside = y >= 0.0 && y < image.height as f64;
        let column = x.clamp(0.0, image.width as f64 - 1.0) as usize;
        if inside { f64::from(image.pixel(column, y as usize)[3]) } else { 0.0 }
    };
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let row = |y: f64| at(x.floor(), y) * (1.0 - fx) + at(x.floor() + 1.0, y) * fx;
    row(y.floor()) * (1.0 - fy) + row(y.floor() + 1.0) * fy
}

/// The farthest that the stem jumps at a seam, in user units, with the seam.
fn worst(image: &Image, ribbon: &Ribbon<2>) -> (f64, usize) {
    let n = ribbon.pieces.len();
    let seams = if ribbon.closed { n } else { n - 1 };
    (0..seams)
        .map(|k| {
            let [a, b] = [&ribbon.pieces[k], &ribbon.pieces[(k + 1) % n]];
            let edge = [b.patch.corners[0], b.patch.corners[3]];
            let jump = (crossing(image, a, edge) - crossing(image, b, edge)).abs();
            (jump, k)
        })
        .fold((0.0, 0), |worst, jump| if jump.0 > worst.0 { jump } else { worst })
}

#[test]
fn the_stem_goes_on_at_every_seam() {
    let mut failed = Vec::new();
    for (width, height, period, reach) in [(160, 40, 50.0, 5.0), (140, 48, 64.0, 9.0)] {
        let exemplar = vine(width, height, period, reach);
        let prepared = Prepared::new(vec![exemplar.clone()], RibbonParams::default(), &Budget::default()).unwrap();
        let curves = [
            ("straight", polyline(&[(40.0, 60.0), (340.0, 60.0)])),
            ("bent", polyline(&[(40.0, 60.0), (180.0, 60.0), (300.0, 150.0)])),
            ("ring", ring(200.0, 60.0)),
            ("square", square(60.0, 180.0)),
        ];
        for (name, path) in curves {
            for seed in 0..5 {
                let request = RibbonRequest { seed, ..RibbonRequest::new(vec![(name.into(), path.clone())]) };
                let outcome = prepared.run(&request, &mut Unobserved).unwrap();
                let (jump, seam) = worst(&exemplar.image, &outcome.ribbons[0]);
                // A pixel; where one piece turns a corner of 90 degrees, a tenth more.
                let limit = (0.02 * height as f64).max(1.1);
                if jump > limit {
                    failed.push(format!(
                        "{name}, seed {seed}: {jump:.2} over {limit:.2} at seam {seam} of {}",
                        outcome.ribbons[0].pieces.len()
                    ));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
