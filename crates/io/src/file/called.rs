//! What files of the wrong kind are called in messages.

/// How files that are packed with gzip begin, whatever they are called.
const GZIP: [u8; 2] = [0x1F, 0x8B];

/// Files of bytes, by how they begin.
const BINARY: [(&[u8], &str); 12] = [
    (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
    (b"\xFF\xD8\xFF", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"RIFF", "a WebP picture or a sound"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"%PDF", "a PDF document, as Illustrator files are too"),
    (b"%!PS", "a PostScript document"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"glTF", "a GLB scene"),
    (&GZIP, "a packed file (svgz, gzip)"),
    (b"8BPS", "a Photoshop document"),
];

/// What pages of the web are called: they begin as drawings do.
pub const HTML: &str = "an HTML page";
/// What recipes are called, and what else is written as they are.
pub const TOML: &str = "a recipe or another TOML file";

/// Bytes of a text that are looked at.
const HEAD: usize = 4096;

/// Whether a file is packed with gzip, as `.svgz` is.
pub fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(&GZIP)
}

/// What a file is that begins as files of bytes do, as a noun with its article; `None` for all others.
pub(crate) fn binary(bytes: &[u8]) -> Option<&'static str> {
    BINARY.iter().find(|(begin, _)| bytes.starts_with(begin)).map(|(_, kind)| *kind)
}

/// What a file is, as a noun with its article, as well as its beginning tells.
pub fn called(bytes: &[u8]) -> &'static str {
    if let Some(kind) = binary(bytes) {
        return kind;
    }
    let head = &bytes[..bytes.len().min(HEAD)];
    match std::str::from_utf8(head) {
        Ok(text) => text_called(text),
        // The last character may be cut.
        Err(error) if head.len() == HEAD && error.error_len().is_none() => text_called(&String::from_utf8_lossy(head)),
        Err(_) => "a file of an unknown kind",
    }
}

/// What a text is, as a noun with its article.
pub(crate) fn text_called(text: &str) -> &'static str {
    let text = text.trim_start_matches('\u{FEFF}').trim_start();
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines().next().unwrap_or_default();
    let word = first.split_whitespace().next().unwrap_or_default();
    let begins = |word: &str| first.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    match word {
        _ if text.is_empty() => "an empty file",
        _ if text.contains('\0') => "a file of an unknown kind",
        _ if begins("<!doctype html") || begins("<html") => HTML,
        _ if first.starts_with('<') => "an SVG or XML file",
        "ply" => "a PLY file",
        "solid" => "an STL file",
        "v" | "vn" | "vt" | "o" | "g" | "mtllib" => "an OBJ file",
        _ if text.starts_with("#usda") => "a USD file",
        _ if first.starts_with('{') => "a JSON file",
        _ if first.starts_with('[') && !names_a_table(first) => "a JSON file",
        _ if first.starts_with('[') || sets_a_key(first) => TOML,
        _ if first.contains([',', ';', '\t']) || first.split_whitespace().all(|word| word.parse::<f64>().is_ok()) => {
            "a table (CSV, XYZ)"
        }
        _ => "plain text",
    }
}

/// Whether a line that begins with a bracket is the head of a table of TOML, and not a list of JSON.
fn names_a_table(line: &str) -> bool {
    let line = line.split('#').next().unwrap_or_default().trim();
    let name = line.trim_start_matches('[').trim_end_matches(']').trim();
    let begins = |c: char| c.is_alphabetic() || c == '_';
    line.ends_with(']') && name.starts_with(begins) && !name.contains([',', '[', '{', ':'])
}

/// Whether a line gives a key of TOML a value.
fn sets_a_key(line: &str) -> bool {
    let is_key = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '"');
    line.split_once('=').is_some_and(|(key, _)| !key.trim().is_empty() && key.trim().chars().all(is_key))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_called_what_they_are() {
        for (bytes, kind) in [
            (&b"\xFF\xD8\xFF\xE0JFIF"[..], "a JPEG picture"),
            (b"%PDF-1.7", "a PDF document, as Illustrator files are too"),
            (b"\x1F\x8B\x08\0", "a packed file (svgz, gzip)"),
            (b"", "an empty file"),
            (b" \n", "an empty file"),
            (b"\xEF\xBB\xBF<svg/>", "an SVG or XML file"),
            (b"<!DOCTYPE HTML><p>", "an HTML page"),
            (b"ply\nformat ascii 1.0\n", "a PLY file"),
            (b"# made by hand\n\nv 1 2 3\n", "an OBJ file"),
            (b"#usda 1.0\n(\n", "a USD file"),
            (b"{\"a\": 1}", "a JSON file"),
            (b"seed = 1\n[exemplar]\n", "a recipe or another TOML file"),
            (b"[[1, 2], [3, 4]]", "a JSON file"),
            (b"[\n1, 2\n", "a JSON file"),
            (b"[[edit]] # the first\n", "a recipe or another TOML file"),
            (b"[exemplar]\npath = 1\n", "a recipe or another TOML file"),
            (b"x,y\n1,2\n", "a table (CSV, XYZ)"),
            (b"1 2 3\n", "a table (CSV, XYZ)"),
            (b"hello world\n", "plain text"),
            (b"\xC3", "a file of an unknown kind"),
            (b"ab\0\0", "a file of an unknown kind"),
        ] {
            assert_eq!(called(bytes), kind, "{}", String::from_utf8_lossy(bytes));
        }
        let mut long = vec![b'a'; HEAD - 1];
        long.extend("é".bytes());
        assert_eq!(called(&long), "plain text");
    }
}
