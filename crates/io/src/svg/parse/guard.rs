//! Checks on the raw text, before a parser sees it: size, nesting, entities and attributes of XML; runs in path data.

use std::{borrow::Cow, collections::BTreeMap};

use arabesque_core::{Error, Limits, Result, rounded};
use svgtypes::{PathParser, PathSegment};

/// Longest text that all entity references of a file may stand for, beyond the size of the file itself.
const EXPANSION: usize = 16 << 20;

/// Refuses text that is too large, nested too deeply, or blown up by entities.
pub(crate) fn check(text: &str, name: &str, limits: &Limits) -> Result<()> {
    if text.trim().is_empty() {
        return Err(Error::input(name, "nothing in it, expected SVG", "give a drawing with something in it"));
    }
    if text.len() > limits.file_bytes {
        return Err(over(format!("{name}: bytes"), text.len(), ("file-bytes", limits.file_bytes)));
    }
    let Tags { deepest, attributes, namespaces } = tags(text);
    if attributes > ATTRIBUTES {
        return Err(too_much(format!("{name}: attributes of one XML element"), attributes, ATTRIBUTES as u64));
    }
    if namespaces > NAMESPACES {
        return Err(too_much(format!("{name}: declarations of XML namespaces"), namespaces, NAMESPACES as u64));
    }
    // XML outside of groups adds a few levels: the root, definitions, gradients and their stops.
    let allowed = limits.depth + 16;
    if deepest > allowed {
        return Err(too_much(format!("{name}: nested XML elements"), deepest, allowed as u64));
    }
    check_entities(text, name)
}

/// A limit that the file exceeds, and that may be raised by its name.
pub(crate) fn over(what: String, found: impl ToString, (name, limit): (&str, usize)) -> Error {
    let found = found.to_string();
    // What is counted bit by bit may not be all yet.
    let enough = found.parse().unwrap_or(0).max(limit.saturating_mul(2));
    let advice = format!("make the file smaller or simpler{}", Limits::raising(name, enough as f64));
    Error::Limit { what, found, limit: limit.to_string(), advice }
}

/// More XML nodes than the limit.
pub(crate) fn over_nodes(name: &str, limits: &Limits) -> Error {
    over(format!("{name}: XML nodes"), format!("more than {}", limits.nodes), ("nodes", limits.nodes))
}

/// A bound that the file exceeds, and that stays.
pub(crate) fn too_much(what: String, found: impl ToString, limit: u64) -> Error {
    Error::Limit {
        what,
        found: found.to_string(),
        limit: limit.to_string(),
        advice: "make the file smaller or simpler".into(),
    }
}

/// Attributes of one element: each is compared with those before it.
const ATTRIBUTES: usize = 5000;
/// Declarations of namespaces in one file: each element keeps a list of those around it.
const NAMESPACES: usize = 20_000;

/// What the tags of a file add up to.
#[derive(Debug, Default)]
struct Tags {
    /// Depth of the deepest element.
    deepest: usize,
    /// Most quoted values in one tag.
    attributes: usize,
    /// Declarations of namespaces.
    namespaces: usize,
}

fn tags(text: &str) -> Tags {
    let bytes = text.as_bytes();
    let (mut now, mut deepest, mut attributes, mut at) = (0_usize, 0, 0, 0);
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
            let (end, values) = tag_end(bytes, open + 1);
            attributes = attributes.max(values);
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
    Tags { deepest, attributes, namespaces: text.matches("xmlns").count() }
}

fn find(text: &str, from: usize, needle: &str) -> Option<usize> {
    text.get(from..)?.find(needle).map(|k| from + k)
}

fn after(text: &str, from: usize, needle: &str) -> usize {
    find(text, from, needle).map_or(text.len(), |k| k + needle.len())
}

/// Position after the `>` that ends a tag, and how many quoted values it has; these may hold one.
fn tag_end(bytes: &[u8], from: usize) -> (usize, usize) {
    let (mut quote, mut values) = (None, 0);
    for (k, &b) in bytes.iter().enumerate().skip(from) {
        match (quote, b) {
            (None, b'"' | b'\'') => (quote, values) = (Some(b), values + 1),
            (None, b'>') => return (k + 1, values),
            (Some(q), _) if q == b => quote = None,
            _ => {}
        }
    }
    (bytes.len(), values)
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
        let end = rest.bytes().take(257).position(|b| b == b';')?;
        let name = rest.get(..end)?;
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

/// Closes in a row from which on they are put together.
const CLOSES: usize = 100;
/// Arcs in a row that may end where they start.
const NO_ARCS: usize = 500;
/// Radius of an arc in chords from which on it is no arc to a computer.
const FLAT: f64 = 1e12;
/// Radius up to which that is rounding: of an arc that was to end where it starts.
const ROUNDING: f64 = 1e6;
/// Distance of the ends of an arc from which on its square is a number other than zero, whatever the radius.
const CHORD: f64 = 1e-100;

/// Path data as the parser may have it, which takes every segment that draws nothing one level deeper: closes in a row are one.
/// The error is what is wrong with it: an arc with a radius or an end beyond `largest`, or that is no arc.
pub(crate) fn path_data(data: &str, largest: f64) -> std::result::Result<Cow<'_, str>, String> {
    let data = if most_closes(data) > CLOSES { Cow::Owned(closed_once(data)) } else { Cow::Borrowed(data) };
    if data.contains(['a', 'A']) {
        check_arcs(&data, largest)?;
    }
    Ok(data)
}

fn most_closes(data: &str) -> usize {
    let (mut run, mut most) = (0, 0);
    for b in data.bytes() {
        match b {
            b'z' | b'Z' => run += 1,
            b' ' | b'\t' | b'\n' | b'\r' => {}
            _ => run = 0,
        }
        most = most.max(run);
    }
    most
}

fn closed_once(data: &str) -> String {
    let mut out = String::with_capacity(data.len());
    let mut is_closed = false;
    for c in data.chars() {
        let closes = matches!(c, 'z' | 'Z');
        if is_closed && (closes || c.is_ascii_whitespace()) {
            continue;
        }
        if is_closed {
            out.push(' ');
        }
        is_closed = closes;
        out.push(c);
    }
    out
}

/// Refuses arcs with a radius or an end that is no sensible number, and those that are no arcs to a computer: they are taken apart, into
/// the more pieces the larger they are, before anybody sees their coordinates.
fn check_arcs(data: &str, largest: f64) -> std::result::Result<(), String> {
    let (mut at, mut start, mut run) = ([0.0; 2], [0.0; 2], 0);
    // What cannot be read is told by whoever reads it in earnest.
    for segment in PathParser::from(data).map_while(std::result::Result::ok) {
        let (from, to) = (at, end_of(&segment, at, start));
        at = to;
        if let PathSegment::MoveTo { .. } = segment {
            start = to;
        }
        let PathSegment::EllipticalArc { rx, ry, .. } = segment else {
            run = 0;
            continue;
        };
        let radius = rx.abs().max(ry.abs());
        if !(0.0..=largest).contains(&radius) {
            return Err(format!("an arc has a radius of {}, expected at most {largest:e}", rounded(radius)));
        }
        if let Some(v) = [from, to].as_flattened().iter().find(|v| !(-largest..=largest).contains(*v)) {
            return Err(format!(
                "an arc ends at {}, expected a number between -{largest:e} and {largest:e}",
                rounded(*v)
            ));
        }
        let chord = (to[0] - from[0]).hypot(to[1] - from[1]);
        let is_flat = radius > FLAT * chord;
        if is_flat && chord > 0.0 && (radius > ROUNDING || chord < CHORD) {
            return Err(format!(
                "an arc has a radius of {} for ends {chord:e} apart, expected a line or an arc",
                rounded(radius)
            ));
        }
        run = if is_flat { run + 1 } else { 0 };
        if run > NO_ARCS {
            let all = PathParser::from(data).filter(|s| matches!(s, Ok(PathSegment::EllipticalArc { .. }))).count();
            return Err(format!("many of its {all} arcs end where they start, expected arcs with two ends"));
        }
    }
    Ok(())
}

/// Where a segment that starts at `at` ends.
fn end_of(segment: &PathSegment, at: [f64; 2], start: [f64; 2]) -> [f64; 2] {
    let to = |abs: bool, x: f64, y: f64| if abs { [x, y] } else { [at[0] + x, at[1] + y] };
    match *segment {
        PathSegment::MoveTo { abs, x, y }
        | PathSegment::LineTo { abs, x, y }
        | PathSegment::CurveTo { abs, x, y, .. }
        | PathSegment::SmoothCurveTo { abs, x, y, .. }
        | PathSegment::Quadratic { abs, x, y, .. }
        | PathSegment::SmoothQuadratic { abs, x, y }
        | PathSegment::EllipticalArc { abs, x, y, .. } => to(abs, x, y),
        PathSegment::HorizontalLineTo { abs, x } => [to(abs, x, 0.0)[0], at[1]],
        PathSegment::VerticalLineTo { abs, y } => [at[0], to(abs, 0.0, y)[1]],
        PathSegment::ClosePath { .. } => start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        check(text, "f.svg", &Limits::default()).map_or_else(|e| e.to_string(), |()| "fine".into())
    }

    #[test]
    fn attributes_and_namespaces_are_counted() {
        let many = |n: usize, what: &str| (0..n).map(|k| format!(" {what}{k}='x'")).collect::<String>();
        assert_eq!(message(&format!("<svg{}/>", many(4000, "a"))), "fine");
        assert!(message(&format!("<svg{}/>", many(50_000, "a"))).contains("attributes of one XML element"));
        let spread: String = (0..50_000).map(|k| format!("<g xmlns:a{k}='x'/>")).collect();
        assert!(message(&format!("<svg>{spread}</svg>")).contains("namespaces"));
    }

    #[test]
    fn entities_that_are_not_closed_take_no_time() {
        let text = format!("<!DOCTYPE s [<!ENTITY a 'x'>]><s>{}</s>", "&".repeat(2_000_000));
        assert_eq!(message(&text), "fine", "the XML parser refuses it");
    }

    #[test]
    fn closes_in_a_row_are_one() {
        let data = |text: &str| path_data(text, 1e15).map(Cow::into_owned);
        assert_eq!(data("M0 0h1v1zzz z").unwrap(), "M0 0h1v1zzz z", "a few are left as they are");
        assert_eq!(data(&format!("M0 0h1v1{}M5 5h1v1z", "z Z\n".repeat(5000))).unwrap(), "M0 0h1v1z M5 5h1v1z");
    }

    #[test]
    fn arcs_without_end_are_refused() {
        let problem = |text: &str| path_data(text, 1e15).unwrap_err();
        assert!(problem("M0 0A1e155 5 0 0 1 3 3").contains("1e155"));
        assert!(problem("M0 0A1e14 1e14 0 0 1 1e-9 0").contains("1e14"));
        assert!(problem("M0 0A5 5 0 0 1 1e30 3").contains("an arc ends at 1e30"));
        assert!(problem("M0-1e200a5 5 0 0 1 3 3").contains("an arc ends at -1e200"));
        assert!(problem("M0 0L1e308 0l1e308 0a5 5 0 0 1 3 3").contains("an arc ends at inf"));
        assert!(problem("M0 0a.1.1 30 0 1 1e-300 0").contains("1e-300 apart"));
        assert!(problem(&format!("M0 0L1 1{}", "A5 5 0 0 1 1 1.0000000000001e0".repeat(3000))).contains("3000 arcs"));
        assert!(path_data(&format!("M0 0{}", "a5 5 0 0 1 1 1".repeat(3000)), 1e15).is_ok());
    }

    #[test]
    fn depth_counts_tags_not_comments_or_quotes() {
        assert_eq!(tags("<a><!-- <b><b> --><c d='<x>' /><e></e></a>").deepest, 2);
        assert_eq!(tags("<?xml?><!DOCTYPE a [<!ENTITY b 'c'>]><a><b><c/></b></a>").deepest, 3);
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
        assert!(message(" \n").contains("nothing in it"));
    }
}
