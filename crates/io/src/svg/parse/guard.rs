//! Checks on the raw text, before an XML parser sees it: nesting, entities, size.

use std::collections::BTreeMap;

use arabesque_core::{Error, Limits, Result};

/// Longest text that all entity references of a file may stand for, beyond the size of the file itself.
const EXPANSION: usize = 16 << 20;

/// Refuses text that is too large, nested too deeply, or blown up by entities.
pub(crate) fn check(text: &str, name: &str, limits: &Limits) -> Result<()> {
    if text.trim().is_empty() {
        return Err(Error::input(name, "the file is empty, expected SVG", "choose another file"));
    }
    if text.len() > limits.file_bytes {
        return Err(too_much(format!("{name}: bytes"), text.len(), limits.file_bytes as u64));
    }
    let deepest = depth(text);
    // XML outside of groups adds a few levels: the root, definitions, gradients and their stops.
    let allowed = limits.depth + 16;
    if deepest > allowed {
        return Err(too_much(format!("{name}: nested XML elements"), deepest, allowed as u64));
    }
    check_entities(text, name)
}

/// A limit that the file exceeds.
pub(crate) fn too_much(what: String, found: impl ToString, limit: u64) -> Error {
    Error::Limit {
        what,
        found: found.to_string(),
        limit: limit.to_string(),
        advice: "make the file smaller or simpler".into(),
    }
}

/// Depth of the deepest element, by counting tags.
fn depth(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut now, mut deepest, mut at) = (0_usize, 0, 0);
    while let Some(open) = find(text, at, "<") {
        let rest = &bytes[open..];
        if rest.starts_with(b"<!--") {
            at = after(text, open + 4, "-->");
        } else if rest.starts_with(b"<![CDATA[") {
            at = after(text, open + 9, "]]>");
        } else if rest.starts_with(b"<?") {
            at = after(text, open + 2, "?>");
        } else if rest.starts_with(b"<!") {
            at = doctype_end(bytes, open + 2);
        } else {
            let end = tag_end(bytes, open + 1);
            let closing = rest.get(1) == Some(&b'/');
            let empty = end >= 2 && bytes.get(end - 2) == Some(&b'/');
            match (closing, empty) {
                (true, _) => now = now.saturating_sub(1),
                (false, false) => now += 1,
                (false, true) => {}
            }
            deepest = deepest.max(now + usize::from(empty));
            at = end;
        }
    }
    deepest
}

fn find(text: &str, from: usize, needle: &str) -> Option<usize> {
    text.get(from..)?.find(needle).map(|k| from + k)
}

fn after(text: &str, from: usize, needle: &str) -> usize {
    find(text, from, needle).map_or(text.len(), |k| k + needle.len())
}

/// Position after the `>` that ends a tag; quoted values may hold one.
fn tag_end(bytes: &[u8], from: usize) -> usize {
    let mut quote = None;
    for (k, &b) in bytes.iter().enumerate().skip(from) {
        match (quote, b) {
            (None, b'"' | b'\'') => quote = Some(b),
            (None, b'>') => return k + 1,
            (Some(q), _) if q == b => quote = None,
            _ => {}
        }
    }
    bytes.len()
}

/// Position after a document type declaration, its internal subset included.
fn doctype_end(bytes: &[u8], from: usize) -> usize {
    let (mut quote, mut inside) = (None, 0_usize);
    for (k, &b) in bytes.iter().enumerate().skip(from) {
        match (quote, b) {
            (None, b'"' | b'\'') => quote = Some(b),
            (Some(q), _) if q == b => quote = None,
            (None, b'[' | b'<') => inside += 1,
            (None, b']') => inside = inside.saturating_sub(1),
            (None, b'>') if inside == 0 => return k + 1,
            (None, b'>') => inside -= 1,
            _ => {}
        }
    }
    bytes.len()
}

/// Entity values by name, as far as the declarations are well formed; the XML parser reports the others.
fn entities(text: &str) -> BTreeMap<&str, &str> {
    let mut found = BTreeMap::new();
    for declaration in text.split("<!ENTITY").skip(1) {
        let trimmed = declaration.trim_start();
        let Some((name, rest)) = trimmed.split_once(char::is_whitespace) else { continue };
        let rest = rest.trim_start();
        let Some(quote) = rest.chars().next().filter(|c| matches!(c, '"' | '\'')) else { continue };
        if let Some((value, _)) = rest[1..].split_once(quote) {
            found.entry(name).or_insert(value);
        }
    }
    found
}

/// Names referred to as `&name;`, in order.
fn references(text: &str) -> impl Iterator<Item = &str> {
    text.split('&').skip(1).filter_map(|rest| {
        let (name, _) = rest.split_at(rest.find(';').filter(|&end| end <= 256)?);
        (!name.is_empty() && !name.starts_with('#')).then_some(name)
    })
}

fn check_entities(text: &str, name: &str) -> Result<()> {
    let declared = entities(text);
    if declared.is_empty() {
        return Ok(());
    }
    if let Some((entity, _)) = declared.iter().find(|(_, value)| value.contains('<')) {
        return Err(Error::Unsupported {
            what: format!("{name}: markup inside the entity \"{entity}\""),
            advice: "save the file as plain SVG".into(),
        });
    }
    let mut sizes = BTreeMap::new();
    let mut total = 0_usize;
    for reference in references(text) {
        total = total.saturating_add(expanded(reference, &declared, &mut sizes, 0));
    }
    let allowed = EXPANSION + text.len();
    if total > allowed {
        return Err(too_much(format!("{name}: text that entities expand to"), total, allowed as u64));
    }
    Ok(())
}

/// Length of an entity once expanded; endless for one that refers to itself.
fn expanded<'a>(
    entity: &'a str,
    declared: &BTreeMap<&'a str, &'a str>,
    sizes: &mut BTreeMap<&'a str, usize>,
    nested: usize,
) -> usize {
    if let Some(&size) = sizes.get(entity) {
        return size;
    }
    let Some(value) = declared.get(entity) else { return 1 };
    // More than a handful of levels occurs in attacks only; the XML parser refuses ten.
    if nested > 10 {
        return usize::MAX;
    }
    let inner = references(value).map(|r| expanded(r, declared, sizes, nested + 1));
    let size = inner.fold(value.len(), usize::saturating_add);
    sizes.insert(entity, size);
    size
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        check(text, "f.svg", &Limits::default()).map_or_else(|e| e.to_string(), |()| "fine".into())
    }

    #[test]
    fn depth_counts_tags_not_comments_or_quotes() {
        assert_eq!(depth("<a><!-- <b><b> --><c d='<x>' /><e></e></a>"), 2);
        assert_eq!(depth("<?xml?><!DOCTYPE a [<!ENTITY b 'c'>]><a><b><c/></b></a>"), 3);
    }

    #[test]
    fn ten_thousand_groups_are_refused_at_once() {
        let text = format!("<svg>{}{}</svg>", "<g>".repeat(10_000), "</g>".repeat(10_000));
        assert!(message(&text).contains("over the limit of"));
    }

    #[test]
    fn names_by_entity_are_fine_and_bombs_are_not() {
        assert_eq!(message("<!DOCTYPE svg [<!ENTITY ns 'http://x'>]><svg a='&ns;'/>"), "fine");
        let mut bomb = String::from("<!DOCTYPE svg [<!ENTITY a0 'ha'>");
        for k in 1..9 {
            bomb += &format!("<!ENTITY a{k} '{}'>", format!("&a{};", k - 1).repeat(10));
        }
        bomb += "]><svg a='&a8;'/>";
        assert!(message(&bomb).contains("entities expand"));
        assert!(message("<!DOCTYPE s [<!ENTITY a '&b;'><!ENTITY b '&a;'>]><s>&a;</s>").contains("entities expand"));
        let long = format!("<!DOCTYPE s [<!ENTITY a '{}'>]><s>{}</s>", "x".repeat(10_000), "&a;".repeat(10_000));
        assert!(message(&long).contains("entities expand"));
    }

    #[test]
    fn nothing_is_not_an_svg() {
        assert!(message(" \n").contains("empty"));
    }
}
