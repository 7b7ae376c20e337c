//! Files: read with a limit, written whole or not at all.

use std::{
    fs,
    io::{Read, Write},
    path::{Path, PathBuf},
};

use arabesque_core::{Budget, Error, Result};

/// The name that stands for standard input and standard output.
pub const STANDARD: &str = "-";

/// Reads a file, or standard input for `-`.
///
/// # Errors
/// [`Error::Io`] when the system refuses, [`Error::Limit`] when there are more than [`arabesque_core::Limits::file_bytes`] bytes.
pub fn read_bytes(path: &str, budget: &Budget) -> Result<Vec<u8>> {
    let fail = |source| Error::Io { path: path.to_owned(), source };
    let most = budget.limits().file_bytes;
    let mut bytes = Vec::new();
    if path == STANDARD {
        std::io::stdin().lock().take(most as u64 + 1).read_to_end(&mut bytes).map_err(fail)?;
    } else {
        let file = fs::File::open(path).map_err(fail)?;
        file.take(most as u64 + 1).read_to_end(&mut bytes).map_err(fail)?;
    }
    if bytes.len() > most {
        return Err(Error::Limit {
            what: format!("{path}: size of the file"),
            found: format!("more than {most} bytes"),
            limit: format!("{most} bytes"),
            advice: "use a smaller file".into(),
        });
    }
    Ok(bytes)
}

/// The text in `bytes`: UTF-8, UTF-16 with a byte order mark, or Latin-1 where an XML declaration says so.
///
/// # Errors
/// [`Error::Input`] naming `place` when it is none of these.
pub fn decode_text(place: &str, bytes: &[u8]) -> Result<String> {
    if bytes.starts_with(&[0x1F, 0x8B]) {
        return Err(Error::input(
            place,
            "a compressed file (svgz, gzip), where plain text was expected",
            "unpack it first, or save it as plain SVG",
        ));
    }
    let units = |from: fn([u8; 2]) -> u16| bytes[2..].chunks_exact(2).map(|c| from([c[0], c[1]])).collect::<Vec<_>>();
    let wide = match bytes {
        [0xFF, 0xFE, ..] => Some(units(u16::from_le_bytes)),
        [0xFE, 0xFF, ..] => Some(units(u16::from_be_bytes)),
        _ => None,
    };
    if let Some(units) = wide {
        return String::from_utf16(&units).map_err(|_| not_text(place, "broken UTF-16"));
    }
    if declares_latin1(bytes) {
        return Ok(bytes.iter().map(|&b| char::from(b)).collect());
    }
    let bytes = bytes.strip_prefix(&[0xEF, 0xBB, 0xBF]).unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(e) => Err(not_text(place, &format!("byte {} is not UTF-8 text", e.valid_up_to() + 1))),
    }
}

fn not_text(place: &str, problem: &str) -> Error {
    Error::input(place, format!("{problem}, where text was expected"), "save the file as UTF-8 text")
}

fn declares_latin1(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    let Some((declaration, _)) = head.strip_prefix("<?xml").and_then(|rest| rest.split_once("?>")) else {
        return false;
    };
    ["iso-8859-1", "iso8859-1", "latin1", "windows-1252", "us-ascii"].iter().any(|name| declaration.contains(name))
}

/// Where a result will be written: checked before the work, written in one go after it.
#[derive(Clone, Debug)]
pub struct Target {
    path: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Standard,
    /// A regular file, or nothing yet: replaced by renaming.
    Replaced,
    /// A device or a pipe, which cannot be replaced.
    Direct,
}

impl Target {
    /// Checks that a file can be written at `path`; `-` is standard output.
    ///
    /// # Errors
    /// [`Error::Io`] when the folder is missing or not writable, or `path` is a folder.
    pub fn new(path: &str) -> Result<Self> {
        if path == STANDARD {
            return Ok(Self { path: PathBuf::from(path), kind: Kind::Standard });
        }
        let fail = |source| Error::Io { path: path.to_owned(), source };
        // A link stays a link: what it points to is replaced.
        let real = fs::canonicalize(path).unwrap_or_else(|_| PathBuf::from(path));
        let kind = match fs::metadata(&real) {
            Ok(m) if m.is_dir() => return Err(fail(std::io::ErrorKind::IsADirectory.into())),
            Ok(m) if !m.is_file() => Kind::Direct,
            Ok(m) if m.permissions().readonly() => return Err(fail(std::io::ErrorKind::PermissionDenied.into())),
            Ok(_) | Err(_) => Kind::Replaced,
        };
        let target = Self { path: real, kind };
        if kind == Kind::Replaced {
            let temporary = target.temporary();
            fs::File::create(&temporary).and_then(|_| fs::remove_file(&temporary)).map_err(fail)?;
        }
        Ok(target)
    }

    /// Writes everything: to a file beside the target that is renamed once it is complete.
    ///
    /// # Errors
    /// [`Error::Io`] when the system refuses; the target is then as it was before.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        let fail = |source| Error::Io { path: self.path.display().to_string(), source };
        match self.kind {
            Kind::Standard => {
                let mut out = std::io::stdout().lock();
                out.write_all(bytes).and_then(|()| out.flush()).map_err(fail)
            }
            Kind::Direct => fs::write(&self.path, bytes).map_err(fail),
            Kind::Replaced => {
                let temporary = self.temporary();
                let written = write_synced(&temporary, bytes).and_then(|()| fs::rename(&temporary, &self.path));
                if written.is_err() {
                    // The first error is the one to tell; a file that cannot be removed either changes nothing.
                    let _ = fs::remove_file(&temporary);
                }
                written.map_err(fail)
            }
        }
    }

    /// A name beside the target that no other process uses.
    fn temporary(&self) -> PathBuf {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let folder = self.path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        folder.join(format!(".{name}.{}.part", std::process::id()))
    }
}

fn write_synced(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = fs::File::create(path)?;
    file.write_all(bytes)?;
    file.sync_data()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latin_1_and_utf_16_become_text() {
        let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><a>\xE9</a>";
        assert!(decode_text("t", latin).unwrap().ends_with("<a>é</a>"));
        assert_eq!(decode_text("t", &[0xFF, 0xFE, b'a', 0, b'b', 0]).unwrap(), "ab");
        assert_eq!(decode_text("t", &[0xEF, 0xBB, 0xBF, b'a']).unwrap(), "a");
        assert!(decode_text("t", &[b'a', 0xE9, b'b']).unwrap_err().to_string().contains("byte 2"));
    }

    #[test]
    fn compressed_files_are_called_so() {
        let told = decode_text("leaves.svgz", &[0x1F, 0x8B, 8, 0, 0]).unwrap_err().to_string();
        assert!(told.starts_with("leaves.svgz: a compressed file (svgz, gzip)"), "{told}");
    }

    #[test]
    fn a_missing_folder_is_noticed_before_the_work() {
        assert!(matches!(Target::new("/nonexistent-folder/x.svg"), Err(Error::Io { .. })));
        assert!(matches!(Target::new("/"), Err(Error::Io { .. })));
    }

    #[test]
    fn writing_replaces_the_file_and_leaves_nothing_else() {
        let folder = std::env::temp_dir().join(format!("arabesque-file-test-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("out.txt");
        fs::write(&path, "old").unwrap();
        let target = Target::new(path.to_str().unwrap()).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        target.write(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(&folder).unwrap();
    }
}
