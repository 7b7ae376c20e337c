//! Failures with their exit codes.

use std::{io, process::ExitCode};

use arabesque::Error;

use crate::say;

/// Anything that went wrong on the way.
pub(crate) const FAILURE: u8 = 1;
/// The command line asks for something that does not exist.
pub(crate) const USAGE: u8 = 2;
/// A file cannot be used.
pub(crate) const BAD_INPUT: u8 = 3;
/// The constraints exclude every result.
pub(crate) const NO_RESULT: u8 = 4;
/// Stopped by Ctrl-C, where signals have no numbers.
#[cfg(not(unix))]
pub(crate) const INTERRUPTED: u8 = 130;

/// Why the program ends early, and with which exit code.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    cause: anyhow::Error,
    /// Whether it is about a text for people, of which they may read as much as they like.
    is_of_text: bool,
}

impl Failure {
    /// The command line contradicts itself.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::of(USAGE, anyhow::Error::msg(message.into()))
    }

    /// A result could not be written.
    pub(crate) fn writing(error: Error) -> Self {
        Self::of(FAILURE, anyhow::Error::new(error).context("cannot write the result"))
    }

    /// A summary for machines could not be written.
    pub(crate) fn summary(error: io::Error) -> Self {
        Self::of(FAILURE, anyhow::Error::new(error).context("cannot write the summary: standard output"))
    }

    /// Standard output cannot take what would go there.
    pub(crate) fn standard(error: io::Error) -> Self {
        Self::of(FAILURE, anyhow::Error::new(error).context("cannot write the result: standard output"))
    }

    /// Something would be lost.
    pub(crate) fn refused(message: impl Into<String>) -> Self {
        Self::of(FAILURE, anyhow::Error::msg(message.into()))
    }

    fn of(code: u8, cause: anyhow::Error) -> Self {
        Self { code, cause, is_of_text: false }
    }

    /// A failure with an exit code of its own.
    pub(crate) fn with(code: u8, message: &str) -> Self {
        Self::of(code, anyhow::Error::msg(message.to_owned()))
    }

    /// The same failure with its reason.
    pub(crate) fn because(self, reason: &'static str) -> Self {
        Self { cause: self.cause.context(reason), ..self }
    }

    /// The same failure under another exit code.
    pub(crate) fn with_code(self, code: u8) -> Self {
        Self { code, ..self }
    }

    pub(crate) fn code(&self) -> u8 {
        self.code
    }

    /// Whether whoever read a text has seen enough of it, which is no failure. A result that was not read to its end is one.
    fn is_read_enough(&self) -> bool {
        let system = |e: &io::Error| e.kind() == io::ErrorKind::BrokenPipe;
        self.is_of_text && self.cause.chain().any(|c| c.downcast_ref::<io::Error>().is_some_and(system))
    }

    /// The chain of causes on one line.
    pub(crate) fn message(&self) -> String {
        let mut message = String::new();
        for cause in self.cause.chain() {
            let text = cause.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            // Some errors repeat their cause in their own words.
            if message.is_empty() {
                message = text;
            } else if !message.contains(&text) {
                message = format!("{message}: {text}");
            }
        }
        shortened(message)
    }

    /// Tells the user and gives the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        if self.is_read_enough() {
            return ExitCode::SUCCESS;
        }
        say::error(&self.message());
        ExitCode::from(self.code)
    }
}

/// Longest message, in characters.
const LONGEST: usize = 600;

/// Digits in a row beyond which a number tells no more.
const DIGITS: usize = 24;

/// The same without the rest of numbers that are longer than anybody reads. Names of files stay whole.
fn without_long_numbers(message: &str) -> String {
    let mut out = String::with_capacity(message.len());
    for word in message.split_inclusive(char::is_whitespace) {
        let mut run = 0;
        for c in word.chars() {
            run = if c.is_ascii_digit() && !is_name(word) { run + 1 } else { 0 };
            match run {
                n if n <= DIGITS => out.push(c),
                n if n == DIGITS + 1 => out.push_str("..."),
                _ => {}
            }
        }
    }
    out
}

/// Whether a word looks like the name of a file: a path, or one with an extension.
fn is_name(word: &str) -> bool {
    let bare = word.trim_end_matches(|c: char| !c.is_alphanumeric());
    let extension = |(_, end): (&str, &str)| !end.is_empty() && end.len() <= 4 && end.chars().all(char::is_alphabetic);
    word.contains(['/', '\\']) || bare.rsplit_once('.').is_some_and(extension)
}

/// The same with what would move or colour the text of a terminal shown as it is written in strings: names of files may hold it.
fn without_controls(message: &str) -> String {
    let mut out = String::with_capacity(message.len());
    for c in message.chars() {
        match c {
            '\n' | '\t' => out.push(c),
            c if c.is_control() => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// A message that fits a few lines: names and numbers come from outside, and may be of any length.
fn shortened(message: String) -> String {
    let message = without_controls(&without_long_numbers(&message));
    let count = message.chars().count();
    if count <= LONGEST {
        return message;
    }
    let head = message.chars().take(LONGEST / 2);
    head.chain(" ... ".chars()).chain(message.chars().skip(count - LONGEST / 2)).collect()
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let code = match &error {
            Error::Parameter { .. } => USAGE,
            Error::Input { .. } | Error::Limit { .. } | Error::Unsupported { .. } | Error::Io { .. } => BAD_INPUT,
            Error::NoResult { .. } | Error::Stopped { .. } => NO_RESULT,
            _ => FAILURE,
        };
        Self::of(code, anyhow::Error::new(error))
    }
}

impl From<io::Error> for Failure {
    /// A text for people could not be written to standard output.
    fn from(error: io::Error) -> Self {
        Self { is_of_text: true, ..Self::of(FAILURE, anyhow::Error::new(error).context("standard output")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_stand_on_one_line_and_once() {
        let source = io::Error::from(io::ErrorKind::NotFound);
        let failure = Failure::writing(Error::Io { path: "a/b.svg".into(), source });
        assert_eq!(failure.message(), "cannot write the result: a/b.svg: entity not found");
        assert_eq!(failure.code(), FAILURE);
    }

    #[test]
    fn codes_follow_who_must_act() {
        assert_eq!(Failure::from(Error::parameter("seed", -1, "more")).code(), USAGE);
        assert_eq!(Failure::from(Error::input("f", "p", "a")).code(), BAD_INPUT);
        assert_eq!(Failure::from(Error::no_result("p", "a")).code(), NO_RESULT);
    }

    #[test]
    fn texts_may_be_cut_and_results_may_not() {
        let broken = || io::Error::from(io::ErrorKind::BrokenPipe);
        assert_eq!(Failure::from(broken()).report(), ExitCode::SUCCESS);
        assert_eq!(Failure::summary(broken()).report(), ExitCode::from(FAILURE));
        let result = Failure::writing(Error::Io { path: "standard output".into(), source: broken() });
        assert_eq!(result.report(), ExitCode::from(FAILURE));
    }

    #[test]
    fn messages_of_any_length_fit_a_few_lines() {
        let message = Failure::usage("é".repeat(100_000)).message();
        assert!(message.chars().count() <= LONGEST + 5, "{}", message.chars().count());
        let number = format!("border = 1{}.5 and so on", "0".repeat(308));
        let message = Failure::usage(number).message();
        assert_eq!(message, format!("border = 1{}....5 and so on", "0".repeat(DIGITS - 1)));
        assert_eq!(Failure::usage("a\u{1b}[31m.svg: no element").message(), "a\\u{1b}[31m.svg: no element");
        for name in [format!("{}.svg: no element", "7".repeat(40)), format!("a/{}: not there", "7".repeat(40))] {
            assert_eq!(Failure::usage(name.clone()).message(), name);
        }
    }
}
