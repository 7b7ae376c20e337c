//! The bytes that a document refers to: the chunk of a GLB file, data in its text, files beside it.

use std::{collections::BTreeMap, ops::Deref, sync::Arc};

use arabesque_core::{Budget, Error, Held, Result};
use base64::{
    Engine,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use crate::file::{Beside, name_beside};

/// With padding or without: files come with both.
const LENIENT: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);
/// Work of a byte of data in the text.
const PER_BYTE: u64 = 2;

/// The bytes of a buffer; several buffers may be one file.
pub(super) enum Bytes<'a> {
    Chunk(&'a [u8]),
    Shared(Arc<[u8]>),
}

impl Deref for Bytes<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Shared(bytes) => bytes,
        }
    }
}

/// Reads what addresses in the document name. Every file beside is read once.
pub(super) struct Sources<'a> {
    /// Name of the file, for messages.
    name: &'a str,
    beside: &'a dyn Beside,
    budget: &'a Budget,
    files: BTreeMap<String, Arc<[u8]>>,
    held: Vec<Held>,
}

impl<'a> Sources<'a> {
    pub(super) fn new(name: &'a str, beside: &'a dyn Beside, budget: &'a Budget) -> Self {
        Self { name, beside, budget, files: BTreeMap::new(), held: Vec::new() }
    }

    /// The bytes that `uri` stands for, for `what`: a buffer or a picture with its number.
    ///
    /// # Errors
    /// [`Error::Input`] for addresses that lead anywhere but beside the file, and for data that is no Base64; [`Error::Limit`] for data
    /// of more bytes than a file may have, which is not decoded; those of the files and of the budget.
    pub(super) fn bytes(&mut self, what: &str, uri: &str) -> Result<Arc<[u8]>> {
        let place = format!("{}: {what}", self.name);
        if let Some(data) = uri.strip_prefix("data:") {
            let bytes = self.decoded(&place, data)?;
            return Ok(bytes.into());
        }
        let beside = name_beside(&place, uri)?;
        if let Some(known) = self.files.get(&beside) {
            return Ok(Arc::clone(known));
        }
        let within = |error| match error {
            Error::Input { place: file, problem, advice } => Error::input(format!("{place}: {file}"), problem, advice),
            other => other,
        };
        let bytes = self.beside.read(&beside, self.budget).map_err(within)?;
        self.hold(bytes.len())?;
        self.files.insert(beside, Arc::clone(&bytes));
        Ok(bytes)
    }

    /// Accounts for bytes that stay as long as the file is read.
    pub(super) fn hold(&mut self, bytes: usize) -> Result<()> {
        self.held.push(self.budget.hold("bytes that the file refers to", bytes)?);
        Ok(())
    }

    fn decoded(&mut self, place: &str, data: &str) -> Result<Vec<u8>> {
        let fail = |problem: &str| Err(Error::input(place, problem, "write the file again, as GLB"));
        let Some((kind, text)) = data.split_once(',') else { return fail("a data URI without a comma") };
        if !kind.ends_with(";base64") {
            return fail("a data URI that is not Base64");
        }
        let size = text.len() / 4 * 3;
        let limit = ("file-bytes", self.budget.limits().file_bytes);
        self.budget.within(&format!("{place}: bytes in its data URI"), size, limit)?;
        self.budget.spend(PER_BYTE * text.len() as u64)?;
        self.hold(size)?;
        LENIENT.decode(text).or_else(|error| fail(&format!("a data URI that is not Base64: {error}")))
    }
}

/// The media type that a data URI says.
pub(super) fn mime_of(uri: &str) -> Option<&str> {
    let kind = uri.strip_prefix("data:")?.split([';', ',']).next()?;
    (!kind.is_empty()).then_some(kind)
}

/// The bytes of every buffer, by number.
///
/// # Errors
/// As [`Sources::bytes`].
pub(super) fn buffers<'b>(
    uris: impl Iterator<Item = Option<&'b str>>,
    chunk: &'b [u8],
    sources: &mut Sources<'_>,
) -> Result<Vec<Bytes<'b>>> {
    let mut found = Vec::new();
    for (number, uri) in uris.enumerate() {
        found.push(match uri {
            Some(uri) => Bytes::Shared(sources.bytes(&format!("buffer {number}"), uri)?),
            None if number == 0 => Bytes::Chunk(chunk),
            None => Bytes::Chunk(&[]),
        });
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use arabesque_core::Limits;

    use super::*;
    use crate::file::NothingBeside;

    #[test]
    fn data_in_the_text_is_decoded_within_the_limit() {
        let budget = Budget::new(Limits { file_bytes: 10, ..Limits::default() });
        let mut sources = Sources::new("a.gltf", &NothingBeside, &budget);
        for (uri, expected) in [
            ("data:application/octet-stream;base64,AAEC", Ok([0, 1, 2].as_slice())),
            ("data:;base64,AAE=", Ok([0, 1].as_slice())),
            ("data:;base64,AAE", Ok([0, 1].as_slice())),
            ("data:;base64,A*", Err("buffer 0: a data URI that is not Base64: ")),
            ("data:text/plain,abc", Err("that is not Base64")),
            ("data:;base64", Err("without a comma")),
            ("data:;base64,AAECAAECAAECAAEC", Err("12 is over the limit of 10")),
            ("../a.bin", Err("outside of the folder")),
            ("a.bin", Err("a.gltf: buffer 0: a.bin: a file beside one whose folder is not known")),
        ] {
            match (sources.bytes("buffer 0", uri), expected) {
                (Ok(found), Ok(expected)) => assert_eq!(&*found, expected),
                (Err(found), Err(expected)) => assert!(found.to_string().contains(expected), "{found}"),
                (found, _) => panic!("{uri}: {found:?}"),
            }
        }
        assert_eq!(mime_of("data:image/png;base64,AA"), Some("image/png"));
        assert_eq!(mime_of("a.png"), None);
    }

    #[test]
    fn files_beside_are_read_once() {
        let files = BTreeMap::from([("a b.bin".to_owned(), Arc::from([7_u8, 8].as_slice()))]);
        let budget = Budget::default();
        let mut sources = Sources::new("a.gltf", &files, &budget);
        let found = buffers([Some("a%20b.bin"), None].into_iter(), &[], &mut sources).unwrap();
        assert_eq!((&*found[0], found[1].len()), ([7, 8].as_slice(), 0));
        assert_eq!(sources.files.len(), 1);
    }
}
