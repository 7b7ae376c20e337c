//! What ends the program early: signals, the time limit, a reader that went away, and the limit of memory.
//!
//! A thread of its own keeps watch, so that everything is heard at once, whatever the others are doing. While a run is going on, it asks
//! the run to stop, and the best so far is written. A file that is encoded is finished, a picture that is drawn given up for a coarser one. While
//! something is read there is nothing to be saved: it ends the program.

use std::{
    process,
    sync::{
        OnceLock,
        atomic::{AtomicBool, AtomicU8, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use arabesque::{Cause, Limits, Stopper, io::file};

use crate::{
    failure::{BAD_INPUT, FAILURE, Failure, NO_RESULT},
    process::{memory, signals::Signals},
    say, summary,
};

/// How often the sentinel looks around.
const TICK: Duration = Duration::from_millis(10);

/// When the command began.
static BEGAN: OnceLock<Instant> = OnceLock::new();
/// Exit code of the first signal; 0 before there was one.
static SIGNAL: AtomicU8 = AtomicU8::new(0);
/// Whether the time is up.
static TIME: AtomicBool = AtomicBool::new(false);
/// Whether a file was written.
static WRITTEN: AtomicBool = AtomicBool::new(false);
static PHASE: AtomicU8 = AtomicU8::new(Phase::Reading as u8);

/// What the program is doing, as far as stopping is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Phase {
    /// Files are read and analysed: there is nothing yet.
    Reading = 0,
    /// A method is at work: it is asked to stop, and gives the best so far.
    Running = 1,
    /// A picture of a result is drawn: it is given up, and drawn with fewer pixels.
    Drawing = 2,
    /// A result becomes a file in memory: it is finished.
    Encoding = 3,
    /// The file is written, which takes no time worth interrupting.
    Writing = 4,
}

impl Phase {
    fn now() -> Self {
        match PHASE.load(Ordering::SeqCst) {
            1 => Self::Running,
            2 => Self::Drawing,
            3 => Self::Encoding,
            4 => Self::Writing,
            _ => Self::Reading,
        }
    }

    fn in_words(self) -> &'static str {
        match self {
            Self::Reading => "files were read and analysed and the run was prepared",
            Self::Running => "the pattern was made",
            Self::Drawing => "the picture was drawn",
            Self::Encoding => "the result was encoded",
            Self::Writing => "the result was written",
        }
    }
}

/// Whether a signal or the time asks for an end.
pub(crate) fn is_over() -> bool {
    signal().is_some() || is_late()
}

/// Says that a file was written.
pub(crate) fn written() {
    WRITTEN.store(true, Ordering::SeqCst);
}

/// What was written by the end, in words.
fn written_in_words() -> &'static str {
    if WRITTEN.load(Ordering::SeqCst) { "nothing more was written" } else { "nothing was written" }
}

/// What the sentinel minds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Orders {
    /// Time that the command may take.
    pub(crate) time_limit: Option<Duration>,
    pub(crate) limits: Limits,
    /// Whether a summary goes to standard output.
    pub(crate) json: bool,
    /// Whether standard output is where the result goes.
    pub(crate) piped: bool,
    /// Whether people want to be told.
    pub(crate) quiet: bool,
}

/// When the command began: the first call.
pub(crate) fn began() -> Instant {
    *BEGAN.get_or_init(Instant::now)
}

/// Says what the program is doing from here on.
pub(crate) fn enter(phase: Phase) {
    PHASE.store(phase as u8, Ordering::SeqCst);
}

/// Exit code of the signal that asked to stop, if there was one.
pub(crate) fn signal() -> Option<u8> {
    Some(SIGNAL.load(Ordering::SeqCst)).filter(|code| *code > 0)
}

/// Whether the time is up.
pub(crate) fn is_late() -> bool {
    TIME.load(Ordering::SeqCst)
}

/// Starts the watch.
///
/// # Errors
/// When the system gives no thread.
pub(crate) fn watch(orders: Orders, stopper: Stopper) -> Result<(), Failure> {
    let mut sentinel = Sentinel { orders, stopper, signals: Signals::listen() };
    // What has no time at all does not depend on when the thread comes to run.
    sentinel.look_at_the_clock();
    let watch = move || {
        memory::limit(sentinel.orders.limits.memory);
        loop {
            sentinel.look();
            thread::sleep(TICK);
        }
    };
    thread::Builder::new().name("sentinel".into()).spawn(watch)?;
    Ok(())
}

struct Sentinel {
    orders: Orders,
    stopper: Stopper,
    signals: Signals,
}

impl Sentinel {
    fn look(&mut self) {
        if memory::is_exhausted() {
            self.no_memory();
        }
        let came: Vec<u8> = self.signals.pending().collect();
        for code in came {
            self.on_signal(code);
        }
        self.look_at_the_clock();
        if (self.orders.piped || self.orders.json) && is_reader_gone() {
            self.leave(FAILURE, &format!("standard output: whoever reads it went away; {}", written_in_words()));
        }
    }

    fn look_at_the_clock(&self) {
        let late = self.orders.time_limit.is_some_and(|limit| began().elapsed() >= limit);
        if late && !TIME.swap(true, Ordering::SeqCst) {
            self.on_time();
        }
    }

    fn on_signal(&self, code: u8) {
        if let Some(first) = signal() {
            self.leave(first, &format!("stopped at once, as asked a second time; {}", written_in_words()));
        }
        let phase = Phase::now();
        // What is encoded is finished, and so is not told.
        if phase != Phase::Encoding {
            self.stopper.stop(Cause::Asked);
        }
        SIGNAL.store(code, Ordering::SeqCst);
        match phase {
            // What was written before is still to be summed up.
            Phase::Reading if WRITTEN.load(Ordering::SeqCst) => {}
            Phase::Reading => {
                self.leave(code, &format!("stopped while {}; {}", phase.in_words(), written_in_words()));
            }
            _ if self.orders.quiet => {}
            Phase::Running => say::note("stopping with the best so far; once more ends at once"),
            Phase::Drawing => say::note("stopping with a draft of the picture; once more ends at once"),
            Phase::Encoding => say::note("stopping when the file is finished; once more ends at once"),
            Phase::Writing => {}
        }
    }

    fn on_time(&self) {
        if Phase::now() == Phase::Reading && !WRITTEN.load(Ordering::SeqCst) {
            let what = Phase::Reading.in_words();
            self.leave(NO_RESULT, &format!("the time was up while {what}; {}; give it more time", written_in_words()));
        }
        // What was made is drawn and encoded as it is wanted.
        if matches!(Phase::now(), Phase::Reading | Phase::Running) {
            self.stopper.stop(Cause::Time);
        }
    }

    fn no_memory(&self) -> ! {
        let limit = self.orders.limits.memory;
        let advice =
            format!("make the input or the result smaller, or raise the limit with --limit memory={}", 2 * limit);
        let what = Phase::now().in_words();
        self.leave(BAD_INPUT, &format!("more than {limit} bytes of memory were asked for while {what}; {advice}"));
    }

    /// Tells why, and ends the program.
    fn leave(&self, code: u8, message: &str) -> ! {
        say::last_words(message);
        file::abandon_writing();
        if self.orders.json && !is_reader_gone() {
            summary::print_failure(&Failure::with(code, message));
        }
        process::exit(i32::from(code));
    }
}

/// Whether standard output is a pipe that nobody reads any more.
#[cfg(unix)]
fn is_reader_gone() -> bool {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let out = std::io::stdout();
    let mut polled = [PollFd::new(&out, PollFlags::empty())];
    let ready = poll(&mut polled, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }));
    ready.is_ok_and(|n| n > 0) && polled[0].revents().intersects(PollFlags::ERR | PollFlags::HUP)
}

#[cfg(not(unix))]
fn is_reader_gone() -> bool {
    // The write itself fails there.
    false
}
