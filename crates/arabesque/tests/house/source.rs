//! A little of Rust's grammar: which paths a source file names, outside of comments, texts and its own tests.

use std::path::Path;

/// A path as it is written, such as `crate::space::Vector`, with the name that a `use` gives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    /// The segments; `*` as the last one of a glob.
    pub(crate) path: Vec<String>,
    /// The name under which a `use` brings it into the file; `None` where it is written in place.
    pub(crate) alias: Option<String>,
    /// Whether the `use` is a re-export.
    pub(crate) reexported: bool,
}

/// The words and signs of the code of a file: no comments, no texts, nothing of test modules.
pub(crate) fn tokens(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = comment(rest).or_else(|| literal(rest));
        if let Some(length) = skipped {
            rest = &rest[length..];
            continue;
        }
        let length = match c {
            c if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            ':' if rest.starts_with("::") => 2,
            c => c.len_utf8(),
        };
        if !c.is_whitespace() {
            found.push(rest[..length].to_owned());
        }
        rest = &rest[length..];
    }
    without_tests(&found)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Bytes of the comment that `rest` starts with.
fn comment(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if !rest.starts_with("/*") {
        return None;
    }
    let mut depth = 0;
    for (at, _) in rest.char_indices() {
        match &rest.as_bytes()[at..] {
            [b'/', b'*', ..] => depth += 1,
            [b'*', b'/', ..] if depth == 1 => return Some(at + 2),
            [b'*', b'/', ..] => depth -= 1,
            _ => {}
        }
    }
    None
}

/// Bytes of the text or character that `rest` starts with.
fn literal(rest: &str) -> Option<usize> {
    let opening = rest.trim_start_matches(['b', 'r']);
    let is_raw = rest[..rest.len() - opening.len()].contains('r');
    let hashes = opening.len() - opening.trim_start_matches('#').len();
    let prefix = rest.len() - opening.len();
    if is_raw && prefix <= 2 && opening[hashes..].starts_with('"') {
        let end = format!("\"{}", "#".repeat(hashes));
        return opening[hashes + 1..].find(&end).map(|at| prefix + hashes + 1 + at + end.len());
    }
    if prefix <= 1 && !is_raw && opening.starts_with('"') {
        return closing(opening, '"').map(|end| prefix + end);
    }
    // A lifetime has no second quote right behind its first letter.
    let is_character =
        rest.starts_with("'\\") || rest.strip_prefix('\'').is_some_and(|r| r.chars().nth(1) == Some('\''));
    if is_character { closing(rest, '\'') } else { None }
}

/// Bytes up to the quote that ends a literal, quote included.
fn closing(text: &str, quote: char) -> Option<usize> {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return Some(at + c.len_utf8()),
            _ => {}
        }
    }
    None
}

/// Leaves out what stands under `#[cfg(test)]`.
fn without_tests(all: &[String]) -> Vec<String> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::new();
    let mut k = 0;
    while k < all.len() {
        if !all[k..].iter().map(String::as_str).take(MARK.len()).eq(MARK) {
            kept.push(all[k].clone());
            k += 1;
            continue;
        }
        let mut depth = 0;
        for (n, token) in all.iter().enumerate().skip(k + MARK.len()) {
            match token.as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                _ => {}
            }
            k = n + 1;
            if depth == 0 && matches!(token.as_str(), "}" | ";") {
                break;
            }
        }
    }
    kept
}

/// Every path that the code names, in `use` statements and in place.
pub(crate) fn named(tokens: &[String]) -> Vec<Named> {
    let mut found = Vec::new();
    let mut k = 0;
    while k < tokens.len() {
        if tokens[k] == "use" {
            let end = tokens[k..].iter().position(|t| t == ";").map_or(tokens.len(), |n| k + n);
            let reexported = k > 0 && matches!(tokens[k - 1].as_str(), "pub" | ")");
            let mut leaves = Vec::new();
            tree(&tokens[k + 1..end], &[], &mut leaves);
            found.extend(leaves.into_iter().map(|(path, alias)| Named { path, alias: Some(alias), reexported }));
            k = end + 1;
            continue;
        }
        let mut path = vec![tokens[k].clone()];
        let starts = k == 0 || tokens[k - 1] != "::";
        while starts && tokens.get(k + 1).is_some_and(|t| t == "::") {
            match tokens.get(k + 2).filter(|t| t.starts_with(is_word)) {
                Some(next) => path.push(next.clone()),
                None => break,
            }
            k += 2;
        }
        // `pub(in path)` says who may see a thing, not what it needs.
        let is_visibility = k >= 2 * path.len() && tokens[k - 2 * path.len() + 1] == "in";
        if path.len() > 1 && !is_visibility {
            found.push(Named { path, alias: None, reexported: false });
        }
        k += 1;
    }
    found
}

/// The leaves of a `use` tree: full path and name.
fn tree(tokens: &[String], before: &[String], leaves: &mut Vec<(Vec<String>, String)>) {
    let mut path = before.to_vec();
    let mut k = 0;
    while k < tokens.len() {
        match tokens[k].as_str() {
            "::" => {}
            "{" => {
                let inner = &tokens[k + 1..tokens.len() - 1];
                for branch in branches(inner) {
                    tree(branch, &path, leaves);
                }
                return;
            }
            "as" => {
                let alias = tokens.get(k + 1).cloned().unwrap_or_default();
                return leaves.push((path, alias));
            }
            "self" if !path.is_empty() => {}
            word => path.push(word.to_owned()),
        }
        k += 1;
    }
    if let Some(last) = path.last().cloned() {
        leaves.push((path, last));
    }
}

/// The parts between the commas that are in no inner braces.
fn branches(tokens: &[String]) -> Vec<&[String]> {
    let mut depth = 0;
    let parts = tokens.split(|token| {
        match token.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        token == "," && depth == 0
    });
    parts.filter(|part| !part.is_empty()).collect()
}

/// The module that a source file below `src` is.
pub(crate) fn module_of(file: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        file.with_extension("").components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
    if matches!(names.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        names.pop();
    }
    names
}

#[test]
fn paths_are_found_in_code_and_nowhere_else() {
    let text = r##"
//! see std::env
use std::{fs, path::{self, Path as P}};
pub(crate) use child::Thing;
/* std::net */ const A: &str = "std::process \" std::process"; const B: &str = r#"std::process"#;
fn f<'a>(x: &'a str) -> char { crate::deep::down::call::<u8>(x); ';' }
#[cfg(test)]
mod tests { use std::env; fn g() { std::net::x() } }
fn h() { super::up() }
pub(in crate::recipe) fn i() {}
"##;
    let names: Vec<String> = named(&tokens(text)).iter().map(|n| n.path.join("::")).collect();
    let expected = ["std::fs", "std::path", "std::path::Path", "child::Thing", "crate::deep::down::call", "super::up"];
    assert_eq!(names, expected);
    let all = named(&tokens(text));
    assert_eq!((all[2].alias.as_deref(), all[3].reexported, all[0].reexported), (Some("P"), true, false));
}
