//! The two chunks of a GLB file: a document in JSON, and bytes.

use arabesque_core::{Budget, Error, Result};
use base64::{Engine, engine::general_purpose::STANDARD};
use serde::Serialize;
use serde_json::{Value, json, value::RawValue};

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
pub(super) const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";
/// Where in `asset` the recipe stands.
pub(super) const RECIPE: &str = "arabesque recipe";

/// The `asset` of a document, with the recipe.
pub(super) fn asset(recipe: Option<&str>) -> Value {
    let mut asset = json!({ "version": "2.0", "generator": concat!("arabesque ", env!("CARGO_PKG_VERSION")) });
    if let Some(recipe) = recipe {
        asset["extras"] = json!({ RECIPE: recipe });
    }
    asset
}

/// A file of a document and its binary chunk; `advice` says how to get a smaller one.
pub(super) fn container(document: &impl Serialize, binary: &[u8], advice: &str) -> Result<Vec<u8>> {
    let mut text = serde_json::to_vec(document).map_err(|e| Error::input("GLB file", e.to_string(), advice))?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let size = |n: usize| {
        u32::try_from(n).map_err(|_| Error::Limit {
            what: "size of the GLB file".into(),
            found: format!("{n} bytes"),
            limit: format!("{} bytes", u32::MAX),
            advice: advice.into(),
        })
    };
    let mut bytes = Vec::with_capacity(total);
    bytes.extend_from_slice(MAGIC);
    for number in [VERSION, size(total)?, size(text.len())?] {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    bytes.extend_from_slice(JSON_CHUNK);
    bytes.extend_from_slice(&text);
    bytes.extend_from_slice(&size(binary.len())?.to_le_bytes());
    bytes.extend_from_slice(BINARY_CHUNK);
    bytes.extend_from_slice(binary);
    Ok(bytes)
}

/// Whether the bytes are a glTF file, as GLB or as text.
pub fn is_gltf(bytes: &[u8]) -> bool {
    let is_text = || {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        // The head may be of any length: a recipe with all that it needs stands in the asset.
        let names = |word: &[u8]| bytes.windows(word.len()).any(|part| part == word);
        text.starts_with(b"{") && names(b"\"asset\"") && (names(b"\"nodes\"") || names(b"\"meshes\""))
    };
    is_glb(bytes) || is_text()
}

/// Whether the bytes start as a GLB file does.
pub fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// The document and the binary chunk of a file.
///
/// # Errors
/// [`Error::Input`] when the file is not what its header says.
pub(super) fn chunks<'a>(name: &str, bytes: &'a [u8]) -> Result<(&'a [u8], &'a [u8])> {
    let number = |at: usize| -> Option<usize> {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?) as usize)
    };
    let fail = |problem: String| Err(Error::input(name, problem, "write the file again; it is no GLB, or was cut off"));
    if !is_glb(bytes) {
        return fail("a file that does not begin with glTF".into());
    }
    match number(4) {
        Some(2) => {}
        Some(version) => return fail(format!("version {version} of GLB where 2 was expected")),
        None => return fail("a file that ends in its header".into()),
    }
    if let Some(length) = number(8).filter(|length| *length > bytes.len()) {
        return fail(format!("{} bytes where its header says {length}", bytes.len()));
    }
    let mut found: [Option<&[u8]>; 2] = [None; 2];
    let mut at = 12;
    while let Some(length) = number(at) {
        let Some(chunk) = at.checked_add(8).and_then(|from| bytes.get(from..from.checked_add(length)?)) else {
            return fail(format!("a chunk of {length} bytes at byte {at}, where the file ends before"));
        };
        let kind = &bytes[at + 4..at + 8];
        let place = [JSON_CHUNK, BINARY_CHUNK].iter().position(|known| known.as_slice() == kind);
        // Other chunks are to be passed over.
        if let Some(place) = place {
            found[place].get_or_insert(chunk);
        }
        at += 8 + length.next_multiple_of(4);
    }
    match found {
        [Some(document), binary] => Ok((document, binary.unwrap_or_default())),
        _ => fail("no JSON chunk".into()),
    }
}

/// A GLB file as text: the document alone, with its bytes inside it as Base64.
///
/// # Errors
/// [`Error::Input`] for what is no GLB file, [`Error::Limit`] when the memory is used up.
pub fn as_text(glb: &[u8], budget: &Budget) -> Result<Vec<u8>> {
    let name = "GLB file";
    let (text, binary) = chunks(name, glb)?;
    let _held = budget.hold("a scene as text", glb.len().saturating_mul(IN_TEXT))?;
    budget.spend(PER_BYTE.saturating_mul(glb.len() as u64))?;
    let text = std::str::from_utf8(text).map_err(|e| Error::input(name, e.to_string(), "write GLB instead"))?;
    let text = text.trim_end_matches([' ', '\0']);
    // Within strings there are no quotes, so that this is the list itself.
    let Some((before, after)) = text.rsplit_once(BUFFER) else { return Ok(format!("{text}\n").into_bytes()) };
    let mut out = String::with_capacity(text.len() + binary.len() / 3 * 4 + BYTES.len() + 64);
    out += before;
    out += BUFFER;
    out += "\"uri\":\"";
    out += BYTES;
    STANDARD.encode_string(binary, &mut out);
    out += "\",";
    out += after;
    out.push('\n');
    Ok(out.into_bytes())
}

/// What [`as_text`] wrote, as the GLB file that it was.
///
/// # Errors
/// [`Error::Unsupported`] for a text whose bytes do not stand in it as [`as_text`] writes them, [`Error::Limit`] when the memory is used up.
pub(super) fn from_text(name: &str, text: &str, budget: &Budget) -> Result<Vec<u8>> {
    let _held = budget.hold("a scene as text", text.len().saturating_mul(IN_TEXT))?;
    budget.spend(PER_BYTE.saturating_mul(text.len() as u64))?;
    let text = text.trim_end();
    let foreign = || Error::Unsupported {
        what: format!("{name}: a glTF file whose bytes lie elsewhere than in one data URI"),
        advice: "write the scene with arabesque, or as GLB".into(),
    };
    let advice = "write the scene again";
    let raw = |document: String| RawValue::from_string(document).map_err(|e| Error::input(name, e.to_string(), advice));
    let start = format!("{BUFFER}\"uri\":\"{BYTES}");
    let Some((before, rest)) = text.rsplit_once(&start) else {
        return if text.contains("\"buffers\"") {
            Err(foreign())
        } else {
            container(&raw(text.to_owned())?, &[], advice)
        };
    };
    let (encoded, after) = rest.split_once("\",").ok_or_else(foreign)?;
    let binary = STANDARD.decode(encoded).map_err(|e| Error::input(name, format!("its data URI: {e}"), advice))?;
    container(&raw([before, BUFFER, after].concat())?, &binary, advice)
}

/// How the list of buffers begins in a document.
const BUFFER: &str = "\"buffers\":[{";
/// How bytes in a text begin.
const BYTES: &str = "data:application/octet-stream;base64,";
/// Memory and work of a byte of a file that becomes text.
const IN_TEXT: usize = 4;
const PER_BYTE: u64 = 10;

/// The recipe in a file that this library wrote, as GLB or as text.
pub fn recipe_of(bytes: &[u8]) -> Option<String> {
    let text = if is_glb(bytes) {
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        bytes.get(20..20_usize.checked_add(length)?)?
    } else {
        bytes
    };
    let document: Value = serde_json::from_slice(text).ok()?;
    Some(document.get("asset")?.get("extras")?.get(RECIPE)?.as_str()?.to_owned())
}
