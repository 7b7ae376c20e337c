//! Copies that are kept of files before they are replaced.

use std::{
    ffi::{OsStr, OsString},
    fs, io,
    path::{Path, PathBuf},
};

use super::system;

/// Most copies of one file.
const COPIES: u32 = 10_000;

/// Longest name of a file on the usual systems, in bytes.
const NAME_BYTES: usize = 255;

/// Keeps what `path` has now under a name beside it that was free: `NAME.orig`, else `NAME.orig.1` and so on.
///
/// The file itself gets the second name where the system can do that; it is not touched when a new one takes its first name.
pub(super) fn keep(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().unwrap_or_default();
    for number in 0..COPIES {
        let copy = path.with_file_name(copy_name(name, number));
        let kept = match fs::hard_link(path, &copy) {
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => duplicate(path, &copy),
            other => other,
        };
        match kept {
            Ok(()) => return Ok(copy),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(e),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, format!("there are {COPIES} copies of it already")))
}

fn copy_name(name: &OsStr, number: u32) -> OsString {
    let ending = if number == 0 { ".orig".to_owned() } else { format!(".orig.{number}") };
    let mut copy = name.to_owned();
    if name.len() + ending.len() > NAME_BYTES {
        let text = name.to_string_lossy();
        let end = text.floor_char_boundary(NAME_BYTES - ending.len());
        copy = text[..end].into();
    }
    copy.push(ending);
    copy
}

/// Copies the content, for systems that do not give a file two names.
fn duplicate(path: &Path, copy: &Path) -> io::Result<()> {
    let mut from = fs::File::open(path)?;
    let mut to = system::create_new(copy, true)?;
    let written =
        io::copy(&mut from, &mut to).and_then(|_| system::dress(&to, &from.metadata()?)).and_then(|()| to.sync_all());
    if written.is_err() {
        // Half a copy is none; the first error is the one to tell.
        let _ = fs::remove_file(copy);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_never_replace_one_another() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.svg"), "one").unwrap();
        assert_eq!(keep(&at("a.svg")).unwrap(), at("a.svg.orig"));
        fs::remove_file(at("a.svg")).unwrap();
        fs::write(at("a.svg"), "two").unwrap();
        assert_eq!(keep(&at("a.svg")).unwrap(), at("a.svg.orig.1"));
        let read = |name: &str| fs::read_to_string(at(name)).unwrap();
        assert_eq!(
            (read("a.svg"), read("a.svg.orig"), read("a.svg.orig.1")),
            ("two".into(), "one".into(), "two".into())
        );
        duplicate(&at("a.svg"), &at("b.svg")).unwrap();
        assert_eq!(read("b.svg"), "two");
        assert!(duplicate(&at("a.svg"), &at("b.svg")).is_err());
        assert_eq!(read("b.svg"), "two");
    }

    #[test]
    fn long_names_are_cut() {
        let name = "é".repeat(127);
        for number in [0, 7, 1234] {
            let copy = copy_name(OsStr::new(&name), number);
            assert!(copy.len() <= NAME_BYTES && copy.to_string_lossy().contains(".orig"), "{copy:?}");
        }
    }
}
