//! The numbers of the elements of a file whose places in it do not say them any more: `0-4,6-20`.

use std::fmt::Write as _;

/// Numbers as runs; `None` where each is its place in the list.
pub(crate) fn runs(ids: &[usize]) -> Option<String> {
    if ids.iter().enumerate().all(|(place, id)| place == *id) {
        return None;
    }
    let mut text = String::new();
    let mut from = 0;
    while from < ids.len() {
        let mut to = from;
        while ids.get(to + 1) == Some(&(ids[to] + 1)) {
            to += 1;
        }
        let comma = if from == 0 { "" } else { "," };
        let _ = match to - from {
            0 => write!(text, "{comma}{}", ids[from]),
            _ => write!(text, "{comma}{}-{}", ids[from], ids[to]),
        };
        from = to + 1;
    }
    Some(text)
}

/// The numbers of `count` elements that the text says, each once; `None` where it says anything else.
pub(crate) fn numbers(text: &str, count: usize) -> Option<Vec<usize>> {
    let mut ids = Vec::new();
    for run in text.split(',').filter(|run| !run.is_empty()) {
        let (first, last) = run.split_once('-').unwrap_or((run, run));
        let (first, last): (usize, usize) = (first.parse().ok()?, last.parse().ok()?);
        if last < first || last - first >= count - ids.len().min(count) {
            return None;
        }
        ids.extend(first..=last);
    }
    let mut sorted = ids.clone();
    sorted.sort_unstable();
    sorted.dedup();
    (ids.len() == count && sorted.len() == count).then_some(ids)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_come_back() {
        assert_eq!(runs(&[0, 1, 2]), None);
        for ids in [vec![0, 1, 2, 3, 5, 6, 9], vec![3], vec![4, 2, 0, 1]] {
            let text = runs(&ids).unwrap();
            assert_eq!(numbers(&text, ids.len()), Some(ids), "{text}");
        }
        assert_eq!(runs(&[0, 1, 2, 4, 6, 7]).as_deref(), Some("0-2,4,6-7"));
    }

    #[test]
    fn hostile_runs_are_refused() {
        for text in ["0-99999999999999", "3-1", "a", "0,0", "-1", "0-1", "18446744073709551615", ""] {
            assert_eq!(numbers(text, 3), None, "{text}");
        }
    }
}
