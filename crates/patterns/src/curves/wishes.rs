//! Wishes to join two things, granted from the cheapest on.

use crate::toolbox::numbered::{Number, Numbered};

/// A wish to join `a` with `b`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wish<N> {
    pub(crate) cost: f64,
    pub(crate) a: N,
    pub(crate) b: N,
}

/// Offers the wishes to `join` in order of cost, and of numbers where costs are equal, as long as neither side has been
/// joined before. There are `count` things. Returns how many were joined.
pub(crate) fn grant<N: Number + Copy + Ord>(
    mut wishes: Vec<Wish<N>>,
    count: usize,
    mut join: impl FnMut(N, N) -> bool,
) -> usize {
    wishes.sort_by(|x, y| x.cost.total_cmp(&y.cost).then((x.a, x.b).cmp(&(y.a, y.b))));
    let mut is_taken = Numbered::filled(false, count);
    let mut joined = 0;
    for Wish { a, b, .. } in wishes {
        if !is_taken[a] && !is_taken[b] && join(a, b) {
            (is_taken[a], is_taken[b]) = (true, true);
            joined += 1;
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_wish_comes_first_and_nothing_is_joined_twice() {
        let wish = |cost, a, b| Wish { cost, a, b };
        let mut found = Vec::new();
        let joined = grant(vec![wish(3.0, 0_u32, 1), wish(1.0, 1, 2), wish(4.0, 0, 3)], 4, |a, b| {
            found.push((a, b));
            true
        });
        assert_eq!((joined, found), (2, vec![(1, 2), (0, 3)]));
    }

    #[test]
    fn who_is_refused_stays_free() {
        let wishes = [(1.0, 0, 1), (2.0, 1, 2)].map(|(cost, a, b)| Wish { cost, a, b });
        assert_eq!(grant(wishes.to_vec(), 3, |a: usize, _| a == 1), 1);
    }
}
