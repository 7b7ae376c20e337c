//! Small amounts of work, paid together.

use super::Budget;
use crate::error::Result;

/// Work units after which a meter pays.
const INSTALMENT: u64 = 1 << 14;

/// Collects the work of a tight loop on one thread, and pays it in instalments.
#[derive(Debug)]
pub struct Meter<'a> {
    budget: &'a Budget,
    owed: u64,
}

impl<'a> Meter<'a> {
    /// A meter that owes nothing.
    pub(super) fn new(budget: &'a Budget) -> Self {
        Self { budget, owed: 0 }
    }

    /// Counts some work, and pays when enough has come together.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn spend(&mut self, units: u64) -> Result<()> {
        self.owed = self.owed.saturating_add(units);
        if self.owed < INSTALMENT { Ok(()) } else { self.budget.spend(std::mem::take(&mut self.owed)) }
    }
}

impl Drop for Meter<'_> {
    fn drop(&mut self) {
        // What is left is counted; whoever draws next is told.
        let _ = self.budget.spend(std::mem::take(&mut self.owed));
    }
}
