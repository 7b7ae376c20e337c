//! Files that another file names: beside it or in a folder below, never anywhere else.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use arabesque_core::{Budget, Error, Result};

use super::read::read_bytes;
use crate::text::short::short;

/// Where a reader finds the files that a file names. Names come through [`name_beside`] first.
pub trait Beside {
    /// The content of a file, by its name relative to the folder of the file that names it.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such file, and whatever reading it meets.
    fn read(&self, name: &str, budget: &Budget) -> Result<Arc<[u8]>>;
}

/// No files: of what comes from memory or from a pipe, nothing is known beside it.
#[derive(Clone, Copy, Debug, Default)]
pub struct NothingBeside;

impl Beside for NothingBeside {
    fn read(&self, name: &str, _: &Budget) -> Result<Arc<[u8]>> {
        let advice = "give the file by its path, or save it with everything inside, as GLB";
        Err(Error::input(short(name), "a file beside one whose folder is not known", advice))
    }
}

/// Files in memory.
impl Beside for BTreeMap<String, Arc<[u8]>> {
    fn read(&self, name: &str, _: &Budget) -> Result<Arc<[u8]>> {
        let missing = || Error::input(short(name), "no such file", "give the file as well");
        self.get(name).cloned().ok_or_else(missing)
    }
}

/// The files of a folder and of those below it. Links that lead out of it are refused.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// The folder that a file lies in.
    pub fn of(file: &Path) -> Self {
        let parent = file.parent().filter(|p| !p.as_os_str().is_empty());
        Self(parent.map_or_else(|| PathBuf::from("."), Path::to_owned))
    }
}

impl Beside for Folder {
    fn read(&self, name: &str, budget: &Budget) -> Result<Arc<[u8]>> {
        let path = self.0.join(name);
        let shown = path.display().to_string();
        let refused = |source: std::io::Error| match source.kind() {
            std::io::ErrorKind::NotFound => {
                Error::input(shown.clone(), "no such file", "put it beside the file that names it")
            }
            _ => Error::Io { path: shown.clone(), source },
        };
        let folder = self.0.canonicalize().map_err(refused)?;
        let found = path.canonicalize().map_err(refused)?;
        if !found.starts_with(&folder) {
            let problem = "a link that leads out of the folder";
            return Err(Error::input(shown, problem, "put the file itself there"));
        }
        let Some(found) = found.to_str() else {
            return Err(Error::input(shown, "a name that is no UTF-8", "rename the file or its folder"));
        };
        Ok(read_bytes(found, budget)?.into())
    }
}

/// The name of a file beside another one, which calls it `reference`: `%20` and the like are letters, and what leads anywhere else is
/// refused: other folders than those below, addresses on the net, absolute paths.
///
/// # Errors
/// [`Error::Input`] with `place` for such references.
pub fn name_beside(place: &str, reference: &str) -> Result<String> {
    let fail = |problem: &str| {
        let advice = "put the file beside the one that names it, or save it with everything inside";
        Err(Error::input(place, format!("\"{}\", which is {problem}", short(reference)), advice))
    };
    let Some(name) = unescaped(reference) else { return fail("no name of a file") };
    if name.is_empty() || name.chars().any(char::is_control) {
        return fail("no name of a file");
    }
    // A colon is part of an address or of a drive; on systems where it may be part of a name, that name is not portable.
    if name.contains(':') || name.starts_with(['/', '\\']) {
        return fail("not beside the file: nothing is read from elsewhere");
    }
    let name = name.replace('\\', "/");
    let parts: Vec<&str> = name.split('/').filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.contains(&"..") || parts.is_empty() {
        return fail("outside of the folder of the file");
    }
    Ok(parts.join("/"))
}

/// A reference with its escapes as letters; `None` for what is no text then.
fn unescaped(reference: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(reference.len());
    let mut rest = reference.bytes();
    while let Some(byte) = rest.next() {
        match escaped(rest.clone()) {
            Some(value) if byte == b'%' => {
                bytes.push(value);
                rest.nth(1);
            }
            _ => bytes.push(byte),
        }
    }
    String::from_utf8(bytes).ok()
}

/// The byte that the next two hexadecimal digits stand for.
fn escaped(mut ahead: std::str::Bytes<'_>) -> Option<u8> {
    let digit = |byte: Option<u8>| char::from(byte?).to_digit(16);
    let (high, low) = (digit(ahead.next())?, digit(ahead.next())?);
    u8::try_from(16 * high + low).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_nowhere_else() {
        for (reference, expected) in [
            ("a.bin", "a.bin"),
            ("./a%20b.bin", "a b.bin"),
            ("textures\\wood.png", "textures/wood.png"),
            ("100%.png", "100%.png"),
            ("a//b.bin", "a/b.bin"),
        ] {
            assert_eq!(name_beside("a.gltf", reference).unwrap(), expected);
        }
        for reference in [
            "../a.bin",
            "/etc/passwd",
            "b/../../a",
            "http://a/b",
            "file:///a",
            "C:\\a",
            "\\\\host\\a",
            "%2e%2e/a",
            "%2Fetc",
            "",
            ".",
            "a%00b",
            "%ff",
        ] {
            let message = name_beside("a.gltf: buffer 0", reference).unwrap_err().to_string();
            assert!(message.starts_with("a.gltf: buffer 0: \""), "{message}");
        }
    }

    #[test]
    fn folders_give_what_is_in_them() {
        let dir = tempfile::tempdir().unwrap();
        let inner = dir.path().join("scene");
        std::fs::create_dir(&inner).unwrap();
        std::fs::write(inner.join("a.bin"), b"abc").unwrap();
        std::fs::write(dir.path().join("secret"), b"s").unwrap();
        let folder = Folder::of(&inner.join("x.gltf"));
        let budget = Budget::default();
        assert_eq!(&*folder.read("a.bin", &budget).unwrap(), b"abc");
        assert!(folder.read("b.bin", &budget).unwrap_err().to_string().contains("no such file"));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(dir.path().join("secret"), inner.join("link")).unwrap();
            assert!(folder.read("link", &budget).unwrap_err().to_string().contains("leads out of the folder"));
        }
        assert_eq!(Folder::of(Path::new("x.gltf")).0, PathBuf::from("."));
        assert!(NothingBeside.read("a.bin", &budget).unwrap_err().to_string().contains("folder is not known"));
    }
}
