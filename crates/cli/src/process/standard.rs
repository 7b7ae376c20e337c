//! Standard output, for texts and summaries.

use std::io::{self, ErrorKind, StdoutLock};

use super::closed::is_standard_output_closed;

/// Standard output, if anything is behind it.
pub(crate) fn output() -> io::Result<StdoutLock<'static>> {
    check()?;
    Ok(io::stdout().lock())
}

/// Refuses a standard output that is closed.
pub(crate) fn check() -> io::Result<()> {
    if is_standard_output_closed() {
        let text = "it is closed; name a file, or /dev/null for no result at all";
        return Err(io::Error::new(ErrorKind::NotConnected, text));
    }
    Ok(())
}
