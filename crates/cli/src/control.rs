//! What ends a run early: Ctrl-C and the time limit.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use crate::failure::INTERRUPTED;

static INTERRUPT: AtomicBool = AtomicBool::new(false);

/// From here on, the first Ctrl-C asks the run to end with the best so far, and the second ends the program.
pub(crate) fn listen() {
    // Without a handler Ctrl-C ends the program at once, which leaves no half file either.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPT.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
}

/// Whether Ctrl-C was pressed.
pub(crate) fn is_interrupted() -> bool {
    INTERRUPT.load(Ordering::SeqCst)
}

/// When the time is up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deadline(Option<Instant>);

impl Deadline {
    /// `limit` from now; never without a limit.
    pub(crate) fn after(limit: Option<Duration>) -> Self {
        Self(limit.and_then(|l| Instant::now().checked_add(l)))
    }

    pub(crate) fn is_over(self) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }
}
