//! The same for each of many, in parallel, with the budget asked on the way.

use arabesque_core::{Budget, Result};
use rayon::prelude::*;

/// How many one thread makes before another one may go on: always the same, so that the number of checks does not depend on the threads.
const CHUNK: usize = 128;

/// What `make` gives for each of `0..count`, in their order; `cost` is the work that each takes.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn each<T: Send>(
    count: usize,
    budget: &Budget,
    cost: impl Fn(usize) -> u64 + Sync,
    make: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>> {
    let chunk = |c: usize| -> Result<Vec<T>> {
        let range = c * CHUNK..(c * CHUNK + CHUNK).min(count);
        // Paid before it is made: then the last one of a chunk is as bounded as the others.
        budget.spend(range.clone().map(&cost).sum())?;
        Ok(range.map(&make).collect())
    };
    let chunks: Result<Vec<Vec<T>>> = (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).collect();
    Ok(chunks?.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use arabesque_core::{Cause, Error};

    use super::*;

    #[test]
    fn all_are_made_in_order_and_paid_for() {
        let budget = Budget::default();
        assert_eq!(each(1000, &budget, |i| i as u64, |i| 2 * i).unwrap(), (0..1000).map(|i| 2 * i).collect::<Vec<_>>());
        assert_eq!(budget.work(), 999 * 500);
        assert!(each(0, &budget, |_| 1, |i| i).unwrap().is_empty());
    }

    #[test]
    fn a_request_to_stop_is_heard_on_the_way() {
        let (budget, made) = (Budget::default(), AtomicUsize::new(0));
        let make = |_: usize| {
            made.fetch_add(1, Ordering::Relaxed);
            budget.stopper().stop(Cause::Asked);
        };
        assert!(matches!(each(1_000_000, &budget, |_| 1, make), Err(Error::Stopped { .. })));
        // Each thread may finish the chunk that it has begun.
        assert!(made.into_inner() <= 100 * CHUNK);
    }
}
