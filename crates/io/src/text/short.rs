//! What a file holds, as messages show it: on one line, and not too long.

/// Characters of one thing.
const LONGEST: usize = 40;
/// Things of a list.
const NAMED: usize = 5;

/// A text on one line, cut where it is long.
pub(crate) fn short(text: &str) -> String {
    let line: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() { format!("{line}...") } else { line }
}

/// The first few things of a list, and how many there are beside them.
pub(crate) fn list<T: AsRef<str>>(things: impl IntoIterator<Item = T>) -> String {
    let mut things = things.into_iter();
    let named: Vec<String> = things.by_ref().take(NAMED).map(|thing| short(thing.as_ref())).collect();
    match things.count() {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_and_lists_are_cut() {
        assert_eq!(short("a\nb"), "a b");
        assert_eq!(short(&"x".repeat(1000)), format!("{}...", "x".repeat(40)));
        assert_eq!(list(["a", "b"]), "a, b");
        assert_eq!(list((0..100).map(|k| k.to_string())), "0, 1, 2, 3, 4 and 95 more");
        assert_eq!(list::<&str>([]), "");
    }
}
