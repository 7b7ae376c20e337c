//! Where a result goes: looked at before the work, written whole or not at all after it.

use std::{
    fs, io,
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::SystemTime,
};

use arabesque_core::{Error, Result};

use super::{
    copy,
    part::{self, Part},
    stream::{is_standard_output, is_stream},
    system,
};

/// Bytes that are handed to the system at a time.
const CHUNK: usize = 1 << 20;

/// Where a result will be written: checked before the work, written in one go after it.
#[derive(Debug)]
pub struct Target {
    path: PathBuf,
    kind: Kind,
    /// What lay there when it was last looked at.
    seen: Mutex<Option<Stamp>>,
    keeps_copy: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Standard,
    /// A regular file, or nothing yet: replaced by renaming.
    Replaced,
    /// A device or a pipe, which cannot be replaced.
    Direct,
}

/// How writing goes on, for whoever watches it: every step after which a process may end, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The temporary file is there, empty.
    Created,
    /// So many bytes are in it.
    Written(usize),
    /// It has the permissions and the owner of what it replaces.
    Dressed,
    /// It is on the disk.
    Synced,
    /// A copy of what it replaces is kept, where that was asked for.
    Kept,
    /// It has the name of the target.
    Renamed,
}

/// What tells one state of a file from another.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp(u64, SystemTime);

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let metadata = fs::symlink_metadata(path).ok().filter(|m| !m.is_dir())?;
        Some(Self(metadata.len(), metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH)))
    }
}

impl Target {
    /// Checks that a file can be written at `path`; `-` is standard output. What runs that were killed have left beside it goes.
    ///
    /// # Errors
    /// [`Error::Io`] when the folder is missing or not writable, when `path` is empty, a folder, a link to nothing or a disk, and
    /// when standard output is closed.
    pub fn new(path: &str) -> Result<Self> {
        let target = Self::checked(path)?;
        part::sweep(&target.replaced().into_iter().collect::<Vec<_>>());
        Ok(target)
    }

    /// The same for many files at once: each folder is looked through once.
    ///
    /// # Errors
    /// As [`Target::new`].
    pub fn all(paths: &[String]) -> Result<Vec<Self>> {
        let targets = paths.iter().map(|path| Self::checked(path)).collect::<Result<Vec<_>>>()?;
        part::sweep(&targets.iter().filter_map(Self::replaced).collect::<Vec<_>>());
        Ok(targets)
    }

    fn checked(path: &str) -> Result<Self> {
        let fail = |source| Error::Io { path: path.to_owned(), source };
        if is_standard_output(path) {
            return Ok(Self::at(path.into(), Kind::Standard));
        }
        check_name(path)?;
        let (real, kind) = resolved(path).map_err(fail)?;
        let target = Self::at(real, kind);
        if let Some(path) = target.replaced() {
            Part::create(path, true).map_err(|e| fail(beside(e)))?;
        }
        Ok(target)
    }

    fn at(path: PathBuf, kind: Kind) -> Self {
        let seen = if kind == Kind::Replaced { Stamp::of(&path) } else { None };
        Self { path, kind, seen: Mutex::new(seen), keeps_copy: false }
    }

    /// The regular file that is replaced, whether there is one already or not.
    fn replaced(&self) -> Option<&Path> {
        (self.kind == Kind::Replaced).then_some(&*self.path)
    }

    /// The regular file that lies there already and has something in it, with all links resolved.
    pub fn existing(&self) -> Option<&Path> {
        self.replaced().filter(|path| fs::metadata(path).is_ok_and(|m| m.len() > 0))
    }

    /// The same, with a copy of what it replaces kept beside it: `NAME.orig`, or `NAME.orig.1` and so on.
    #[must_use]
    pub fn keeping_copy(self) -> Self {
        Self { keeps_copy: true, ..self }
    }

    /// Writes everything: to a file beside the target that is renamed once it is complete and on the disk. The new file has the
    /// permissions of the one that it replaces, and its owner where that is allowed; other hard links to that one keep the old
    /// content.
    ///
    /// Returns where a copy of what was there is kept: as asked for, and when somebody else has written there since this was made.
    ///
    /// # Errors
    /// [`Error::Io`] when the system refuses; the target is then as it was before.
    pub fn write(&self, bytes: &[u8]) -> Result<Option<PathBuf>> {
        self.write_watched(bytes, &mut |_| Ok(()))
    }

    /// The same, step by step, for tests of what is left when the process ends or the system refuses in between.
    ///
    /// # Errors
    /// As [`Target::write`], and what `watch` returns.
    pub fn write_watched(
        &self,
        bytes: &[u8],
        watch: &mut dyn FnMut(Step) -> io::Result<()>,
    ) -> Result<Option<PathBuf>> {
        let fail = |source| Error::Io { path: self.path.display().to_string(), source };
        match self.kind {
            Kind::Standard => {
                let mut out = io::stdout().lock();
                out.write_all(bytes).and_then(|()| out.flush()).map_err(|source| standard(explained(source)))?;
                Ok(None)
            }
            Kind::Direct => {
                let written = system::open_to_write(&self.path).and_then(|mut file| file.write_all(bytes));
                written.map_err(|source| fail(explained(source)))?;
                Ok(None)
            }
            Kind::Replaced => self.replace(bytes, watch).map_err(fail),
        }
    }

    fn replace(&self, bytes: &[u8], watch: &mut dyn FnMut(Step) -> io::Result<()>) -> io::Result<Option<PathBuf>> {
        let there = fs::symlink_metadata(&self.path).ok();
        let mut part = Part::create(&self.path, there.is_some())?;
        watch(Step::Created)?;
        let mut written = 0;
        for chunk in bytes.chunks(CHUNK) {
            part.file.write_all(chunk)?;
            written += chunk.len();
            watch(Step::Written(written))?;
        }
        if let Some(old) = there.filter(fs::Metadata::is_file) {
            system::dress(&part.file, &old)?;
        }
        watch(Step::Dressed)?;
        part.file.sync_all()?;
        watch(Step::Synced)?;
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Stamp::of(&self.path);
        let is_changed = now.as_ref().is_some_and(|stamp| stamp.0 > 0) && now != *seen;
        // Two runs of the same command at once write the same.
        let is_foreign = is_changed && !holds(&self.path, bytes);
        let copy = if now.is_some() && (self.keeps_copy || is_foreign) { Some(copy::keep(&self.path)?) } else { None };
        watch(Step::Kept)?;
        part.rename(&self.path)?;
        *seen = Stamp::of(&self.path);
        watch(Step::Renamed)?;
        // The name is on the disk once the folder is; systems that cannot do that have the file itself there.
        let _ = fs::File::open(part::folder(&self.path)).and_then(|folder| folder.sync_all());
        Ok(copy)
    }
}

/// What the system says of a temporary file, for those who know of none.
fn beside(source: io::Error) -> io::Error {
    if source.kind() != ErrorKind::PermissionDenied {
        return source;
    }
    let text =
        format!("{source}; name a place in a folder that you may write to: a result is written beside its place first");
    io::Error::new(ErrorKind::PermissionDenied, text)
}

/// Whether the file has exactly this content.
fn holds(path: &Path, bytes: &[u8]) -> bool {
    let is_as_long = fs::symlink_metadata(path).is_ok_and(|m| m.is_file() && m.len() == bytes.len() as u64);
    is_as_long && fs::read(path).is_ok_and(|there| there == bytes)
}

/// Refuses names that no file can have.
fn check_name(path: &str) -> Result<()> {
    let refuse = |path: &str, kind, text: &str| Error::Io { path: path.to_owned(), source: io::Error::new(kind, text) };
    if path.is_empty() {
        let text = "an empty name; name a file, or - for standard output";
        return Err(refuse("\"\"", ErrorKind::InvalidInput, text));
    }
    if path.ends_with(std::path::is_separator) || Path::new(path).file_name().is_none() {
        return Err(refuse(path, ErrorKind::IsADirectory, "the name of a folder; name a file in it"));
    }
    Ok(())
}

/// The place itself behind all links, and how it is written.
fn resolved(path: &str) -> io::Result<(PathBuf, Kind)> {
    let given = Path::new(path);
    let metadata = match fs::metadata(given) {
        Ok(metadata) => metadata,
        Err(e) if e.kind() == ErrorKind::NotFound => {
            if fs::symlink_metadata(given).is_ok() {
                let text = "a link that leads nowhere; remove it, or create the folder it leads to";
                return Err(io::Error::new(ErrorKind::NotFound, text));
            }
            // The folder is where it is, whatever becomes of links to it in the meantime.
            let folder = fs::canonicalize(part::folder(given)).map_err(|e| match e.kind() {
                ErrorKind::NotFound => {
                    io::Error::new(ErrorKind::NotFound, "its folder is not there; create it, or name another place")
                }
                _ => e,
            })?;
            return Ok((folder.join(given.file_name().unwrap_or_default()), Kind::Replaced));
        }
        Err(e) => return Err(e),
    };
    match system::kind(&metadata) {
        Some("a folder") => Err(io::Error::new(ErrorKind::IsADirectory, "a folder; name a file in it")),
        Some(kind @ ("a disk" | "a socket")) => {
            Err(io::Error::new(ErrorKind::InvalidInput, format!("{kind}; name a file")))
        }
        Some(_) => Ok((given.to_owned(), Kind::Direct)),
        // The caller opened it, and wants the content in it rather than beside it.
        None if is_stream(path) => Ok((given.to_owned(), Kind::Direct)),
        None if metadata.permissions().readonly() => Err(ErrorKind::PermissionDenied.into()),
        None => Ok((fs::canonicalize(given)?, Kind::Replaced)),
    }
}

fn standard(source: io::Error) -> Error {
    Error::Io { path: "standard output".to_owned(), source }
}

/// What the system says of pipes, in plain words.
fn explained(source: io::Error) -> io::Error {
    /// The number of "no such device or address", which opening a pipe gives that nobody reads.
    const NOBODY: i32 = 6;
    if source.kind() == ErrorKind::BrokenPipe {
        return io::Error::new(ErrorKind::BrokenPipe, "the reader has gone away before everything was written");
    }
    if cfg!(unix) && source.raw_os_error() == Some(NOBODY) {
        return io::Error::new(ErrorKind::NotConnected, "a pipe that nobody reads");
    }
    source
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &Path) -> String {
        Target::new(path.to_str().unwrap()).unwrap_err().to_string()
    }

    #[test]
    fn a_missing_folder_is_noticed_before_the_work() {
        assert!(matches!(Target::new("/nonexistent-folder/x.svg"), Err(Error::Io { .. })));
        assert!(matches!(Target::new("/"), Err(Error::Io { .. })));
        assert!(refused(Path::new("")).contains("empty name"));
        for folder in ["new/", ".", ".."] {
            assert!(refused(Path::new(folder)).contains("folder"), "{folder}");
        }
    }

    #[test]
    fn writing_replaces_the_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").unwrap();
        let target = Target::new(path.to_str().unwrap()).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        // A target may be written as often as wanted.
        for text in ["new", "newer"] {
            assert_eq!(target.write(text.as_bytes()).unwrap(), None);
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn copies_are_kept_where_asked_for_and_of_what_came_in_between() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        let copy = |k: &str| folder.path().join(format!("out.txt.orig{k}"));
        let target = Target::new(path.to_str().unwrap()).unwrap();
        fs::write(&path, "the same").unwrap();
        assert_eq!(target.write(b"the same").unwrap(), None);
        fs::write(&path, "saved by somebody else").unwrap();
        assert_eq!(target.write(b"new").unwrap().unwrap().file_name(), copy("").file_name());
        assert_eq!(fs::read_to_string(copy("")).unwrap(), "saved by somebody else");
        assert_eq!(target.keeping_copy().write(b"newer").unwrap().unwrap().file_name(), copy(".1").file_name());
        assert_eq!(fs::read_to_string(copy(".1")).unwrap(), "new");
        assert_eq!(fs::read_to_string(&path).unwrap(), "newer");
    }

    #[test]
    fn a_refusal_at_any_step_leaves_the_old_file_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").unwrap();
        let target = Target::new(path.to_str().unwrap()).unwrap();
        let bytes = vec![b'x'; 3 * CHUNK + 1];
        let mut steps = 0;
        target
            .write_watched(&bytes, &mut |_| {
                steps += 1;
                Ok(())
            })
            .unwrap();
        assert_eq!(steps, 9);
        for refused in 0..steps - 1 {
            fs::write(&path, "old").unwrap();
            let target = Target::new(path.to_str().unwrap()).unwrap();
            let mut step = 0;
            let written = target.write_watched(&bytes, &mut |_| {
                step += 1;
                if step > refused { Err(ErrorKind::StorageFull.into()) } else { Ok(()) }
            });
            assert!(written.is_err());
            assert_eq!(fs::read_to_string(&path).unwrap(), "old");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }

    #[cfg(unix)]
    #[test]
    fn permissions_stay_and_new_files_have_the_usual_ones() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o7777;
        fs::write(at("usual"), "x").unwrap();
        for wanted in [0o600, 0o640, 0o664, 0o755] {
            fs::write(at("old"), "old").unwrap();
            fs::set_permissions(at("old"), fs::Permissions::from_mode(wanted)).unwrap();
            Target::new(at("old").to_str().unwrap()).unwrap().write(b"new").unwrap();
            assert_eq!(mode("old"), wanted);
        }
        Target::new(at("new").to_str().unwrap()).unwrap().write(b"new").unwrap();
        assert_eq!(mode("new"), mode("usual"));
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links_and_lead_somewhere() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("real"), "old").unwrap();
        fs::hard_link(at("real"), at("other")).unwrap();
        symlink("real", at("link")).unwrap();
        Target::new(at("link").to_str().unwrap()).unwrap().write(b"new").unwrap();
        assert!(at("link").is_symlink());
        let read = |name: &str| fs::read_to_string(at(name)).unwrap();
        assert_eq!((read("real"), read("other")), ("new".into(), "old".into()));
        symlink("nowhere", at("dangling")).unwrap();
        assert!(refused(&at("dangling")).contains("leads nowhere"));
        symlink("round", at("round")).unwrap();
        Target::new(at("round").to_str().unwrap()).unwrap_err();
        // What is planted in the meantime is replaced, not followed.
        let target = Target::new(at("planted").to_str().unwrap()).unwrap();
        symlink("real", at("planted")).unwrap();
        target.write(b"mine").unwrap();
        assert_eq!((read("real"), read("planted")), ("new".into(), "mine".into()));
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_without_a_reader_is_no_place_to_write() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR).unwrap();
        let target = Target::new(pipe.to_str().unwrap()).unwrap();
        assert!(target.write(b"x").unwrap_err().to_string().contains("nobody reads"));
        assert!(Target::new("/dev/full").unwrap().write(b"x").is_err());
        Target::new("/dev/null").unwrap().write(b"x").unwrap();
    }
}
