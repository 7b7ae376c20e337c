//! The machine-readable summary of `--json`.

use std::{
    io::Write,
    sync::atomic::{AtomicBool, Ordering},
};

use arabesque::{Summary, Warning};
use serde::Serialize;

use crate::{
    failure::Failure,
    process::{memory, standard},
};

/// What a command made.
#[derive(Debug, Serialize)]
pub(crate) struct Outputs {
    pub(crate) version: &'static str,
    pub(crate) outputs: Vec<Output>,
}

/// One file that was written.
#[derive(Debug, Serialize)]
pub(crate) struct Output {
    pub(crate) path: String,
    pub(crate) format: &'static str,
    pub(crate) seed: u64,
    #[serde(flatten)]
    pub(crate) made: Summary,
    /// `finished`, `interrupted`, `time limit` or `limit`.
    pub(crate) stopped: &'static str,
    pub(crate) seconds: f64,
    /// Millions of units of work that the run has done.
    pub(crate) work: u64,
    /// Bytes that were in use at most, by everything so far.
    pub(crate) memory: usize,
    pub(crate) warnings: Vec<Warning>,
}

/// Whether something was written for machines.
static TOLD: AtomicBool = AtomicBool::new(false);

/// Whether [`print`] was called.
pub(crate) fn is_told() -> bool {
    TOLD.load(Ordering::SeqCst)
}

/// Writes `value` to standard output as JSON.
pub(crate) fn print(value: &impl Serialize) -> Result<(), Failure> {
    TOLD.store(true, Ordering::SeqCst);
    let text = serde_json::to_string_pretty(value).map_err(|e| Failure::summary(e.into()))?;
    let written = standard::output().and_then(|mut out| writeln!(out, "{text}").and_then(|()| out.flush()));
    written.map_err(Failure::summary)
}

/// [`print`], with the bytes that were in use at most.
pub(crate) fn print_with_memory(told: &impl Serialize) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct WithMemory<'a, T> {
        #[serde(flatten)]
        told: &'a T,
        memory: usize,
    }
    print(&WithMemory { told, memory: memory::peak() })
}

/// Tells a machine about a failure, where it asked for JSON.
pub(crate) fn print_failure(failure: &Failure) {
    let value = serde_json::json!({ "error": { "code": failure.code(), "message": failure.message(), "memory": memory::peak() } });
    // The failure itself is reported in any case.
    let _ = print(&value);
}
