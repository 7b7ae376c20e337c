//! Errors, sorted by who must act.

use crate::text::abridged;

/// What went wrong. Every message ends with what to do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The content of a file cannot be used. The author of the file must act.
    #[error("{place}: {problem}; {advice}")]
    Input {
        /// File and place in it: `leaves.svg: layer "Exemplar"`.
        place: String,
        /// What was found, against what was expected.
        problem: String,
        /// What to do.
        advice: String,
    },
    /// A parameter is out of range or does not exist. The caller must act.
    #[error("{name} = {value}: expected {expected}")]
    Parameter {
        /// Name of the parameter as the user writes it.
        name: String,
        /// The value given.
        value: String,
        /// Allowed values, and the nearest known name where a name was mistyped.
        expected: String,
    },
    /// A limit was reached. Raise it, or make the input smaller.
    #[error("{what}: {found} is over the limit of {limit}; {advice}")]
    Limit {
        /// What was counted, and in which file.
        what: String,
        /// How much there was.
        found: String,
        /// How much is allowed.
        limit: String,
        /// What to do.
        advice: String,
    },
    /// Somebody asked to stop before there was a result.
    #[error("stopped: {stage} was not finished")]
    Stopped {
        /// What was being done.
        stage: String,
        /// Why.
        cause: crate::budget::Cause,
    },
    /// The request is understood but not handled.
    #[error("{what} is not supported; {advice}")]
    Unsupported {
        /// What was asked for.
        what: String,
        /// What works instead.
        advice: String,
    },
    /// No result exists under the given constraints.
    #[error("no valid result: {problem}; {advice}")]
    NoResult {
        /// Which constraints exclude each other.
        problem: String,
        /// What to relax.
        advice: String,
    },
    /// The operating system refused.
    #[error("{path}: {source}")]
    Io {
        /// The path.
        path: String,
        /// The system's answer.
        source: std::io::Error,
    },
}

impl Error {
    /// An [`Error::Input`].
    pub fn input(place: impl Into<String>, problem: impl Into<String>, advice: impl Into<String>) -> Self {
        Self::Input { place: place.into(), problem: problem.into(), advice: advice.into() }
    }

    /// An [`Error::Parameter`]; of a long value, head and tail are shown.
    pub fn parameter(name: impl Into<String>, value: impl ToString, expected: impl Into<String>) -> Self {
        Self::Parameter { name: name.into(), value: abridged(&value.to_string()), expected: expected.into() }
    }

    /// An [`Error::NoResult`].
    pub fn no_result(problem: impl Into<String>, advice: impl Into<String>) -> Self {
        Self::NoResult { problem: problem.into(), advice: advice.into() }
    }
}

/// Result of this library.
pub type Result<T> = std::result::Result<T, Error>;
