//! Which file a path leads to, whatever it is called.

use std::{fs, path::Path};

use super::stream::STANDARD;

/// A regular file as the system knows it: two paths lead to the same file when their identities are equal.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Identity(Key);

#[cfg(unix)]
type Key = (u64, u64);
#[cfg(not(unix))]
type Key = std::path::PathBuf;

impl Identity {
    /// The regular file that `path` leads to through all links; `None` when there is none.
    pub fn of(path: impl AsRef<Path>) -> Option<Self> {
        let path = path.as_ref();
        let metadata = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
        Self::key(path, &metadata).map(Self)
    }

    /// The regular file that is read at `path`, where `-` is standard input.
    pub fn of_input(path: &str) -> Option<Self> {
        if path == STANDARD { Self::of("/dev/stdin") } else { Self::of(path) }
    }

    /// The regular file that is written at `path`, where `-` is standard output.
    pub fn of_output(path: &str) -> Option<Self> {
        if path == STANDARD { Self::of("/dev/stdout") } else { Self::of(path) }
    }

    #[cfg(unix)]
    fn key(_path: &Path, metadata: &fs::Metadata) -> Option<Key> {
        use std::os::unix::fs::MetadataExt;
        Some((metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn key(path: &Path, _metadata: &fs::Metadata) -> Option<Key> {
        fs::canonicalize(path).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_known_under_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "x").unwrap();
        fs::write(at("b"), "x").unwrap();
        fs::hard_link(at("a"), at("hard")).unwrap();
        fs::create_dir(at("sub")).unwrap();
        assert_eq!(Identity::of(at("a")), Identity::of(at("sub/../a")));
        assert_ne!(Identity::of(at("a")), Identity::of(at("b")));
        assert_eq!(Identity::of(at("sub")), None);
        assert_eq!(Identity::of(at("none")), None);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("a", at("soft")).unwrap();
            assert_eq!(Identity::of(at("a")), Identity::of(at("soft")));
            assert_eq!(Identity::of(at("a")), Identity::of(at("hard")));
        }
    }
}
