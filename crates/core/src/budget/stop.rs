//! Asking a computation to stop, from another thread.

use std::sync::{
    Arc,
    atomic::{AtomicU32, AtomicU64, Ordering},
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
    /// For tests: the check at which to ask, and how many there were.
    hook: Option<(u64, AtomicU64)>,
}

impl Stopper {
    /// Asks by itself at the `n`-th check, counted from 1 over all accounts: for tests of what stopping leaves behind. Checks of one
    /// parallel step may come in any order; which step the `n`-th one falls into does not depend on it.
    pub fn at_check(n: u64) -> Self {
        Self(Arc::new(Asked { hook: Some((n, AtomicU64::new(0))), ..Asked::default() }))
    }

    /// Checks made so far; counted by [`Stopper::at_check`] alone.
    pub fn checks(&self) -> u64 {
        self.0.hook.as_ref().map_or(0, |(_, checks)| checks.load(Ordering::Relaxed))
    }

    /// Counts a check where checks are counted.
    pub(super) fn count_check(&self) {
        if let Some((n, checks)) = &self.0.hook
            && checks.fetch_add(1, Ordering::Relaxed) + 1 == *n
        {
            self.stop(Cause::Asked);
        }
    }

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
