//! The nearest known name to a mistyped one.

/// The candidate that takes the fewest typing errors to get from `name`, if it is near enough to be meant: one error for every three
/// letters. Letters are inserted, removed, replaced, or swapped with the next; their case does not matter.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = name.chars().count().div_ceil(3).max(1);
    let lower = name.to_lowercase();
    candidates
        .into_iter()
        .map(|c| (strsim::osa_distance(&lower, &c.to_lowercase()), c))
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, c)| c)
}

/// The end of a message about the unknown `name`: `; did you mean seed?`, or nothing where no candidate is near enough.
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, candidates).map(|near| format!("; did you mean {near}?")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_understood_and_strangers_are_not() {
        let names = ["seed", "size", "scale"];
        assert_eq!(nearest("sede", names), Some("seed"));
        assert_eq!(nearest("SCAEL", names), Some("scale"));
        assert_eq!(nearest("wombat", names), None);
    }

    #[test]
    fn a_hint_is_the_end_of_a_sentence_or_nothing() {
        assert_eq!(did_you_mean("sede", ["seed"]), "; did you mean seed?");
        assert_eq!(did_you_mean("wombat", ["seed"]), "");
    }
}
