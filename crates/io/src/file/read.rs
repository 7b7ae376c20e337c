//! Reading: regular files and what the caller opened, up to a limit; nothing that could let the program wait for ever.

use std::{
    fs::{File, Metadata},
    io::{ErrorKind, Read},
    path::Path,
    time::SystemTime,
};

use arabesque_core::{Budget, Error, Limits, Result};

use super::{
    stream::{is_standard_input, is_stream},
    system,
};

/// Bytes that are read between two questions whether to stop.
const CHUNK: u64 = 1 << 18;
/// What is too much of a file.
const SIZE: &str = "size of the file";

/// Reads a file, or standard input for `-`.
///
/// # Errors
/// [`Error::Io`] when the system refuses, [`Error::Limit`] when there are more than [`arabesque_core::Limits::file_bytes`] bytes,
/// [`Error::Input`] when there is no such file, for folders, pipes, devices and sockets, and when the file changes while it is read,
/// [`Error::Stopped`] when somebody asks to stop, also while nothing comes from standard input.
pub fn read_bytes(path: &str, budget: &Budget) -> Result<Vec<u8>> {
    if is_standard_input(path) {
        let stdin = std::io::stdin();
        return take("standard input", 0, stdin.lock(), &|| system::wait_for_input(&stdin), budget);
    }
    let fail = |source| Error::Io { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(|e| missing_or(path, e))?;
    // Before it is opened: opening a device can do things.
    check_kind(path, &metadata)?;
    let file = system::open(Path::new(path), true).map_err(|e| missing_or(path, e))?;
    let before = file.metadata().map_err(fail)?;
    check_kind(path, &before)?;
    if system::kind(&before).is_some() {
        system::wait_again(&file).map_err(fail)?;
        return take(path, 0, &file, &|| system::wait_for_input(&file), budget);
    }
    if before.len() > budget.limits().file_bytes as u64 {
        return Err(too_large(path, SIZE, Some(before.len()), budget));
    }
    let bytes = take(path, before.len(), &file, &|| Ok(true), budget)?;
    check_unchanged(path, &before, &file, bytes.len() as u64)?;
    Ok(bytes)
}

/// Everything that comes from `source`, `expected` bytes or so, within the limit. `wait` waits a moment for more and says whether some is there.
fn take(
    name: &str,
    expected: u64,
    mut source: impl Read,
    wait: &dyn Fn() -> std::io::Result<bool>,
    budget: &Budget,
) -> Result<Vec<u8>> {
    let fail = |source| Error::Io { path: name.to_owned(), source };
    let budget = budget.stage("reading");
    let most = budget.limits().file_bytes as u64;
    let (mut bytes, _held) = budget.list(name, (expected.min(most) + CHUNK) as usize)?;
    loop {
        budget.check()?;
        if !wait().map_err(fail)? {
            continue;
        }
        let room = most.saturating_add(1) - bytes.len() as u64;
        if room == 0 {
            return Err(too_large(name, SIZE, None, &budget));
        }
        // One call: what comes from a pipe is taken as it comes, so that nothing waits for a whole chunk.
        let old = bytes.len();
        bytes.resize(old + CHUNK.min(room) as usize, 0);
        let count = match source.read(&mut bytes[old..]) {
            Err(e) if e.kind() == ErrorKind::Interrupted => {
                bytes.truncate(old);
                continue;
            }
            other => other.map_err(fail)?,
        };
        bytes.truncate(old + count);
        if count == 0 {
            return Ok(bytes);
        }
    }
}

/// More bytes of a file, called `what`, than the limit; `all` of them, where their number is known.
pub(super) fn too_large(name: &str, what: &str, all: Option<u64>, budget: &Budget) -> Error {
    let most = budget.limits().file_bytes;
    let enough = all.map_or(2.0 * most as f64, |all| all as f64);
    Error::Limit {
        what: format!("{name}: {what}"),
        found: all.map_or(format!("more than {most} bytes"), |all| format!("{all} bytes")),
        limit: format!("{most} bytes"),
        advice: format!("use a smaller file{}", Limits::raising("file-bytes", enough)),
    }
}

/// What the system says of a file that cannot be opened, in plain words where it is missing.
fn missing_or(path: &str, source: std::io::Error) -> Error {
    match source.kind() {
        ErrorKind::NotFound if path.is_empty() => {
            Error::input("\"\"", "an empty name, where a file was expected", "name a file")
        }
        ErrorKind::NotFound => Error::input(path, "no such file", "name a file that is there"),
        _ => Error::Io { path: path.to_owned(), source },
    }
}

/// Refuses what is no regular file, unless the caller opened it.
fn check_kind(path: &str, metadata: &Metadata) -> Result<()> {
    let Some(kind) = system::kind(metadata) else { return Ok(()) };
    if is_stream(path) && !metadata.is_dir() {
        return Ok(());
    }
    let advice = match kind {
        "a folder" => "name a file in it",
        _ => "save its content in a file, or pass it on standard input as -",
    };
    Err(Error::input(path, format!("{kind}, where a regular file was expected"), advice))
}

/// Refuses a file that was written to while it was read: what was read may be half of the old and half of the new.
fn check_unchanged(path: &str, before: &Metadata, file: &File, read: u64) -> Result<()> {
    let stamp = |m: &Metadata| (m.len(), m.modified().unwrap_or(SystemTime::UNIX_EPOCH));
    let after = file.metadata().map_err(|source| Error::Io { path: path.to_owned(), source })?;
    // Files that the system makes up on reading, as below /proc, say that they are empty.
    if stamp(before) == stamp(&after) && (read == after.len() || after.len() == 0) {
        return Ok(());
    }
    Err(Error::input(path, "the file changed while it was read", "run again once it is written completely"))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn refused(path: &Path) -> String {
        read_bytes(path.to_str().unwrap(), &Budget::default()).unwrap_err().to_string()
    }

    #[test]
    fn what_is_missing_or_too_large_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.svg");
        assert!(refused(&file).contains("a.svg: no such file"), "{}", refused(&file));
        assert!(refused(Path::new("")).contains("empty name"));
        fs::write(&file, "12345").unwrap();
        let read =
            |file_bytes| read_bytes(file.to_str().unwrap(), &Budget::new(Limits { file_bytes, ..Limits::default() }));
        assert_eq!(read(5).unwrap(), b"12345");
        assert!(matches!(read(4), Err(Error::Limit { .. })));
    }

    #[test]
    fn what_is_no_regular_file_is_refused_by_its_kind() {
        let folder = tempfile::tempdir().unwrap();
        assert!(refused(folder.path()).contains("a folder"));
        #[cfg(unix)]
        {
            let at = |name: &str| folder.path().join(name);
            let _socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
            assert!(refused(&at("socket")).contains("a socket"), "{}", refused(&at("socket")));
            for device in ["/dev/null", "/dev/zero", "/dev/tty"] {
                assert!(refused(Path::new(device)).contains("a device"), "{}", refused(Path::new(device)));
            }
            std::os::unix::fs::symlink("/dev/zero", at("link")).unwrap();
            assert!(refused(&at("link")).contains("a device"));
            rustix::fs::mkfifoat(rustix::fs::CWD, at("pipe"), rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR).unwrap();
            assert!(refused(&at("pipe")).contains("a named pipe"), "{}", refused(&at("pipe")));
        }
    }

    #[cfg(unix)]
    #[test]
    fn whoever_waits_for_input_can_be_stopped() {
        let (reader, _writer) = std::io::pipe().unwrap();
        let budget = Budget::stopping_at(Limits::default(), 3);
        let read = take("pipe", 0, &reader, &|| system::wait_for_input(&reader), &budget);
        assert!(matches!(read, Err(Error::Stopped { .. })));
    }

    #[test]
    fn a_change_while_reading_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "12345").unwrap();
        let file = File::open(&path).unwrap();
        let before = file.metadata().unwrap();
        assert!(check_unchanged("a", &before, &file, 5).is_ok());
        assert!(check_unchanged("a", &before, &file, 4).is_err());
        fs::write(&path, "123456").unwrap();
        assert!(check_unchanged("a", &before, &file, 5).unwrap_err().to_string().contains("changed while"));
    }
}
