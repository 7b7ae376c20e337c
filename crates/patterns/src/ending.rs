//! How a run ends before it is finished: somebody asks to stop, or a limit is reached.

use std::ops::ControlFlow;

use arabesque_core::{Budget, Cause, Error, Limits, Progress, Result, StopReason, Warning};

/// Millions of units of work that are spent on what was cut short before it is taken as it is.
const LAST_TOUCHES: usize = 10;

/// A small account for what is still to be done with a result that was cut short: a page that needs more is drawn as it is.
pub(crate) fn last_touches(budget: &Budget) -> Budget {
    let limits = Limits { work: LAST_TOUCHES.min(budget.limits().work), ..*budget.limits() };
    Budget::with_stopper(limits, budget.stopper().clone())
}

/// What the watch answers, as a result.
pub(crate) fn heard(flow: ControlFlow<()>, progress: &Progress) -> Result<()> {
    match flow {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Stopped { stage: progress.stage.to_string(), cause: Cause::Asked }),
    }
}

/// Why a run ended; a warning tells the limit that cut it short.
pub(crate) fn reason(cut_short: Option<Error>, warnings: &mut Vec<Warning>) -> Result<StopReason> {
    match cut_short {
        None => Ok(StopReason::Finished),
        Some(Error::Stopped { .. }) => Ok(StopReason::Stopped),
        Some(Error::Limit { what, found, limit, advice }) => {
            let message = format!("{what}: {found} is over the limit of {limit}; the result is the best so far");
            warnings.push(Warning::new(message, advice));
            Ok(StopReason::Limit)
        }
        Some(other) => Err(other),
    }
}
