//! Declarations, `name: value`, taken apart by what CSS says of their ends alone, so that one odd value spoils no other.

/// A declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Declared<'a> {
    pub(crate) name: &'a str,
    pub(crate) value: &'a str,
    pub(crate) is_important: bool,
}

/// Position of the first of `stops` from `from` on that stands outside quotes, comments, parentheses and brackets; the end of the text
/// where there is none.
pub(crate) fn find(text: &str, from: usize, stops: &[u8]) -> usize {
    let bytes = text.as_bytes();
    let (mut at, mut depth, mut quote) = (from, 0_usize, None);
    while at < bytes.len() {
        let b = bytes[at];
        match quote {
            Some(_) if b == b'\\' => at += 1,
            // A quote that is not closed ends with its line.
            Some(q) if b == q || b == b'\n' => quote = None,
            Some(_) => {}
            None if bytes[at..].starts_with(b"/*") => {
                at = text[at + 2..].find("*/").map_or(bytes.len(), |k| at + 2 + k + 2);
                continue;
            }
            None if depth == 0 && stops.contains(&b) => return at,
            None => match b {
                b'"' | b'\'' => quote = Some(b),
                b'(' | b'[' => depth += 1,
                b')' | b']' => depth = depth.saturating_sub(1),
                // A brace ends whatever was left open before it.
                b'{' | b'}' if stops.contains(&b) => return at,
                _ => {}
            },
        }
        at += 1;
    }
    bytes.len()
}

/// The parts of a text between separators that stand outside quotes, comments, parentheses and brackets.
pub(crate) fn split(text: &str, separator: u8) -> impl Iterator<Item = &str> {
    let mut from = 0;
    std::iter::from_fn(move || {
        let part = text.get(from..)?;
        let end = find(text, from, &[separator]);
        from = end + 1;
        Some(&part[..part.len() - (text.len() - end)])
    })
}

/// The declarations in the body of a rule or in a style attribute.
pub(crate) fn declarations(body: &str) -> impl Iterator<Item = Declared<'_>> {
    split(body, b';').filter_map(|text| {
        let (name, value) = text.split_at_checked(find(text, 0, b":"))?;
        let name = uncommented(name);
        let value = uncommented(value.strip_prefix(':')?);
        let (value, is_important) = match value.rsplit_once('!') {
            Some((value, word)) if word.trim().eq_ignore_ascii_case("important") => (value.trim(), true),
            _ => (value, false),
        };
        (!name.is_empty() && !value.is_empty()).then_some(Declared { name, value, is_important })
    })
}

/// Without blanks and comments at both ends.
fn uncommented(text: &str) -> &str {
    let mut text = text.trim();
    while let Some(rest) = text.strip_prefix("/*") {
        text = rest.split_once("*/").map_or("", |(_, after)| after.trim_start());
    }
    while let Some((before, _)) = text.strip_suffix("*/").and_then(|t| t.rsplit_once("/*")) {
        text = before.trim_end();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(body: &str) -> Vec<(&str, &str, bool)> {
        declarations(body).map(|d| (d.name, d.value, d.is_important)).collect()
    }

    #[test]
    fn an_odd_value_ends_at_its_semicolon() {
        assert_eq!(
            listed("font: 12px/1.5 'A;b', serif; fill:var(--a, rgb(1,2,3)) ! important;; --x : {y};/* ; */ stroke:red"),
            [
                ("font", "12px/1.5 'A;b', serif", false),
                ("fill", "var(--a, rgb(1,2,3))", true),
                ("--x", "{y}", false),
                ("stroke", "red", false)
            ]
        );
        assert_eq!(listed("fill; :red; a:; b:/* no */"), []);
        assert_eq!(listed("fill:url(#a;stroke:red"), [("fill", "url(#a;stroke:red", false)]);
    }
}
