//! Looking for the file that an input means: by its path, and where a recipe has its fingerprint, by that.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use arabesque_core::{Budget, Error, Result};
use arabesque_io::file;

use crate::recipe::Input;

/// Folders above that of the recipe, and above the working folder, in which the path is tried.
const ANCESTORS: usize = 8;

/// Most files of which the fingerprint is taken.
const FILES: usize = 500;

/// Most bytes of which the fingerprint is taken.
const BYTES: u64 = 512 << 20;

/// What is looked for, and beside what.
pub(super) struct Search<'a> {
    pub(super) base: Option<&'a Path>,
    pub(super) input: &'a Input,
}

/// The file that an input means.
pub(super) struct Found {
    pub(super) path: PathBuf,
    /// Its content, where it had to be read to know.
    bytes: Option<Vec<u8>>,
}

impl Found {
    /// The content, which has the fingerprint that the input asks for.
    pub(super) fn content(self, input: &Input, budget: &Budget) -> Result<Arc<[u8]>> {
        if let Some(bytes) = self.bytes {
            return Ok(bytes.into());
        }
        let bytes = file::read_bytes(&self.path.to_string_lossy(), budget)?;
        input.check(&bytes)?;
        Ok(bytes.into())
    }
}

impl Search<'_> {
    /// The file under its path: beside the recipe, else in the working folder.
    pub(super) fn named(&self) -> Option<PathBuf> {
        let path = Path::new(&self.input.path);
        if file::is_stream(&self.input.path) {
            return Some(path.to_owned());
        }
        self.base.map(|base| base.join(path)).into_iter().chain([path.to_owned()]).find(|p| p.exists())
    }

    /// The file under its path; where there is a fingerprint, the first one that has it.
    pub(super) fn find(&self, budget: &Budget) -> Result<Found> {
        let named = self.named();
        if self.input.hash.is_none() || file::is_stream(&self.input.path) {
            return named.map(|path| Found { path, bytes: None }).ok_or_else(|| self.missing());
        }
        for path in named.iter().cloned().chain(self.above()) {
            if let Some(found) = self.take(path, budget)? {
                return Ok(found);
            }
        }
        match self.by_fingerprint(budget)? {
            Some(found) => Ok(found),
            // What is wrong with the one that has the name is told when it is read.
            None => named.map(|path| Found { path, bytes: None }).ok_or_else(|| self.missing()),
        }
    }

    /// The file at `path`, if it is the one.
    fn take(&self, path: PathBuf, budget: &Budget) -> Result<Option<Found>> {
        match file::read_bytes(&path.to_string_lossy(), budget) {
            Ok(bytes) => {
                budget.spend(bytes.len() as u64)?;
                let is_wanted = self.input.check(&bytes).is_ok();
                Ok(is_wanted.then_some(Found { path, bytes: Some(bytes) }))
            }
            Err(error @ Error::Stopped { .. }) => Err(error),
            Err(_) => Ok(None),
        }
    }

    /// The same path in the folders above: a result may lie deeper than where its run was started.
    fn above(&self) -> Vec<PathBuf> {
        let path = Path::new(&self.input.path);
        let folders = self.folders();
        let above = folders.iter().flat_map(|folder| folder.ancestors().skip(1).take(ANCESTORS));
        let mut seen = BTreeSet::new();
        above
            .map(|folder| folder.join(path))
            .filter(|p| path.is_relative() && p.is_file() && seen.insert(p.clone()))
            .collect()
    }

    /// The folders that are looked through, with all links resolved: that of the recipe and the working folder.
    fn folders(&self) -> Vec<PathBuf> {
        let mut folders: Vec<PathBuf> = Vec::new();
        for folder in self.base.into_iter().chain([Path::new(".")]) {
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            if let Ok(real) = fs::canonicalize(folder)
                && !folders.contains(&real)
            {
                folders.push(real);
            }
        }
        folders
    }

    /// A file with the same ending, whatever its name, that has the fingerprint.
    fn by_fingerprint(&self, budget: &Budget) -> Result<Option<Found>> {
        let ending = |path: &Path| path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        let wanted = ending(Path::new(&self.input.path));
        let (mut files, mut bytes) = (0, 0);
        for folder in self.folders() {
            let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
            let mut candidates: Vec<_> = entries.filter(|path| ending(path) == wanted).take(FILES).collect();
            candidates.sort();
            for path in candidates {
                let Some(size) = fs::metadata(&path).ok().filter(fs::Metadata::is_file).map(|m| m.len()) else {
                    continue;
                };
                files += 1;
                if files > FILES || size > BYTES - bytes {
                    continue;
                }
                bytes += size;
                if let Some(found) = self.take(path, budget)? {
                    return Ok(Some(found));
                }
            }
        }
        Ok(None)
    }

    fn missing(&self) -> Error {
        let name = self.input.name();
        if name.is_empty() {
            return Error::input("\"\"", "an empty name, where a file was expected", "name a file");
        }
        let beside = self.base.filter(|base| !base.as_os_str().is_empty());
        let places = match beside {
            _ if Path::new(name).is_absolute() => String::new(),
            Some(base) => format!("; it was looked for in {} and in the working folder", base.display()),
            None => "; it was looked for in the working folder".to_owned(),
        };
        let advice = match &self.input.hash {
            Some(hash) => {
                let ending = Path::new(name).extension().map(|e| format!(" ending in .{}", e.to_string_lossy()));
                let ending = ending.unwrap_or_default();
                format!(
                    "put the file with the digest {hash} (FNV-1a) there; no file{ending} with it is beside the recipe or in the working folder"
                )
            }
            None => format!("name a file that is there{places}"),
        };
        Error::input(name, "no such file", advice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(base: &Path, input: &Input) -> Result<Arc<[u8]>> {
        let budget = Budget::default();
        Search { base: Some(base), input }.find(&budget)?.content(input, &budget)
    }

    /// An input of which the recipe has the fingerprint alone.
    fn known(path: &str, bytes: &[u8]) -> Input {
        Input { content: None, encoding: None, ..Input::file(path).embedding(bytes) }
    }

    #[test]
    fn a_file_is_found_by_its_fingerprint_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        let input = known("deep/down/old.csv", b"wanted");
        let message = content(folder.path(), &input).unwrap_err().to_string();
        assert!(message.contains("no such file") && message.contains(input.hash.as_deref().unwrap()), "{message}");
        write("a.txt", "wanted");
        write("b.csv", "another");
        assert!(content(folder.path(), &input).is_err());
        write("c.CSV", "wanted");
        assert_eq!(&*content(folder.path(), &input).unwrap(), b"wanted");
    }

    #[test]
    fn a_file_is_found_above_the_folder_of_the_result() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("out/today")).unwrap();
        fs::create_dir(folder.path().join("in")).unwrap();
        fs::write(folder.path().join("in/a.csv"), "wanted").unwrap();
        let base = folder.path().join("out/today");
        assert_eq!(&*content(&base, &known("in/a.csv", b"wanted")).unwrap(), b"wanted");
        // Without a fingerprint that would be a guess.
        assert!(content(&base, &Input::file("in/a.csv")).unwrap_err().to_string().contains("no such file"));
    }

    #[test]
    fn a_changed_file_does_not_hide_the_one_that_is_wanted() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a.csv", "changed");
        let message = content(folder.path(), &known("a.csv", b"wanted")).unwrap_err().to_string();
        assert!(message.contains("has changed") && message.contains("digest"), "{message}");
        write("copy of a.csv", "wanted");
        assert_eq!(&*content(folder.path(), &known("a.csv", b"wanted")).unwrap(), b"wanted");
    }

    #[cfg(unix)]
    #[test]
    fn nothing_is_opened_that_is_no_regular_file() {
        let folder = tempfile::tempdir().unwrap();
        let _socket = std::os::unix::net::UnixListener::bind(folder.path().join("s.csv")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", folder.path().join("z.csv")).unwrap();
        std::os::unix::fs::symlink("loop.csv", folder.path().join("loop.csv")).unwrap();
        assert!(content(folder.path(), &known("a.csv", b"wanted")).is_err());
        assert!(content(folder.path(), &known("z.csv", b"wanted")).unwrap_err().to_string().contains("a device"));
    }
}
