//! Temporary files beside a target: new, of a name nobody can guess, and removed by whoever comes next when a run was killed.
//!
//! Whoever writes one holds a lock on it, which the system gives back when the process ends in whatever way. So one that can be
//! locked belongs to nobody any more.

use std::{
    collections::BTreeSet,
    fs::{self, File, Metadata, TryLockError},
    io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use super::system;

const START: &str = ".arabesque-";
const END: &str = ".part";

/// Names that are tried before giving up.
const TRIES: usize = 16;

/// Most entries of a folder that are looked at for files that killed runs left.
const ENTRIES: usize = 100_000;

/// The temporary files that this process writes at present.
static WRITTEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Removes the temporary files that are being written, for whoever is about to end the process; what is written to them is lost.
pub fn abandon_writing() {
    for path in WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        // Whoever comes next removes it, should it not work now.
        let _ = fs::remove_file(path);
    }
}

/// A temporary file, removed when dropped unless it became the target.
#[derive(Debug)]
pub(super) struct Part {
    path: PathBuf,
    /// Open and locked.
    pub(super) file: File,
    is_done: bool,
}

impl Part {
    /// Creates one beside `target`; a private one while it replaces something.
    pub(super) fn create(target: &Path, private: bool) -> io::Result<Self> {
        let mut last = io::Error::from(io::ErrorKind::AlreadyExists);
        for _ in 0..TRIES {
            let path = folder(target).join(format!("{}{:016x}{END}", stem(target), random()?));
            let file = match system::create_new(&path, private) {
                Ok(file) => file,
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                    last = e;
                    continue;
                }
                Err(e) => return Err(e),
            };
            // Another run may take a file that is not locked yet for one that was left.
            let is_taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
            if !is_taken && system::is_name_of(&path, &file) {
                WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).insert(path.clone());
                return Ok(Self { path, file, is_done: false });
            }
        }
        Err(last)
    }

    /// Makes this the file at `target`, in one step.
    pub(super) fn rename(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.is_done = true;
        Ok(())
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        if !self.is_done {
            // Whoever comes next removes it, should it not work now.
            let _ = fs::remove_file(&self.path);
        }
        WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.path);
    }
}

/// The folder that `path` lies in.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// What the names of all temporary files of `target` begin with: short, however long its own name is.
fn stem(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default().as_encoded_bytes();
    let hash =
        name.iter().fold(0xcbf2_9ce4_8422_2325, |h: u64, &b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3));
    format!("{START}{hash:016x}-")
}

fn random() -> io::Result<u64> {
    getrandom::u64().map_err(io::Error::other)
}

/// Removes what killed runs left of files for these targets. What cannot be removed is left alone: it is in nobody's way.
pub(super) fn sweep(targets: &[&Path]) {
    let folders: BTreeSet<&Path> = targets.iter().map(|t| folder(t)).collect();
    let stems: BTreeSet<String> = targets.iter().map(|t| stem(t)).collect();
    for folder in folders {
        let Ok(entries) = fs::read_dir(folder) else { continue };
        for entry in entries.take(ENTRIES).flatten() {
            let name = entry.file_name();
            if name.to_str().and_then(stem_in).is_some_and(|stem| stems.contains(stem)) {
                remove_abandoned(&entry.path());
            }
        }
    }
}

/// The stem in the name of a temporary file.
fn stem_in(name: &str) -> Option<&str> {
    let (stem, random) = name.strip_suffix(END)?.split_at_checked(START.len() + 17)?;
    let is_hex = |text: &str| text.len() == 16 && text.bytes().all(|b| b.is_ascii_hexdigit());
    let hash = stem.strip_prefix(START)?.strip_suffix('-')?;
    (is_hex(hash) && is_hex(random)).then_some(stem)
}

/// Removes a temporary file that nobody writes.
fn remove_abandoned(path: &Path) {
    let is_ours = |m: &Metadata| m.is_file() && system::is_own(m);
    if !fs::symlink_metadata(path).is_ok_and(|m| is_ours(&m)) {
        return;
    }
    let Ok(file) = system::open(path, false) else { return };
    if file.try_lock().is_ok() && system::is_name_of(path, &file) {
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn what_a_killed_run_left_goes_and_what_others_write_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (mine, other) = (folder.path().join("a.svg"), folder.path().join("b.svg"));
        // A killed process drops nothing, and its lock goes with it.
        let left = |target: &Path| {
            let part = Part::create(target, false).unwrap();
            let path = part.path.clone();
            part.file.unlock().unwrap();
            std::mem::forget(part);
            path
        };
        let (abandoned, of_another_target) = (left(&mine), left(&other));
        let written = Part::create(&mine, false).unwrap();
        let stranger = folder.path().join(".arabesque-mine.part");
        fs::write(&stranger, "").unwrap();
        sweep(&[&mine]);
        assert!(!abandoned.exists());
        assert!(of_another_target.exists() && written.path.exists() && stranger.exists());
        drop(written);
        sweep(&[&mine, &other]);
        assert_eq!(count(folder.path()), 1);
    }

    #[cfg(unix)]
    #[test]
    fn planted_links_and_folders_are_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.svg");
        let precious = folder.path().join("precious");
        fs::write(&precious, "").unwrap();
        let planted = |k: u32| folder.path().join(format!("{}{k:016x}{END}", stem(&target)));
        std::os::unix::fs::symlink(&precious, planted(1)).unwrap();
        std::os::unix::fs::symlink("nowhere", planted(2)).unwrap();
        fs::create_dir(planted(3)).unwrap();
        sweep(&[&target]);
        assert_eq!(count(folder.path()), 4);
    }

    #[test]
    fn names_are_short_new_and_different() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("n".repeat(255));
        let (a, b) = (Part::create(&target, true).unwrap(), Part::create(&target, true).unwrap());
        assert_ne!(a.path, b.path);
        assert_eq!(stem_in(a.path.file_name().unwrap().to_str().unwrap()), Some(&*stem(&target)));
        for name in ["", ".part", ".arabesque-.part", ".arabesque-0123456789abcdef-0123456789abcdeg.part", "a.svg.part"]
        {
            assert_eq!(stem_in(name), None, "{name}");
        }
    }
}
