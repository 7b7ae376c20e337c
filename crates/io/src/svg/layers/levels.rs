//! Strokes of one look that lie partly below and partly above others: in how many levels they are painted.
//!
//! A plaid has all its lines along one axis below all those along the other, in the same colours. With a layer for each look it would be
//! another cloth.

use std::collections::{BTreeMap, BTreeSet};

use crate::svg::layers::{
    covering::{Counts, by_kind},
    order::turns,
};

/// Most levels of one look: with more of them, things lie on one another in rows, or as they come.
const MOST: usize = 4;

/// What lies on what, and how it looks.
#[derive(Debug)]
pub(crate) struct Meetings<'a> {
    /// By the numbers of things, in drawing order.
    pub(crate) counts: &'a Counts,
    /// Of each thing, what number its look has.
    pub(crate) looks: &'a [usize],
    /// Whether it is strokes.
    pub(crate) is_line: &'a [bool],
}

/// For each thing its level, from bottom to top: 0 for all that need none.
pub(crate) fn levels(meetings: &Meetings<'_>) -> Vec<usize> {
    let Meetings { counts, looks, is_line } = *meetings;
    let none = vec![0; looks.len()];
    let kinds: Vec<Vec<usize>> = looks.iter().map(|&look| vec![look]).collect();
    let lines: BTreeSet<usize> = looks.iter().zip(is_line).filter(|(_, is)| **is).map(|(look, _)| *look).collect();
    let in_turn: BTreeSet<usize> = turns(&by_kind(counts, &kinds), |kind| lines.contains(&kind))
        .into_iter()
        .flat_map(|(a, b, _)| [a, b])
        .filter(|look| lines.contains(look))
        .collect();
    if in_turn.is_empty() {
        return none;
    }
    // What lies lower comes first in the file, so that each is known when something lies on it.
    let mut level = none.clone();
    let mut below: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    counts.keys().filter(|(low, high)| is_line[*low] && is_line[*high]).for_each(|&(low, high)| {
        below.entry(high).or_default().push(low);
    });
    for (high, lows) in below {
        level[high] = lows.iter().map(|&low| level[low] + 1).max().unwrap_or(0);
    }
    let mut of_look: BTreeMap<usize, BTreeMap<usize, usize>> = BTreeMap::new();
    for (k, look) in looks.iter().enumerate().filter(|(k, look)| is_line[*k] && in_turn.contains(look)) {
        *of_look.entry(*look).or_default().entry(level[k]).or_default() += 1;
    }
    let is_few = |levels: &BTreeMap<usize, usize>| levels.len() <= MOST && levels.values().all(|&n| n > 1);
    if !of_look.values().all(is_few) {
        return none;
    }
    let in_levels = |k: usize| is_line[k] && in_turn.contains(&looks[k]);
    // Of what meets nothing, as at the side of a page, the level is not to be told.
    let met: BTreeSet<usize> =
        counts.keys().filter(|(a, b)| in_levels(*a) && in_levels(*b)).flat_map(|(a, b)| [*a, *b]).collect();
    if (0..looks.len()).any(|k| in_levels(k) && !met.contains(&k)) {
        return none;
    }
    (0..looks.len()).map(|k| if in_levels(k) { level[k] } else { 0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of looks 0 and 1, each given as its look and which earlier ones it lies on.
    fn of(lines: &[(usize, &[usize])]) -> Vec<usize> {
        let counts: Counts =
            lines.iter().enumerate().flat_map(|(k, (_, on))| on.iter().map(move |&low| ((low, k), 10))).collect();
        let looks: Vec<usize> = lines.iter().map(|(look, _)| *look).collect();
        levels(&Meetings { counts: &counts, looks: &looks, is_line: &vec![true; lines.len()] })
    }

    #[test]
    fn a_plaid_has_two_levels_of_each_look() {
        let under = [(0, &[][..]), (0, &[]), (1, &[]), (1, &[])];
        let over = [(0, &[0, 1, 2, 3][..]), (0, &[0, 1, 2, 3]), (1, &[0, 1, 2, 3]), (1, &[0, 1, 2, 3])];
        assert_eq!(of(&[under, over].concat()), [0, 0, 0, 0, 1, 1, 1, 1]);
    }

    #[test]
    fn what_lies_on_the_same_looks_everywhere_needs_none() {
        assert_eq!(of(&[(0, &[]), (0, &[]), (1, &[0, 1]), (1, &[0, 1])]), [0; 4]);
    }

    #[test]
    fn where_one_meets_nothing_there_are_none() {
        let lines = [(0, &[][..]), (0, &[]), (1, &[0, 1]), (1, &[0, 1]), (0, &[2, 3]), (0, &[2, 3])];
        assert_eq!(of(&lines), [0, 0, 1, 1, 2, 2]);
        assert_eq!(of(&[&lines[..], &[(0, &[][..])]].concat()), [0; 7]);
    }

    #[test]
    fn rows_over_rows_have_none() {
        let rows: Vec<(usize, Vec<usize>)> = (0..12).map(|k| (k % 2, (0..k).collect())).collect();
        let rows: Vec<(usize, &[usize])> = rows.iter().map(|(look, on)| (*look, on.as_slice())).collect();
        assert_eq!(of(&rows), [0; 12]);
    }
}
