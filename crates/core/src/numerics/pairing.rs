//! Pairs by wishes: the cheapest first, each member in one pair at most.
//!
//! Greedy, so a pair that was made is never parted for a better whole; the order of ties is that of the members, so that
//! the result depends on nothing but the wishes.

use crate::index::{Number, Numbered};

/// A wish to pair `a` with `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish<N> {
    /// How much it costs; wishes are granted from the cheapest on.
    pub cost: f64,
    /// One member.
    pub a: N,
    /// The other member.
    pub b: N,
}

/// Grants wishes among `count` members, the cheapest first: each whose members are both free and which `accept` takes.
/// Returns the number of pairs.
pub fn pair_up<N: Number + Copy + Ord>(
    mut wishes: Vec<Wish<N>>,
    count: usize,
    mut accept: impl FnMut(N, N) -> bool,
) -> usize {
    wishes.sort_by(|x, y| x.cost.total_cmp(&y.cost).then((x.a, x.b).cmp(&(y.a, y.b))));
    let mut is_taken = Numbered::filled(false, count);
    let mut pairs = 0;
    for Wish { a, b, .. } in wishes {
        if !is_taken[a] && !is_taken[b] && accept(a, b) {
            (is_taken[a], is_taken[b]) = (true, true);
            pairs += 1;
        }
    }
    pairs
}

/// Pairs two sides, those whose `likeness` is largest first: for each of the `left` members the one of the `right` ones that it got.
pub fn pair_sides(left: usize, right: usize, likeness: impl Fn(usize, usize) -> f64) -> Vec<Option<usize>> {
    let mut wishes = Vec::with_capacity(left * right);
    for i in 0..left {
        wishes.extend((0..right).map(|j| Wish { cost: -likeness(i, j), a: i, b: left + j }));
    }
    let mut partner = vec![None; left];
    pair_up(wishes, left + right, |i, j| {
        partner[i] = Some(j - left);
        true
    });
    partner
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pairs(wishes: &[(f64, u32, u32)], count: usize, accept: impl Fn(u32, u32) -> bool) -> Vec<(u32, u32)> {
        let mut found = Vec::new();
        let made = pair_up(wishes.iter().map(|&(cost, a, b)| Wish { cost, a, b }).collect(), count, |a, b| {
            found.extend(accept(a, b).then_some((a, b)));
            accept(a, b)
        });
        assert_eq!(made, found.len());
        found
    }

    proptest! {
        #[test]
        fn no_wish_is_left_that_could_be_granted(
            wishes in prop::collection::vec((0.0..1.0_f64, 0..9_u32, 0..9_u32), 0..30), seed in 0..64_u32,
        ) {
            let accept = |a: u32, b: u32| a != b && (seed >> (a % 6)) & 1 == 0;
            let found = pairs(&wishes, 9, accept);
            let taken = |m: u32| found.iter().filter(|(a, b)| *a == m || *b == m).count();
            prop_assert!((0..9).all(|m| taken(m) <= 1));
            for &(_, a, b) in &wishes {
                prop_assert!(!accept(a, b) || taken(a) + taken(b) > 0);
            }
            let mut other = wishes.clone();
            other.reverse();
            prop_assert_eq!(pairs(&other, 9, accept), found);
        }
    }

    #[test]
    fn the_cheapest_wish_is_granted_first_and_ties_go_by_number() {
        assert_eq!(pairs(&[(2.0, 0, 1), (1.0, 1, 2), (3.0, 0, 3)], 4, |_, _| true), [(1, 2), (0, 3)]);
        assert_eq!(pairs(&[(1.0, 1, 2), (1.0, 0, 1)], 3, |_, _| true), [(0, 1)]);
    }

    #[test]
    fn sides_are_paired_by_likeness() {
        let likeness = [[0.9, 0.8], [0.95, 0.1], [0.0, 0.0]];
        assert_eq!(pair_sides(3, 2, |i, j| likeness[i][j]), [Some(1), Some(0), None]);
        assert_eq!(pair_sides(2, 0, |_, _| 1.0), [None, None]);
    }
}
