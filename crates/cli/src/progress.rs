//! The progress bar, and the reasons to stop.

use std::{
    ops::ControlFlow,
    time::{Duration, Instant},
};

use arabesque::{Observer, Progress, core::Preview};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::{
    control::{Deadline, is_interrupted},
    say::{self, Level},
};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// What a run counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Steps {
    /// Levels and iterations over elements.
    Iterations,
    /// Pieces of ribbons.
    Pieces,
}

/// Watches a run.
pub(crate) struct Watch {
    bar: ProgressBar,
    steps: Steps,
    started: Instant,
    deadline: Deadline,
}

impl Watch {
    /// Shows a bar when standard error is a terminal and the user wants to hear something.
    pub(crate) fn new(level: Level, deadline: Deadline, steps: Steps) -> Self {
        let bar = if level > Level::Quiet && say::is_terminal() {
            ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr_with_hz(10))
        } else {
            ProgressBar::hidden()
        };
        if let Ok(style) = ProgressStyle::with_template(&format!("{} {{percent:>3}}% {{msg}}", say::bar_style())) {
            bar.set_style(style);
        }
        Self { bar, steps, started: Instant::now(), deadline }
    }

    /// Takes the bar off the screen.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    pub(crate) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }
}

impl<const D: usize> Observer<D> for Watch {
    fn step(&mut self, progress: &Progress, _: &dyn Fn() -> Preview<D>) -> ControlFlow<()> {
        if !self.bar.is_hidden() {
            self.bar.set_position((progress.fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
            self.bar.set_message(describe(progress, self.steps, self.started.elapsed()));
        }
        if is_interrupted() || self.deadline.is_over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Level, iteration, energy and time left, in words.
fn describe(p: &Progress, steps: Steps, elapsed: Duration) -> String {
    let energy = p.energy.map_or_else(String::new, |e| format!(", energy {e:.4}"));
    let left = if p.fraction > 0.02 {
        let seconds = elapsed.as_secs_f64() * (1.0 - p.fraction) / p.fraction;
        format!(", {} left", clock(seconds))
    } else {
        String::new()
    };
    if steps == Steps::Pieces {
        return format!("piece {}/{}{left}", p.iteration, p.iterations);
    }
    format!(
        "level {}/{}, iteration {}/{}, {} elements{energy}{left}",
        p.level + 1,
        p.levels,
        p.iteration,
        p.iterations,
        p.elements
    )
}

/// Seconds as people read them.
fn clock(seconds: f64) -> String {
    let whole = seconds.max(0.0).ceil() as u64;
    if whole < 60 { format!("{whole} s") } else { format!("{} min {:02} s", whole / 60, whole % 60) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_says_where_it_stands() {
        let p = Progress {
            level: 1,
            levels: 3,
            iteration: 4,
            iterations: 7,
            fraction: 0.5,
            energy: Some(0.125),
            elements: 300,
        };
        let text = describe(&p, Steps::Iterations, Duration::from_secs(75));
        assert_eq!(text, "level 2/3, iteration 4/7, 300 elements, energy 0.1250, 1 min 15 s left");
        assert_eq!(describe(&p, Steps::Pieces, Duration::from_secs(9)), "piece 4/7, 9 s left");
    }
}
