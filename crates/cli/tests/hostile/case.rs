//! One hostile run, and what must come of it.

use std::{
    fs,
    path::Path,
    process::{Command, Output, Stdio},
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use tempfile::TempDir;

/// Memory that no run may use, in bytes.
const MEMORY: u64 = 1_300_000_000;
/// Longest line that a message may have, in bytes.
const LINE: usize = 700;

/// A command with the files that it reads.
pub(crate) struct Case {
    name: String,
    files: Vec<(String, Vec<u8>)>,
    line: String,
    codes: &'static [i32],
}

/// A run that must succeed.
pub(crate) const DONE: &[i32] = &[0];
/// A misused option.
pub(crate) const USAGE: &[i32] = &[2];
/// A file that cannot be used, or a limit.
pub(crate) const REFUSED: &[i32] = &[3];
/// Nothing that could be made.
pub(crate) const NOTHING: &[i32] = &[4];
/// A run that may succeed or not, as long as it says so.
pub(crate) const EITHER: &[i32] = &[0, 3, 4];

impl Case {
    /// A case whose command reads no other file than those added later; `OUT` in `line` stands for the result.
    pub(crate) fn new(name: impl Into<String>, line: impl Into<String>, codes: &'static [i32]) -> Self {
        Self { name: name.into(), files: Vec::new(), line: line.into(), codes }
    }

    /// The same with a file.
    pub(crate) fn with(mut self, name: &str, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((name.into(), content.into()));
        self
    }

    /// Fills a page with the drawing of the case.
    pub(crate) fn fill(name: impl Into<String>, svg: impl Into<Vec<u8>>, codes: &'static [i32]) -> Self {
        Self::new(name, "fill in.svg --size 200x200 -o out.svg", codes).with("in.svg", svg)
    }

    /// What is wrong with the outcome, if anything is.
    fn fault(&self) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in &self.files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        let before = names(&folder);
        // Less work than usual, so that what is ended by its limit is ended soon; large pictures take some to be read.
        let output = Command::new(env!("CARGO_BIN_EXE_arabesque"))
            .args(self.line.split_whitespace())
            .arg("--json")
            .args(["--limit", if self.line.contains("p.png") { "work=1500" } else { "work=500" }])
            .args(if self.line.contains("work-per-element") { &[][..] } else { &["--limit", "work-per-element=1"] })
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        self.judge(&output, &before, &folder).err().map(|fault| {
            let told = String::from_utf8_lossy(&output.stderr).chars().take(1000).collect::<String>();
            format!("{}: {fault}\n  arabesque {}\n  {told}", self.name, self.line)
        })
    }

    fn judge(&self, output: &Output, before: &[String], folder: &TempDir) -> Result<(), String> {
        let told = String::from_utf8_lossy(&output.stderr);
        let code = output.status.code().ok_or_else(|| format!("ended by {}", output.status))?;
        if !self.codes.contains(&code) {
            return Err(format!("exit code {code}, expected one of {:?}", self.codes));
        }
        if told.contains("panicked") {
            return Err("a panic".into());
        }
        if let Some(line) = told.lines().find(|line| line.len() > LINE) {
            return Err(format!("a line of {} bytes", line.len()));
        }
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).map_err(|e| format!("no JSON: {e}"))?;
        let memory = value.pointer("/outputs/0/memory").or_else(|| value.pointer("/error/memory"));
        let memory = memory.and_then(serde_json::Value::as_u64).unwrap_or(0);
        if memory > MEMORY {
            return Err(format!("{memory} bytes of memory"));
        }
        let after = names(folder);
        let new: Vec<_> = after.iter().filter(|name| !before.contains(name)).collect();
        match code {
            0 if self.line.starts_with("inspect") => Ok(()),
            0 if new.len() == 1 && size(&folder.path().join(new[0])) > 0 => Ok(()),
            0 => Err(format!("expected one new file, found {new:?}")),
            _ if !told.lines().any(|line| line.starts_with("arabesque: error: ") || line.starts_with("error: ")) => {
                Err("no reason was told".into())
            }
            _ if new.is_empty() => Ok(()),
            _ => Err(format!("left {new:?} behind")),
        }
    }
}

fn names(folder: &TempDir) -> Vec<String> {
    let entries = fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn size(path: &Path) -> u64 {
    fs::metadata(path).unwrap().len()
}

/// Runs all cases, two at a time, and tells all that went wrong.
pub(crate) fn check_all(cases: Vec<Case>) {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut faults = Vec::new();
        while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            faults.extend(case.fault());
        }
        faults
    };
    let faults: Vec<String> = thread::scope(|scope| {
        let workers = [scope.spawn(work), scope.spawn(work)];
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    assert!(faults.is_empty(), "{} of {} cases:\n{}", faults.len(), cases.len(), faults.join("\n"));
}

/// A drawing with a page of 120 x 120.
pub(crate) fn page(body: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 120 120'>{body}</svg>")
}

/// Thirty-six dots in rows, five in radius and twenty apart.
pub(crate) fn dots() -> String {
    let dot = |k: u32| format!("<circle cx='{}' cy='{}' r='5'/>", 10 + k / 6 * 20, 10 + k % 6 * 20);
    (0..36).map(dot).collect()
}

/// A page of dots, with more on it.
pub(crate) fn dots_and(more: &str) -> String {
    page(&(dots() + more))
}
