//! Messages to people, on standard error.

use std::io::{IsTerminal, Write};

use arabesque::Warning;

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    /// Errors alone.
    Quiet,
    /// What was written, and warnings.
    Normal,
    /// What was understood, and how the run went.
    Verbose,
}

/// Whether standard error is a terminal that wants colours.
fn is_colourful() -> bool {
    let wanted = std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty());
    wanted && is_terminal()
}

/// Whether somebody watches standard error.
pub(crate) fn is_terminal() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|t| t != "dumb")
}

/// The style of a progress bar that suits the terminal.
pub(crate) fn bar_style() -> &'static str {
    if is_colourful() { "{bar:24.cyan/blue}" } else { "{bar:24}" }
}

fn line(label: &str, code: &str, message: &str) {
    let label =
        if is_colourful() && !label.is_empty() { format!("\x1b[1;{code}m{label}\x1b[0m") } else { label.to_owned() };
    // Nobody is left to be told when standard error is gone.
    let _ = writeln!(std::io::stderr().lock(), "arabesque: {label}{message}");
}

/// Tells why the program ends, past whoever else may be writing just now.
pub(crate) fn last_words(message: &str) {
    let clear = if is_terminal() { "\r\x1b[K" } else { "" };
    let text = format!("{clear}arabesque: error: {message}\n");
    #[cfg(unix)]
    let _ = rustix::io::write(rustix::stdio::stderr(), text.as_bytes());
    #[cfg(not(unix))]
    let _ = std::io::stderr().write_all(text.as_bytes());
}

pub(crate) fn error(message: &str) {
    line("error: ", "31", message);
}

pub(crate) fn warning(warning: &Warning) {
    line("warning: ", "33", &format!("{}; {}", warning.message, warning.advice));
}

pub(crate) fn note(message: &str) {
    line("", "0", message);
}
