//! Asking a computation to stop, from another thread.

use std::sync::{
    Arc,
    atomic::{AtomicU32, Ordering},
};

/// Why somebody asks to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Whoever started the run does not want it any more.
    Asked,
    /// The time is up.
    Time,
}

/// Asks everything that draws on the same budget to stop. Clones ask for the same.
#[derive(Clone, Debug, Default)]
pub struct Stopper(Arc<Asked>);

#[derive(Debug, Default)]
struct Asked {
    /// How often somebody asked, whatever the cause.
    any: AtomicU32,
    /// How often because the time was up.
    time: AtomicU32,
}

impl Stopper {
    /// Asks to stop: with what there is so far, where there is something. It may be called from any thread, and again, which then also
    /// stops what is still done with the best so far.
    pub fn stop(&self, cause: Cause) {
        if cause == Cause::Time {
            self.0.time.fetch_add(1, Ordering::SeqCst);
        }
        self.0.any.fetch_add(1, Ordering::SeqCst);
    }

    /// How often somebody asked so far.
    pub fn asked(&self) -> u32 {
        self.0.any.load(Ordering::SeqCst)
    }

    /// The first of several causes that count.
    pub(crate) fn cause(&self) -> Cause {
        let time = self.0.time.load(Ordering::SeqCst);
        if time > 0 && time == self.asked() { Cause::Time } else { Cause::Asked }
    }

    /// The same as [`Stopper::asked`], for loops.
    pub(super) fn hint(&self) -> u32 {
        self.0.any.load(Ordering::Relaxed)
    }
}
