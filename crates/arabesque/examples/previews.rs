//! How soon the first preview of a run can be shown, and how long one waits for the next:
//! `cargo run --release -p arabesque --example previews -- [EXEMPLAR.svg [WIDTHxHEIGHT [THREADS]]]`.
//!
//! Builds a preview whenever the run offers one and the last one is older than a tenth of a second, as a program with a window would.
#![allow(clippy::print_stdout, reason = "the example prints what it measures")]

use std::{
    ops::ControlFlow,
    time::{Duration, Instant},
};

use arabesque::{Artwork, Fill, Input, Progress, Recipe, Resources, in_pool};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Least time between two previews.
const PAUSE: Duration = Duration::from_millis(100);

/// What a run offered, and when.
struct Watch {
    started: Instant,
    /// Time of each offer, and what was going on.
    offers: Vec<(Duration, Progress)>,
    /// When each preview was ready, and how long it took to build.
    shown: Vec<(Duration, Duration)>,
}

impl arabesque::Watch<Artwork> for Watch {
    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> Artwork) -> ControlFlow<()> {
        let now = self.started.elapsed();
        self.offers.push((now, progress.clone()));
        if self.shown.last().is_none_or(|(last, _)| now >= *last + PAUSE) {
            let built = preview().summary();
            if built.elements > 0 || built.curves > 0 {
                let ready = self.started.elapsed();
                self.shown.push((ready, ready - now));
            }
        }
        ControlFlow::Continue(())
    }
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let exemplar = arguments.next().unwrap_or_else(|| "examples/quatrefoil.svg".into());
    let size = arguments.next().unwrap_or_else(|| "480x360".into());
    let threads = arguments.next().map(|n| n.parse()).transpose()?;
    let recipe = Recipe { seed: 1, ..Recipe::new(Input::file(&exemplar), Fill::page(size.parse()?)) };
    let started = Instant::now();
    in_pool(threads, || -> arabesque::Result<()> {
        let prepared = recipe.prepare(&Resources::default())?;
        let ready = started.elapsed();
        let mut watch = Watch { started: Instant::now(), offers: Vec::new(), shown: Vec::new() };
        prepared.run(&prepared.request(), &mut watch)?;
        let total = watch.started.elapsed();
        println!("{exemplar}, {size}: prepared in {} ms, run in {} ms", ready.as_millis(), total.as_millis());
        report(&watch, total);
        Ok(())
    })??;
    Ok(())
}

fn report(watch: &Watch, total: Duration) {
    let first = watch.shown.first().map_or(total, |(ready, _)| *ready);
    let ends = watch.shown.iter().map(|(ready, _)| *ready).chain([total]);
    let gaps: Vec<_> = watch.shown.iter().zip(ends.skip(1)).map(|((from, _), to)| to - *from).collect();
    let slowest = watch.shown.iter().map(|(_, built)| *built).max().unwrap_or_default();
    println!(
        "first preview after {} ms; {} previews, {:.1} a second; longest wait {} ms; longest to build {} ms",
        first.as_millis(),
        watch.shown.len(),
        watch.shown.len() as f64 / total.as_secs_f64(),
        gaps.into_iter().max().unwrap_or(total).as_millis(),
        slowest.as_millis(),
    );
    let starts = std::iter::once(Duration::ZERO).chain(watch.offers.iter().map(|(at, _)| *at));
    let mut waits: Vec<_> = watch.offers.iter().zip(starts).map(|((at, p), from)| (*at - from, *at, p)).collect();
    if let Some((last, _)) = watch.offers.last() {
        println!("after the last offer: {} ms", (total - *last).as_millis());
    }
    waits.sort_by_key(|wait| std::cmp::Reverse(wait.0));
    for (wait, at, p) in waits.iter().take(5) {
        println!("  {:4} ms without an offer before {} ms: {p}", wait.as_millis(), at.as_millis());
    }
}
