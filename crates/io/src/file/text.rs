//! Bytes to text: the encodings that files come in.

use arabesque_core::{Error, Result};

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
}
