//! Pictures of results, which take time.

use std::{
    panic,
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::Duration,
};

use arabesque::{Artwork, Encoded, Error, OutputOptions, Result, in_pool};

use crate::process::sentinel;

/// How often somebody who may have asked to stop is listened to.
const TICK: Duration = Duration::from_millis(5);

/// The file of `artwork`, unless somebody asks to stop before it is there. The renderer hears nothing while it is at work, so that it has a
/// thread of its own, for which nobody waits then.
///
/// `None` also where the system gives no thread.
pub(crate) fn unless_asked(
    artwork: &Artwork,
    output: &OutputOptions,
    threads: Option<usize>,
) -> Option<Result<Encoded>> {
    if sentinel::signal().is_some() {
        return None;
    }
    let (done, result) = channel();
    let (artwork, output) = (artwork.clone(), output.clone());
    let draw = move || {
        let encoded = in_pool(threads, || artwork.encode(&output)).flatten();
        // Nobody waits for what comes too late.
        let _ = done.send(encoded);
    };
    let thread = thread::Builder::new().name("drawing".into()).spawn(draw).ok()?;
    loop {
        match result.recv_timeout(TICK) {
            Ok(Err(Error::Stopped { .. })) => return None,
            Ok(encoded) => return Some(encoded),
            Err(RecvTimeoutError::Timeout) if sentinel::signal().is_some() => return None,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(cause) => panic::resume_unwind(cause),
                Ok(()) => return None,
            },
        }
    }
}
