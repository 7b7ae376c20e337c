//! What a repair did, and what the user should know about it.

use arabesque_core::Warning;

/// Share of the elements whose exchange or removal goes without a warning.
const NORMAL: f64 = 0.02;

/// What a repair did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Summary {
    /// Pairs that overlapped more than they may.
    pub(crate) pairs: usize,
    /// Elements that broke the rule of the border.
    pub(crate) outside: usize,
    /// Elements that were shifted.
    pub(crate) moved: usize,
    /// Elements that gave way to a smaller one of their class.
    pub(crate) exchanged: usize,
    /// Elements that were taken out.
    pub(crate) removed: usize,
    /// Elements that stay as they were, because a wider hole than the exemplar has would be left without them.
    pub(crate) restored: usize,
}

impl Summary {
    /// What the user should know about a repair of so many elements: `None` when shifts were nearly always enough.
    pub(crate) fn warning(&self, elements: usize) -> Option<Warning> {
        if (self.removed + self.exchanged + self.restored) as f64 <= NORMAL * elements as f64 {
            return None;
        }
        let Self { pairs, outside, removed, exchanged, restored, .. } = self;
        let stay = if *restored > 0 {
            format!("; {restored} stay as they were, since they would leave wider holes than the exemplar has")
        } else {
            String::new()
        };
        let message = format!(
            "{pairs} pairs of elements overlapped more than in the exemplar and {outside} elements reached out of \
             the domain; {exchanged} were exchanged for smaller ones and {removed} left out{stay}"
        );
        Some(Warning::new(message, "lower the density, or leave more room around kept elements and obstacles"))
    }
}
