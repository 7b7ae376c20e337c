//! Files that begin as JSON and are none.

use serde::de::IgnoredAny;

/// What is wrong with a text that should be JSON, and where; `None` where it is JSON.
pub fn flaw(text: &str) -> Option<String> {
    let text = text.trim_start_matches('\u{FEFF}');
    let error = serde_json::from_str::<IgnoredAny>(text).err()?;
    let (line, column) = (error.line(), error.column());
    // The place stands first, as in all messages.
    let told = error.to_string();
    let told = told.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&told);
    let cut = if error.is_eof() { ", as if the end of the file were missing" } else { "" };
    Some(format!("line {line}, column {column}: broken JSON: {told}{cut}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_the_flaw_is_told() {
        assert_eq!(flaw("{\"a\": [1, 2.5e3, \"b\"]}\n"), None);
        let cut = flaw("{\"a\": [1,\n 2").unwrap();
        assert!(cut.starts_with("line 2, column 2: broken JSON: EOF") && cut.ends_with("missing"), "{cut}");
        let bare = flaw("{a: 1}").unwrap();
        assert!(bare.starts_with("line 1, column 2: broken JSON: key must be a string") && !bare.contains("missing"));
        // However deep.
        assert!(flaw(&"[".repeat(100_000)).is_some());
    }
}
