//! Signals that ask the program to stop.

#[cfg(unix)]
pub(crate) use unix::Signals;

#[cfg(not(unix))]
pub(crate) use other::Signals;

#[cfg(unix)]
mod unix {
    use signal_hook::{
        consts::{SIGHUP, SIGINT, SIGTERM},
        iterator,
    };

    /// Signals as they come.
    pub(crate) struct Signals(Option<iterator::Signals>);

    impl Signals {
        /// From here on signals are collected. Those that whoever started the program wants ignored stay so: `nohup` does that.
        pub(crate) fn listen() -> Self {
            let wanted = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| !is_ignored(*signal));
            // Without a handler a signal ends the program at once, which leaves no half file either.
            Self(iterator::Signals::new(wanted).ok())
        }

        /// Exit codes of the signals that came since the last call.
        pub(crate) fn pending(&mut self) -> impl Iterator<Item = u8> {
            let signals = self.0.as_mut().map(|signals| signals.pending().collect::<Vec<_>>());
            signals.into_iter().flatten().filter_map(|signal| u8::try_from(128 + signal).ok())
        }
    }

    /// Whether a signal is ignored by inheritance, where the system tells.
    fn is_ignored(signal: i32) -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
        mask >> (signal - 1) & 1 == 1
    }
}

#[cfg(not(unix))]
mod other {
    use std::sync::atomic::{AtomicU8, Ordering};

    use crate::failure::INTERRUPTED;

    static PRESSED: AtomicU8 = AtomicU8::new(0);

    /// Presses of Ctrl-C.
    pub(crate) struct Signals;

    impl Signals {
        /// From here on Ctrl-C is collected.
        pub(crate) fn listen() -> Self {
            // Without a handler Ctrl-C ends the program at once, which leaves no half file either.
            let _ = ctrlc::set_handler(|| {
                PRESSED.fetch_add(1, Ordering::SeqCst);
            });
            Self
        }

        /// Exit codes of what was pressed since the last call.
        pub(crate) fn pending(&mut self) -> impl Iterator<Item = u8> {
            (0..PRESSED.swap(0, Ordering::SeqCst)).map(|_| INTERRUPTED)
        }
    }
}
