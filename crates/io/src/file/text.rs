//! Bytes to text: the packing and the encodings that files come in.

use std::io::Read;

use arabesque_core::{Budget, Error, Result};
use flate2::read::MultiGzDecoder;

use super::{
    called::{binary, is_packed},
    read::too_large,
};

/// Bytes that are unpacked between two looks at the limits.
const CHUNK: usize = 1 << 16;

/// The text in `bytes`: UTF-8, UTF-16 with a byte order mark, or Latin-1 where an XML declaration says so; packed with gzip (`.svgz`) or
/// not.
///
/// # Errors
/// [`Error::Input`] naming `place` when it is none of these; [`Error::Limit`] when it unpacks to more than
/// [`arabesque_core::Limits::file_bytes`] bytes; those of [`Budget::check`].
pub fn decode_text(place: &str, bytes: &[u8], budget: &Budget) -> Result<String> {
    if !is_packed(bytes) {
        return plain_text(place, bytes);
    }
    let unpacked = unpacked(place, bytes, budget)?;
    if is_packed(&unpacked) {
        let problem = "a file that was compressed twice (gzip), where text was expected";
        return Err(Error::input(place, problem, "unpack it once, or save it as plain SVG"));
    }
    plain_text(place, &unpacked)
}

/// What is packed in `bytes`, within the limit on files: a few bytes may stand for any number.
fn unpacked(place: &str, bytes: &[u8], budget: &Budget) -> Result<Vec<u8>> {
    let budget = budget.stage("unpacking");
    let most = budget.limits().file_bytes;
    let mut decoder = MultiGzDecoder::new(bytes);
    let mut out = Vec::new();
    let mut chunk = vec![0; CHUNK];
    loop {
        let count = decoder.read(&mut chunk).map_err(|error| {
            let problem = format!("a compressed file (svgz, gzip) that is damaged: {error}");
            Error::input(place, problem, "save it again, or save it as plain SVG")
        })?;
        if count == 0 {
            return Ok(out);
        }
        budget.spend(count as u64)?;
        if out.len() + count > most {
            return Err(too_large(place, "size of the unpacked file", None, &budget));
        }
        out.extend_from_slice(&chunk[..count]);
    }
}

fn plain_text(place: &str, bytes: &[u8]) -> Result<String> {
    if let Some(kind) = binary(bytes) {
        let problem = format!("{kind}, where text such as SVG was expected");
        return Err(Error::input(place, problem, "export it as SVG, or give the file that was meant"));
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

#[cfg(test)]
mod tests {
    use std::io::Write;

    use arabesque_core::Limits;
    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn text(name: &str, bytes: &[u8]) -> Result<String> {
        decode_text(name, bytes, &Budget::default())
    }

    #[test]
    fn latin_1_and_utf_16_become_text() {
        let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><a>\xE9</a>";
        assert!(text("t", latin).unwrap().ends_with("<a>é</a>"));
        assert_eq!(text("t", &[0xFF, 0xFE, b'a', 0, b'b', 0]).unwrap(), "ab");
        assert_eq!(text("t", &[0xEF, 0xBB, 0xBF, b'a']).unwrap(), "a");
        assert!(text("t", &[b'a', 0xE9, b'b']).unwrap_err().to_string().contains("byte 2"));
    }

    #[test]
    fn pictures_and_archives_are_called_what_they_are() {
        for (bytes, kind) in [(&b"\xFF\xD8\xFF\xE0JFIF"[..], "a JPEG picture"), (b"%PDF-1.7", "a PDF document")] {
            let error = text("t.svg", bytes).unwrap_err().to_string();
            assert!(error.starts_with(&format!("t.svg: {kind}")), "{error}");
        }
        assert_eq!(text("t", b"GIF").unwrap(), "GIF");
    }

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn packed_text_is_unpacked_whatever_the_file_is_called() {
        let latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><a>\xE9</a>";
        for name in ["leaves.svgz", "leaves.svg", "-"] {
            assert!(text(name, &packed(latin)).unwrap().ends_with("<a>é</a>"));
        }
        let twice = text("a.svgz", &packed(&packed(b"<svg/>"))).unwrap_err().to_string();
        assert!(twice.contains("compressed twice"), "{twice}");
    }

    #[test]
    fn damaged_files_and_bombs_are_refused() {
        let whole = packed(b"<svg><path d='M0 0h9'/></svg>");
        for damaged in [&[0x1F, 0x8B, 8, 0, 0][..], &whole[..whole.len() - 9], &[&whole[..12], &[255; 40]].concat()] {
            let told = text("leaves.svgz", damaged).unwrap_err().to_string();
            assert!(told.starts_with("leaves.svgz: a compressed file (svgz, gzip) that is damaged"), "{told}");
        }
        let bomb = packed(&vec![b' '; 3_000_000]);
        assert!(bomb.len() < 10_000);
        let budget = Budget::new(Limits { file_bytes: 2_000_000, ..Limits::default() });
        let told = decode_text("bomb.svgz", &bomb, &budget).unwrap_err().to_string();
        assert!(told.contains("bomb.svgz: size of the unpacked file") && told.contains("2000000 bytes"), "{told}");
    }
}
