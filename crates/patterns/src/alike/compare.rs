//! The distance of two neighbourhoods.

use arabesque_core::Vector;

/// A neighbour: where it is from the centre, in the frame of that, and its class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neighbour<const D: usize> {
    pub(super) offset: Vector<D>,
    pub(super) class: usize,
}

/// What is left of two neighbourhoods when they are matched.
#[derive(Clone, Debug, Default)]
pub(super) struct Rest<const D: usize> {
    /// Sum of the squared distances of matched neighbours.
    pub(super) squares: f64,
    /// How many neighbours of either were matched; a pair whose neighbours are both within the radius counts as two.
    pub(super) matched: usize,
    /// What only the first has, and what only the second has.
    pub(super) only: [Vec<Vector<D>>; 2],
}

/// Matches neighbours of the same class, nearest first, which are closer than `most`. Those within `radius` count; the ones beyond, in
/// the lists as well, may be what one within is matched with.
pub(super) fn compare<const D: usize>(lists: [&[Neighbour<D>]; 2], radius: f64, most: f64) -> Rest<D> {
    let [a, b] = lists;
    let mut pairs = Vec::new();
    for (i, p) in a.iter().enumerate() {
        for (j, q) in b.iter().enumerate().filter(|(_, q)| q.class == p.class) {
            let square = (p.offset - q.offset).norm2();
            if square < most * most {
                pairs.push((square, i, j));
            }
        }
    }
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)).then(x.2.cmp(&y.2)));
    let mut free = [vec![true; a.len()], vec![true; b.len()]];
    let within = |p: &Neighbour<D>| p.offset.norm() <= radius;
    let mut rest = Rest::default();
    for (square, i, j) in pairs {
        if free[0][i] && free[1][j] {
            (free[0][i], free[1][j]) = (false, false);
            let count = usize::from(within(&a[i])) + usize::from(within(&b[j]));
            rest.squares += square * count as f64;
            rest.matched += count;
        }
    }
    for (side, list) in lists.into_iter().enumerate() {
        let left = list.iter().zip(&free[side]).filter(|(p, free)| **free && within(p));
        rest.only[side].extend(left.map(|(p, _)| p.offset));
    }
    rest
}
