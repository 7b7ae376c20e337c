//! A text in which some places are replaced.

use std::ops::Range;

/// What takes which place.
#[derive(Debug, Default)]
pub(crate) struct Splices(Vec<(Range<usize>, String)>);

impl Splices {
    /// Puts `text` into a place; several at one place follow one another.
    pub(crate) fn put(&mut self, range: Range<usize>, text: impl Into<String>) {
        self.0.push((range, text.into()));
    }

    /// The text with all that was put into it. Of places that overlap the first wins.
    pub(crate) fn apply(mut self, text: &str) -> String {
        self.0.sort_by_key(|(range, _)| (range.start, range.end));
        let mut out = String::with_capacity(text.len());
        let mut at = 0;
        for (range, new) in self.0 {
            let Some(between) = text.get(at..range.start) else { continue };
            out.push_str(between);
            out.push_str(&new);
            at = range.end;
        }
        out.push_str(text.get(at..).unwrap_or_default());
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_replaced_from_front_to_back() {
        let mut splices = Splices::default();
        splices.put(4..5, "E");
        splices.put(1..3, "--");
        splices.put(5..5, "new");
        splices.put(2..4, "lost");
        assert_eq!(splices.apply("abcdef"), "a--dEnewf");
    }
}
