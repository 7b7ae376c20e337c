//! The bounded programme beside the naive one, on exemplars of the sizes that the paper reports.
//!
//! `cargo bench -p arabesque-ribbons`: a run is a whole curve, so divide by the number of pieces.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]
#![allow(missing_docs, reason = "the macros of divan make items without any")]

use arabesque_core::{Budget, Image, Path, Unobserved, Vector};
use arabesque_ribbons::{Prepared, RibbonParams, RibbonRequest, Search, StripExemplar, Width};

fn main() {
    divan::main();
}

/// A chain of beads of different sizes and colours on a thread, `width` x `height` pixels.
fn beads(width: usize, height: usize) -> StripExemplar {
    let mut image = Image::transparent(width, height);
    for y in 0..height {
        for x in 0..width {
            let k = x / (height / 3);
            let centre = (k as f64 + 0.5) * (height / 3) as f64;
            let radius = height as f64 * (0.1 + 0.07 * ((k * 7 % 5) as f64 / 4.0));
            let (dx, dy) = (x as f64 + 0.5 - centre, y as f64 + 0.5 - 0.5 * height as f64);
            let inside = (radius - dx.hypot(dy)).max(1.5 - dy.abs());
            let alpha = (inside + 0.5).clamp(0.0, 1.0);
            image.pixels[y * width + x] = [(40 * (k % 6)) as u8, 120, (35 * (k % 7)) as u8, (255.0 * alpha) as u8];
        }
    }
    StripExemplar::new(image)
}

/// A wave of `pieces` pieces of `step` units.
fn wave(pieces: usize, step: f64) -> Path<2> {
    let length = pieces as f64 * step;
    let points: Vec<_> = (0..=400)
        .map(|k| f64::from(k) / 400.0)
        .map(|t| (t * length * 0.93, 0.06 * length * (t * 12.0).sin()))
        .collect();
    Path::polyline(&points.iter().map(|&(x, y)| Vector::xy(x, y)).collect::<Vec<_>>())
}

#[derive(Clone, Copy, Debug)]
struct Case {
    width: usize,
    height: usize,
    ribbon: f64,
    pieces: usize,
    search: Search,
    /// As in the paper: pixels alone, every position, no penalty.
    paper: bool,
}

impl std::fmt::Display for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let formulation = if self.paper { "paper" } else { "default" };
        write!(
            f,
            "{}x{} b{} {} pieces {formulation} {:?}",
            self.width, self.height, self.ribbon, self.pieces, self.search
        )
    }
}

fn cases() -> Vec<Case> {
    let of = |(width, height, ribbon), pieces, search, paper| Case { width, height, ribbon, pieces, search, paper };
    let (small, large) = ((199, 82, 82.0), (325, 64, 90.0));
    vec![
        of(small, 40, Search::Bounded, false),
        of(small, 40, Search::Bounded, true),
        of(small, 4, Search::Exhaustive, true),
        of(small, 4, Search::Bounded, true),
        of(large, 40, Search::Bounded, false),
        of(large, 40, Search::Bounded, true),
        of((480, 96, 96.0), 20, Search::Bounded, false),
        of((480, 96, 96.0), 40, Search::Bounded, false),
        of((480, 96, 96.0), 80, Search::Bounded, false),
    ]
}

#[divan::bench(args = cases(), sample_count = 3, sample_size = 1)]
fn curve(bencher: divan::Bencher<'_, '_>, case: &Case) {
    let step = 16.0;
    let mut params = RibbonParams {
        step: Some(step),
        width: Width::Constant(case.ribbon),
        search: case.search,
        ..RibbonParams::default()
    };
    if case.paper {
        params =
            RibbonParams { context: 0.0, repetition: 0.0, variety: 0.0, centring: 0.0, wander: Some(1.0), ..params };
    }
    let prepared = Prepared::new(vec![beads(case.width, case.height)], params, &Budget::default()).unwrap();
    let request = RibbonRequest::new(vec![("wave".into(), wave(case.pieces, step))]);
    bencher.bench(|| prepared.run(&request, &mut Unobserved).unwrap());
}
