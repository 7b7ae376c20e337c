//! The progress bar.

use std::{
    borrow::Cow,
    ops::ControlFlow,
    time::{Duration, Instant},
};

use arabesque::{Forecast, Limits, Progress};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::{
    process::sentinel::{self, Phase},
    say::{self, Level},
};

/// Seconds that a unit of work takes on one core, by and large.
const UNIT: f64 = 2e-9;
/// Seconds from which on a user wants to know before.
const WORTH_TELLING: f64 = 10.0;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Watches a run.
pub(crate) struct Watch {
    bar: ProgressBar,
    level: Level,
    started: Instant,
    /// Whether the work was told before.
    foretold: bool,
    /// The last stage that was told, where stages are told.
    told: Option<Cow<'static, str>>,
}

impl Watch {
    /// Shows a bar when standard error is a terminal and the user wants to hear something.
    pub(crate) fn new(level: Level) -> Self {
        let bar = if level > Level::Quiet && say::is_terminal() {
            ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr_with_hz(10))
        } else {
            ProgressBar::hidden()
        };
        if let Ok(style) = ProgressStyle::with_template(&format!("{} {{percent:>3}}% {{msg}}", say::bar_style())) {
            bar.set_style(style);
        }
        let told = (level == Level::Verbose).then_some(Cow::Borrowed(""));
        Self { bar, level, started: Instant::now(), foretold: false, told }
    }

    /// Takes the bar off the screen.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Says which stage begins, to who wants to know.
    fn tell(&mut self, progress: &Progress) {
        let Some(told) = self.told.as_mut().filter(|told| **told != progress.stage) else { return };
        told.clone_from(&progress.stage);
        let stage = progress.stage.as_ref();
        self.bar.suspend(|| say::note(stage));
    }

    pub(crate) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }
}

impl<P> arabesque::Watch<P> for Watch {
    fn foreseen(&mut self, forecast: &Forecast) {
        let seconds = forecast.work * UNIT;
        if self.level > Level::Quiet && seconds > WORTH_TELLING {
            let text = match std::mem::replace(&mut self.foretold, true) {
                false => format!(
                    "about {:.0} elements, samples or pieces to place: {} of work for one core",
                    forecast.count,
                    clock(seconds)
                ),
                true => format!("by what was placed until now, {} of work for one core are left", clock(seconds)),
            };
            self.bar.suspend(|| say::note(&text));
            if forecast.work > forecast.allowed {
                let needed = (forecast.work / 1e6).ceil();
                let can_be = Limits::default().set("work", &needed.to_string()).is_ok();
                let advice =
                    if can_be { format!("give it --limit work={needed}") } else { "give it less to do".into() };
                self.bar.suspend(|| say::note(&format!("the limit of work will not do: {advice}")));
            }
        }
    }

    fn step(&mut self, progress: &Progress, _: &dyn Fn() -> P) -> ControlFlow<()> {
        sentinel::enter(Phase::Running);
        self.tell(progress);
        if !self.bar.is_hidden() {
            self.bar.set_position((progress.fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
            self.bar.set_message(describe(progress, self.started.elapsed()));
        }
        // The run hears the same from its budget; here it is heard too when it came before the run had one.
        if sentinel::is_over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Stage, step, energy and time left, in words.
fn describe(p: &Progress, elapsed: Duration) -> String {
    if p.fraction <= 0.02 {
        return p.to_string();
    }
    let seconds = elapsed.as_secs_f64() * (1.0 - p.fraction) / p.fraction;
    format!("{p}, {} left", clock(seconds))
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
            stage: "level 2 of 3".into(),
            done: 4,
            total: 7,
            fraction: 0.5,
            energy: Some(0.125),
            count: 300,
        };
        let text = describe(&p, Duration::from_secs(75));
        assert_eq!(text, "level 2 of 3, step 4 of 7, 300 placed, energy 0.1250, 1 min 15 s left");
        let start = Progress { fraction: 0.0, ..p };
        assert!(!describe(&start, Duration::from_secs(75)).contains("left"));
    }
}
