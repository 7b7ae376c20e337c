//! Rules: selectors that are understood stay, others are told.

use std::fmt::Write as _;

use simplecss::StyleSheet;

use super::declarations::{declarations, find, split};

/// Stands before the number of a value in [`Plain::values`].
const NUMBERED: char = '\u{e000}';
/// What `:root` is written as: an attribute that elements without a parent are said to have.
pub(crate) const ROOT: &str = "arabesque-root";
/// Selectors that are told, at most: what goes on beyond them is no news.
const TOLD: usize = 1000;

/// Style sheet text as the parser of selectors may have it.
#[derive(Debug, Default)]
pub(crate) struct Plain {
    pub(crate) css: String,
    /// Values that are no plain words; in the text stands the number of each.
    pub(crate) values: Vec<String>,
    /// Selectors and rules that are not understood.
    pub(crate) unknown: Vec<String>,
}

/// The value that stands for `text` in a sheet.
pub(crate) fn value<'v>(values: &'v [String], text: &'v str) -> &'v str {
    let number = text.strip_prefix(NUMBERED).and_then(|n| n.parse::<usize>().ok());
    number.and_then(|n| values.get(n)).map_or(text, String::as_str)
}

/// Rules without what would lead the parser of selectors astray.
pub(crate) fn plain(css: &str) -> Plain {
    let mut plain = Plain::default();
    let mut at = 0;
    loop {
        at = after_blanks(css, at);
        if at >= css.len() {
            return plain;
        }
        if css[at..].starts_with('@') {
            at = plain.skip_at_rule(css, at);
            continue;
        }
        let open = find(css, at, b"{}");
        if css.as_bytes().get(open) != Some(&b'{') {
            at = open + 1;
            continue;
        }
        let close = block_end(css, open);
        plain.rule(&css[at..open], css.get(open + 1..close).unwrap_or_default());
        at = close + 1;
    }
}

/// Position of the brace that closes the block that opens at `open`.
fn block_end(css: &str, open: usize) -> usize {
    let (mut at, mut depth) = (open, 0_usize);
    while at < css.len() {
        match css.as_bytes()[at] {
            b'{' => depth += 1,
            _ => depth -= 1,
        }
        if depth == 0 {
            return at;
        }
        at = find(css, at + 1, b"{}");
    }
    css.len()
}

fn after_blanks(css: &str, mut at: usize) -> usize {
    loop {
        let rest = &css[at.min(css.len())..];
        let blank = rest.len() - rest.trim_start().len();
        at = at.min(css.len()) + blank;
        match css[at..].strip_prefix("/*") {
            Some(comment) => at += 2 + comment.find("*/").map_or(comment.len(), |k| k + 2),
            None => return at,
        }
    }
}

impl Plain {
    fn tell(&mut self, what: &str) {
        if self.unknown.len() < TOLD {
            self.unknown.push(what.split_whitespace().collect::<Vec<_>>().join(" "));
        }
    }

    /// Skips a rule such as `@media`; what has nothing to do with the looks of shapes is not told.
    fn skip_at_rule(&mut self, css: &str, at: usize) -> usize {
        const SILENT: [&str; 7] =
            ["@import", "@charset", "@namespace", "@font-face", "@keyframes", "@-webkit-keyframes", "@page"];
        let end = find(css, at, b";{}");
        let prelude = css[at..end].trim();
        let name = prelude.split(|c: char| c.is_whitespace() || c == '(').next().unwrap_or_default();
        if !SILENT.iter().any(|silent| name.eq_ignore_ascii_case(silent)) {
            self.tell(prelude);
        }
        if css.as_bytes().get(end) == Some(&b'{') { block_end(css, end) + 1 } else { end + 1 }
    }

    fn rule(&mut self, prelude: &str, body: &str) {
        let is_name = |name: &str| name.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_".contains(&b));
        let declared: Vec<_> = declarations(body).filter(|d| is_name(d.name)).collect();
        let mut understood = Vec::new();
        for selector in split(prelude, b',').map(str::trim) {
            let written = selector.replace(":root", &format!("[{ROOT}]"));
            if is_understood(&written) {
                understood.push(written);
            } else if !declared.is_empty() {
                self.tell(selector);
            }
        }
        if understood.is_empty() {
            return;
        }
        let _ = write!(self.css, "{}{{", understood.join(","));
        if declared.is_empty() {
            // The rule stays: that a class is used for styling says that it is no name of a kind.
            self.css.push_str("v:0;");
        }
        for d in declared {
            // Names that start with two hyphens are no names to the parser.
            let hidden = if d.name.starts_with("--") { "v" } else { "" };
            let is_plain = d.value.bytes().all(|b| b.is_ascii_alphanumeric() || b"#.,%+- ".contains(&b));
            let important = if d.is_important { "!important" } else { "" };
            if is_plain && hidden.is_empty() {
                let _ = write!(self.css, "{}:{}{important};", d.name, d.value);
            } else {
                let _ = write!(self.css, "{hidden}{}:{NUMBERED}{}{important};", d.name, self.values.len());
                self.values.push(d.value.to_owned());
            }
        }
        self.css.push_str("}\n");
    }
}

/// Selectors longer than this are not looked at: each part of one may be one level deeper.
const LONGEST: usize = 2000;

/// Whether the parser makes one rule of a selector. What never holds in a picture, such as `:hover`, is understood.
fn is_understood(selector: &str) -> bool {
    selector.len() <= LONGEST
        && !selector.starts_with(['>', '+', '~'])
        && StyleSheet::parse(&format!("{selector}{{a:b}}")).rules.len() == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_understood_stays_and_the_rest_is_told() {
        let css = "/* a */ .a, path:nth-child(2n + 1) , .b > g{fill:red;font:1px/2 x} @media print {.c{fill:blue}}
            .a ~ .b{fill:lime} .d{} .d:empty{} .e:hover,#f{stroke:url(#g)} @font-face{x:y} @charset 'x'; .h{fill:blue";
        let found = plain(css);
        assert_eq!(
            found.css,
            ".a,.b > g{fill:red;font:\u{e000}0;}\n.d{v:0;}\n.e:hover,#f{stroke:\u{e000}1;}\n.h{fill:blue;}\n"
        );
        assert_eq!(found.unknown, ["path:nth-child(2n + 1)", "@media print", ".a ~ .b"]);
        assert_eq!((value(&found.values, "\u{e000}1"), value(&found.values, "red")), ("url(#g)", "red"));
    }

    #[test]
    fn roots_and_variables_are_written_so_that_they_are_understood() {
        let found = plain(":root{--x:rgb(1,2,3);--y:red} svg:root{fill:var(--x, var(--y, blue)) !important}");
        assert_eq!(
            found.css,
            "[arabesque-root]{v--x:\u{e000}0;v--y:\u{e000}1;}\nsvg[arabesque-root]{fill:\u{e000}2!important;}\n"
        );
        assert_eq!(found.values, ["rgb(1,2,3)", "red", "var(--x, var(--y, blue))"]);
    }

    #[test]
    fn text_that_is_no_style_sheet_ends() {
        for css in ["}}}{{{,,,", "{", "@", "@x", "a{b:c", "/*", "a{'", "}", "a{{}b{}", "(((", "@media{"] {
            let _ = plain(css);
        }
        assert!(plain(&"{".repeat(100_000)).css.is_empty());
        assert!(plain(&"a{fill:(".repeat(50_000)).unknown.is_empty());
    }
}
