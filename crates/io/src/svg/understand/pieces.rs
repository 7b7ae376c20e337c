//! Taking a filled compound path apart: an outer border with its holes is one piece.
//!
//! Subpaths whose borders meet belong together; so does a subpath that lies in the filled area of others. What lies in
//! a hole is a piece of its own, and knows the piece that it lies in.

use arabesque_core::{Bounds, Budget, DisjointSets, FillRule, Result, Ring, ring};
use kurbo::BezPath;

use crate::svg::shape::{
    adjacency::{Edge, Looks, edges_meet, meeting},
    flatten::flattened,
};

/// Pairs of edges that are looked at in one path.
const EDGE_PAIRS: u64 = 50_000_000;

/// Work for each pair of edges, and for each edge that a point is compared with.
const PAIR: u64 = 10;

/// A connected part of a compound path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Piece {
    /// Its subpaths, by index, in drawing order.
    pub(crate) subpaths: Vec<usize>,
    /// The piece in whose hole it lies.
    pub(crate) within: Option<usize>,
}

/// The pieces of a path filled under `rule`, in the order of their first subpaths; `None` when it is too tangled to
/// take apart.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn pieces(path: &BezPath, rule: FillRule, budget: &Budget) -> Result<Option<Vec<Piece>>> {
    let rings: Vec<Ring<2>> = path.subpaths().map(flattened).collect();
    let boxes: Vec<_> = rings.iter().map(|r| Bounds::around(r.iter().copied())).collect();
    let outlines: Vec<Vec<Edge>> = rings.iter().map(|r| ring::edges(r).collect()).collect();
    let mut sets = DisjointSets::new(rings.len());
    let mut looks = Looks(EDGE_PAIRS);
    let mut tangled = false;
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); rings.len()];
    meeting(
        &boxes,
        |_| 0.0,
        budget,
        |i, j| {
            match edges_meet(&outlines[i], &outlines[j], 0.0, &mut looks) {
                Some(true) => sets.join(i, j),
                Some(false) => {
                    // Borders that do not meet: one may lie inside the other as a whole.
                    for (inner, outer) in [(i, j), (j, i)] {
                        if rings[inner].first().is_some_and(|p| boxes[outer].contains(*p)) {
                            around[inner].push(outer);
                        }
                    }
                }
                None => tangled = true,
            }
            !tangled
        },
    )?;
    budget.spend(PAIR * (EDGE_PAIRS - looks.0))?;
    if tangled {
        return Ok(None);
    }
    let homes = nest(&rings, &around, rule, &mut sets, budget)?;
    Ok(Some(gather(sets, &homes)))
}

/// Joins each ring that lies in a filled area to that area. Returns for every ring in a hole the innermost ring around
/// it.
fn nest(
    rings: &[Ring<2>],
    around: &[Vec<usize>],
    rule: FillRule,
    sets: &mut DisjointSets,
    budget: &Budget,
) -> Result<Vec<Option<usize>>> {
    let mut meter = budget.meter();
    let areas: Vec<f64> = rings.iter().map(|r| ring::area(r).abs()).collect();
    let mut homes = vec![None; rings.len()];
    for (inner, points) in rings.iter().enumerate() {
        let Some(&p) = points.first() else { continue };
        meter.spend(PAIR * around[inner].iter().map(|&o| rings[o].len() as u64).sum::<u64>())?;
        let turns: Vec<(usize, i32)> =
            around[inner].iter().map(|&o| (o, ring::winding(&rings[o], p))).filter(|(_, w)| *w != 0).collect();
        let Some(&(nearest, _)) = turns.iter().min_by(|a, b| areas[a.0].total_cmp(&areas[b.0]).then(a.0.cmp(&b.0)))
        else {
            continue;
        };
        let total: i32 = turns.iter().map(|(_, w)| w).sum();
        let filled = match rule {
            FillRule::NonZero => total != 0,
            FillRule::EvenOdd => total % 2 != 0,
        };
        if filled {
            sets.join(inner, nearest);
        } else {
            homes[inner] = Some(nearest);
        }
    }
    Ok(homes)
}

fn gather(sets: DisjointSets, homes: &[Option<usize>]) -> Vec<Piece> {
    let groups = sets.groups();
    let mut piece_of = vec![0; homes.len()];
    for (k, group) in groups.iter().enumerate() {
        group.iter().for_each(|&i| piece_of[i] = k);
    }
    let within =
        |k: usize, group: &[usize]| group.iter().find_map(|&i| homes[i]).map(|o| piece_of[o]).filter(|&o| o != k);
    let pieces = groups.iter().enumerate();
    pieces.map(|(k, group)| Piece { subpaths: group.clone(), within: within(k, group) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(data: &str, rule: FillRule) -> Vec<(Vec<usize>, Option<usize>)> {
        let path = BezPath::from_svg(data).unwrap();
        pieces(&path, rule, &Budget::default()).unwrap().unwrap().into_iter().map(|p| (p.subpaths, p.within)).collect()
    }

    #[test]
    fn two_squares_are_two_pieces() {
        let data = "M0 0h4v4h-4z M6 0h4v4h-4z";
        assert_eq!(split(data, FillRule::NonZero), [(vec![0], None), (vec![1], None)]);
    }

    #[test]
    fn a_hole_stays_with_its_border_and_an_island_does_not() {
        let data = "M0 0h10v10h-10z M2 2v6h6v-6z M4 4h2v2h-2z";
        let want = [(vec![0, 1], None), (vec![2], Some(0))];
        assert_eq!(split(data, FillRule::NonZero), want);
        assert_eq!(split(data, FillRule::EvenOdd), want);
    }

    #[test]
    fn the_fill_rule_decides_what_a_hole_is() {
        let data = "M0 0h10v10h-10z M2 2h6v6h-6z M4 4h2v2h-2z";
        assert_eq!(split(data, FillRule::NonZero), [(vec![0, 1, 2], None)]);
        assert_eq!(split(data, FillRule::EvenOdd), [(vec![0, 1], None), (vec![2], Some(0))]);
    }

    #[test]
    fn crossing_borders_belong_together() {
        assert_eq!(
            split("M0 0h4v4h-4z M2 2h4v4h-4z M9 9h1v1h-1z", FillRule::NonZero),
            [(vec![0, 1], None), (vec![2], None)]
        );
    }

    #[test]
    fn a_thousand_pieces_are_quick_to_find() {
        let data: String = (0..1000).map(|k| format!("M{} {}h1v1h-1z", k % 40 * 2, k / 40 * 2)).collect();
        assert_eq!(split(&data, FillRule::NonZero).len(), 1000);
    }
}
