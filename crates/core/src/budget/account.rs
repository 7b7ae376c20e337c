//! What is left of the limits.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use super::{Limits, Stopper};
use crate::{
    error::{Error, Result},
    run::Forecast,
    text::rounded,
};

/// Work units in one unit of [`Limits::work`].
const MILLION: u64 = 1_000_000;
/// Work that an element of an exemplar allows, as a share of what one of the result does.
const ANALYSED: f64 = 0.05;
/// How much more than what was foretold is advised: forecasts are rough.
const MARGIN: f64 = 1.25;
/// Work units after which a meter pays.
const INSTALMENT: u64 = 1 << 14;

/// The limits of one command, and what was drawn of them so far. Clones draw on the same account; the stage is a clone's own.
///
/// Every loop that input can lengthen draws on a budget: [`Budget::spend`] for work, [`Budget::hold`] for memory, [`Budget::within`] for
/// what is counted once. Work is counted, never timed, so that a run ends at the same place on every machine and with any number of
/// threads: whether a parallel step is over its budget depends on its sum alone (`spend(0)` ends one whose parts have meters), and a step
/// that was cut short is given up as a whole.
///
/// ```
/// use arabesque_core::{Budget, Limits};
///
/// let budget = Budget::new(Limits { work: 1, ..Limits::default() }).stage("counting");
/// budget.spend(400_000)?;
/// let error = budget.spend(700_000).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "counting: more than 1 million units of work is over the limit of 1; give it less to do, or raise the limit with --limit work=2"
/// );
/// # Ok::<(), arabesque_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Budget {
    account: Arc<Account>,
    stage: &'static str,
}

#[derive(Debug)]
struct Account {
    limits: Limits,
    stopper: Stopper,
    /// Requests to stop that came before this account was opened, and do not count for it.
    heard: u32,
    work: AtomicU64,
    /// Work that may be done, in units.
    allowed: AtomicU64,
    /// Work that there will be in all by the last forecast, in units.
    expected: AtomicU64,
    memory: AtomicU64,
}

impl Default for Budget {
    fn default() -> Self {
        Self::new(Limits::default())
    }
}

impl Budget {
    /// An account of which nothing is drawn, and which nobody asks to stop.
    pub fn new(limits: Limits) -> Self {
        Self::with_stopper(limits, Stopper::default())
    }

    /// An account that ends early when `stopper` asks from now on. Earlier requests do not count: the best so far of a run that was
    /// stopped is drawn on a fresh account.
    pub fn with_stopper(limits: Limits, stopper: Stopper) -> Self {
        let heard = stopper.asked();
        let account = Account {
            limits,
            stopper,
            heard,
            work: AtomicU64::new(0),
            allowed: AtomicU64::new((limits.work as u64).saturating_mul(MILLION)),
            expected: AtomicU64::new(0),
            memory: AtomicU64::new(0),
        };
        Self { account: Arc::new(account), stage: "" }
    }

    /// An account that asks to stop by itself at the `n`-th check, counted from 1: for tests of what stopping leaves behind. Checks of
    /// one parallel step may come in any order; which step the `n`-th one falls into does not depend on it.
    pub fn stopping_at(limits: Limits, n: u64) -> Self {
        Self::with_stopper(limits, Stopper::at_check(n))
    }

    /// A fresh account with the same limits, for another part of the same command that has its own share, or for what is still to be
    /// done with the best so far. Requests to stop that were made before it was opened do not count for it.
    #[must_use]
    pub fn fresh(&self) -> Self {
        Self { stage: self.stage, ..Self::with_stopper(self.account.limits, self.account.stopper.clone()) }
    }

    /// The same account, with a name for what is being done: what errors begin with.
    #[must_use]
    pub fn stage(&self, stage: &'static str) -> Self {
        Self { account: Arc::clone(&self.account), stage }
    }

    /// The limits.
    pub fn limits(&self) -> &Limits {
        &self.account.limits
    }

    /// Asks for everything that draws on this account to stop.
    pub fn stopper(&self) -> &Stopper {
        &self.account.stopper
    }

    /// Work done so far, in units.
    pub fn work(&self) -> u64 {
        self.account.work.load(Ordering::Relaxed)
    }

    /// Work done so far, in whole millions of units, which is what [`Limits::work`] counts.
    pub fn millions(&self) -> u64 {
        self.work() / MILLION
    }

    /// Checks made so far; counted on accounts of [`Budget::stopping_at`] alone.
    pub fn checks(&self) -> u64 {
        self.account.stopper.checks()
    }

    /// Work that may be done, in units.
    pub fn allowed(&self) -> u64 {
        self.account.allowed.load(Ordering::Relaxed)
    }

    /// Allows the work that `elements` more elements of the result may take.
    pub fn allow_elements(&self, elements: f64) {
        let each = (self.account.limits.work_per_element as u64).saturating_mul(MILLION) as f64;
        // A float too large for the integer becomes its largest value.
        let more = (elements.max(0.0) * each) as u64;
        let add = |allowed: u64| Some(allowed.saturating_add(more));
        // The closure never declines.
        let _ = self.account.allowed.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
    }

    /// Allows the work that analysing `elements` elements of an exemplar may take beside: a twentieth of what as many of a result may.
    pub fn allow_exemplar(&self, elements: usize) {
        self.allow_elements(elements as f64 * ANALYSED);
    }

    /// The forecast of a run of `count` elements, samples or pieces that takes `work` more units. Whoever is refused for its work from
    /// then on is told to allow as much.
    pub fn forecast(&self, count: f64, work: f64) -> Forecast {
        let expected = self.work() as f64 + work.max(0.0);
        self.account.expected.store(expected as u64, Ordering::Relaxed);
        Forecast { count, work, allowed: self.allowed() as f64 }
    }

    /// Whether somebody asked to stop.
    ///
    /// # Errors
    /// [`Error::Stopped`] when somebody did.
    pub fn check(&self) -> Result<()> {
        let account = &*self.account;
        account.stopper.count_check();
        if account.stopper.hint() > account.heard {
            return Err(Error::Stopped { stage: self.stage_name().to_owned(), cause: account.stopper.cause() });
        }
        Ok(())
    }

    /// Counts work, in units of about a nanosecond, and checks as [`Budget::check`] does. A step of a loop that calls it should not take
    /// longer than a millisecond.
    ///
    /// # Errors
    /// [`Error::Stopped`] when somebody asked to stop, [`Error::Limit`] when the work is used up.
    pub fn spend(&self, units: u64) -> Result<()> {
        let account = &*self.account;
        let done = account.work.fetch_add(units, Ordering::Relaxed).saturating_add(units);
        if done > account.allowed.load(Ordering::Relaxed) {
            return Err(self.overworked());
        }
        self.check()
    }

    /// Counts work of what cannot fail, such as the answer to a question; whoever draws next is told. The loop around it has to draw too.
    pub fn owe(&self, units: u64) {
        self.account.work.fetch_add(units, Ordering::Relaxed);
    }

    /// Whether `units` more of work would still be within the limit; nothing is drawn.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub fn foresee(&self, units: u64) -> Result<()> {
        let account = &*self.account;
        if self.work().saturating_add(units) > account.allowed.load(Ordering::Relaxed) {
            return Err(self.overworked());
        }
        self.check()
    }

    /// A meter for the small steps of a tight loop.
    pub fn meter(&self) -> Meter<'_> {
        Meter::new(self)
    }

    /// Memory that is in use as long as the answer lives.
    ///
    /// # Errors
    /// [`Error::Limit`] when more than [`Limits::memory`] would be in use.
    pub fn hold(&self, what: &str, bytes: usize) -> Result<Held> {
        let account = &self.account;
        let held = account.memory.fetch_add(bytes as u64, Ordering::Relaxed).saturating_add(bytes as u64);
        let guard = Held { account: Arc::clone(account), bytes: bytes as u64 };
        if held <= account.limits.memory as u64 {
            return Ok(guard);
        }
        Err(self.over(what, format!("{held} bytes of memory"), ("memory", account.limits.memory), held))
    }

    /// A list with room for `count` items, its memory held; an allocation that fails is an error.
    ///
    /// # Errors
    /// [`Error::Limit`] when more than [`Limits::memory`] would be in use, or when there is no such memory.
    pub fn list<T>(&self, what: &str, count: usize) -> Result<(Vec<T>, Held)> {
        let bytes = count.saturating_mul(size_of::<T>());
        let held = self.hold(what, bytes)?;
        let mut list = Vec::new();
        match list.try_reserve_exact(count) {
            Ok(()) => Ok((list, held)),
            Err(_) => Err(Error::Limit {
                what: self.named(what),
                found: format!("{bytes} bytes of memory"),
                limit: "what this machine has".into(),
                advice: "make the input smaller, or use a machine with more memory".into(),
            }),
        }
    }

    /// Refuses a count over one of the limits; `limit` is its name.
    ///
    /// # Errors
    /// [`Error::Limit`] when `found` is larger.
    pub fn within(&self, what: &str, found: usize, limit: (&'static str, usize)) -> Result<()> {
        if found <= limit.1 {
            return Ok(());
        }
        Err(self.over(what, found.to_string(), limit, found as u64))
    }

    /// Refuses what was worked out, and may be beyond any whole number, where it is over one of the limits.
    ///
    /// # Errors
    /// [`Error::Limit`] when `expected` is larger, or is not a number.
    pub fn within_expected(&self, what: &str, expected: f64, limit: (&'static str, usize)) -> Result<()> {
        if expected <= limit.1 as f64 {
            return Ok(());
        }
        Err(self.over(what, rounded(expected.ceil()), limit, expected.ceil() as u64))
    }

    fn over(&self, what: &str, found: String, (name, limit): (&str, usize), enough: u64) -> Error {
        Error::Limit {
            what: self.named(what),
            found,
            limit: limit.to_string(),
            advice: if Limits::default().set(name, &enough.to_string()).is_ok() {
                format!("make it smaller, or raise the limit with --limit {name}={enough}")
            } else {
                "make it smaller".into()
            },
        }
    }

    fn overworked(&self) -> Error {
        // How much more there was depends on the threads: it is not told.
        let limit = self.account.allowed.load(Ordering::Relaxed) / MILLION;
        Error::Limit {
            what: self.stage_name().to_owned(),
            found: format!("more than {limit} million units of work"),
            limit: limit.to_string(),
            advice: self.more_work(limit),
        }
    }

    /// What to do about work that is over `limit` millions of units in all.
    fn more_work(&self, limit: u64) -> String {
        let own = self.account.limits.work as u64;
        let expected = self.account.expected.load(Ordering::Relaxed) as f64 / MILLION as f64;
        // Twice as much in all, or what was foretold, of which the elements bring their share.
        let wanted = limit.saturating_mul(2).max((expected * MARGIN).ceil() as u64);
        let enough = own.saturating_add(wanted.saturating_sub(limit)).to_string();
        match Limits::default().set("work", &enough) {
            Ok(()) => format!("give it less to do, or raise the limit with --limit work={enough}"),
            Err(_) => "give it less to do".into(),
        }
    }

    /// What to tell of a result that is the best so far because the work was used up, and what to do about it.
    pub fn spent(&self) -> (String, String) {
        let allowed = self.allowed() / MILLION;
        let message =
            format!("{}: {allowed} million units of work were used up: this is the best so far", self.stage_name());
        (message, self.more_work(allowed))
    }

    fn stage_name(&self) -> &'static str {
        if self.stage.is_empty() { "the work" } else { self.stage }
    }

    fn named(&self, what: &str) -> String {
        if self.stage.is_empty() { what.to_owned() } else { format!("{}: {what}", self.stage) }
    }
}

/// Collects the work of a tight loop on one thread, and pays it in instalments.
#[derive(Debug)]
pub struct Meter<'a> {
    budget: &'a Budget,
    owed: u64,
}

impl<'a> Meter<'a> {
    /// A meter that owes nothing.
    fn new(budget: &'a Budget) -> Self {
        Self { budget, owed: 0 }
    }

    /// Counts some work, and pays when enough has come together.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    #[inline]
    pub fn spend(&mut self, units: u64) -> Result<()> {
        self.owed = self.owed.saturating_add(units);
        if self.owed < INSTALMENT { Ok(()) } else { self.budget.spend(std::mem::take(&mut self.owed)) }
    }
}

impl Drop for Meter<'_> {
    fn drop(&mut self) {
        // Nobody would hear of it here: whoever draws next is told, which after a parallel step is to be at once (`spend(0)`).
        self.budget.owe(std::mem::take(&mut self.owed));
    }
}

/// Memory that is accounted for until this is dropped.
#[derive(Debug)]
pub struct Held {
    account: Arc<Account>,
    bytes: u64,
}

impl Drop for Held {
    fn drop(&mut self) {
        self.account.memory.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Cause;

    #[test]
    fn work_is_one_account_for_all_clones() {
        let budget = Budget::new(Limits { work: 1, work_per_element: 1, ..Limits::default() });
        budget.stage("a").spend(600_000).unwrap();
        assert!(matches!(budget.stage("b").foresee(600_000), Err(Error::Limit { what, .. }) if what == "b"));
        budget.allow_elements(1.0);
        budget.spend(600_000).unwrap();
        assert_eq!(budget.work(), 1_200_000);
        assert_eq!(budget.fresh().work(), 0);
    }

    #[test]
    fn meters_pay_all_they_owe() {
        let budget = Budget::default();
        let mut meter = budget.meter();
        (0..100_000).try_for_each(|_| meter.spend(3)).unwrap();
        drop(meter);
        assert_eq!(budget.work(), 300_000);
    }

    #[test]
    fn memory_is_given_back() {
        let budget = Budget::new(Limits { memory: 1 << 20, ..Limits::default() });
        let first = budget.list::<u8>("a list", 1 << 20).unwrap();
        assert!(budget.hold("another", 1).unwrap_err().to_string().contains("--limit memory=1048577"));
        drop(first);
        assert!(budget.list::<u8>("another", 1 << 20).is_ok());
        assert!(budget.list::<u64>("another", usize::MAX).is_err());
    }

    #[test]
    fn a_request_to_stop_counts_for_accounts_that_were_open() {
        let budget = Budget::default();
        budget.stopper().stop(Cause::Time);
        assert!(matches!(budget.check(), Err(Error::Stopped { cause: Cause::Time, .. })));
        let fresh = budget.fresh();
        fresh.check().unwrap();
        budget.stopper().stop(Cause::Asked);
        assert!(matches!(fresh.check(), Err(Error::Stopped { cause: Cause::Asked, .. })));
    }

    #[test]
    fn the_hook_stops_at_its_check_and_after() {
        let budget = Budget::stopping_at(Limits::default(), 3);
        assert_eq!([(); 4].map(|()| budget.check().is_ok()), [true, true, false, false]);
        assert_eq!(budget.checks(), 4);
    }

    #[test]
    fn a_limit_is_not_to_be_raised_beyond_what_it_may_be() {
        let error = Budget::default().within("points", usize::MAX, ("output-elements", 8)).unwrap_err();
        assert!(error.to_string().ends_with("; make it smaller"), "{error}");
    }

    #[test]
    fn counts_over_a_limit_name_it() {
        let error = Budget::default().stage("reading").within("leaves.svg: nodes", 9, ("nodes", 8)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "reading: leaves.svg: nodes: 9 is over the limit of 8; make it smaller, or raise the limit with --limit nodes=9"
        );
    }
}
