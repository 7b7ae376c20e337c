//! Standard output, for texts and summaries.

use std::io::{self, ErrorKind, StdoutLock};

use arabesque::io::file;

/// Standard output, if anything is behind it.
pub(crate) fn output() -> io::Result<StdoutLock<'static>> {
    if file::standard_output_is_open() {
        return Ok(io::stdout().lock());
    }
    Err(io::Error::new(ErrorKind::NotConnected, "it is closed"))
}
