//! Names in USD: of prims, which are identifiers, and in quotes.

use std::collections::BTreeSet;

/// Identifiers of one place, each once.
#[derive(Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// An identifier that resembles a name and is not taken yet.
    pub(super) fn unique(&mut self, name: &str, otherwise: &str) -> String {
        let letters = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
        let mut base: String = letters.collect();
        if base.chars().all(|c| c == '_') {
            base = otherwise.to_owned();
        }
        if base.starts_with(|c: char| c.is_ascii_digit()) {
            base.insert(0, '_');
        }
        let mut found = base.clone();
        let mut next = 1;
        while !self.0.insert(found.clone()) {
            next += 1;
            found = format!("{base}_{next}");
        }
        found
    }
}

/// A text in quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\n' => out += "\\n",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers_and_differ() {
        let mut names = Names::default();
        let found = ["plum", "plum", "plum.001", "7 up", "", "\u{fc}", "plum_2"].map(|name| names.unique(name, "mesh"));
        assert_eq!(found, ["plum", "plum_2", "plum_001", "_7_up", "mesh", "mesh_2", "plum_2_2"]);
        assert_eq!(quoted("a \"b\"\\\n\u{7}"), r#""a \"b\"\\\n ""#);
    }
}
