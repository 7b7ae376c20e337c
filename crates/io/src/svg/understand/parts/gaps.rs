//! How far things are from one another: the shortest links that connect all of them.

use arabesque_core::{Bounds, Budget, DisjointSets, Outline, Result};

use crate::svg::shape::{
    adjacency::{Edge, Sorted, edge_distance, meeting},
    extent::longer,
};

/// Work for each pair of edges.
const PAIR: u64 = 40;

/// A link between two things, by their numbers, with the gap that it spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    pub(crate) gap: f64,
    pub(crate) ends: (usize, usize),
}

/// The links that connect all things no farther apart than `most`, shortest first; what lies in another is at no distance from it.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn links(outlines: &[&Outline<2>], most: f64, budget: &Budget) -> Result<Vec<Link>> {
    let boxes: Vec<_> = outlines.iter().map(|outline| outline.bounds()).collect();
    let edges: Vec<Vec<Edge>> = outlines.iter().map(|outline| outline.edges().collect()).collect();
    let mut sets = DisjointSets::new(outlines.len());
    let mut found: Vec<Link> = Vec::new();
    let typical = boxes.iter().map(longer).sum::<f64>() / boxes.len().max(1) as f64;
    let mut reach = (0.25 * typical).min(most);
    // What is near is linked first, so that few of the many pairs that are far apart are left to look at.
    while reach > 0.0 && found.len() + 1 < outlines.len() {
        let mut pairs = Vec::new();
        let (mut looked, mut paid) = (0, Ok(()));
        meeting(
            &boxes,
            |_| 0.5 * reach,
            budget,
            |i, j| {
                if sets.of(i) != sets.of(j) {
                    let (apart, cost) = gap(&edges[i], &edges[j], reach);
                    let holds =
                        |a: usize, b: usize| outlines[b].points().next().is_some_and(|p| outlines[a].contains(p));
                    let gap = if apart > 0.0 && (holds(i, j) || holds(j, i)) { 0.0 } else { apart };
                    looked += cost;
                    paid = budget.spend(PAIR * cost);
                    let link = Link { gap, ends: (i.min(j), i.max(j)) };
                    if gap == 0.0 {
                        // Nothing is shorter: of what lies in one heap few pairs are left to look at.
                        sets.join(i, j);
                        found.push(link);
                    } else if gap <= reach {
                        pairs.push(link);
                    }
                }
                paid.is_ok() && looked < budget_of_a_round(outlines.len())
            },
        )?;
        paid?;
        pairs.sort_by(|a, b| a.gap.total_cmp(&b.gap).then(a.ends.cmp(&b.ends)));
        for link in pairs {
            if sets.of(link.ends.0) != sets.of(link.ends.1) {
                sets.join(link.ends.0, link.ends.1);
                found.push(link);
            }
        }
        if reach >= most || looked >= budget_of_a_round(outlines.len()) {
            break;
        }
        reach = (2.0 * reach).min(most);
    }
    Ok(found)
}

/// Pairs of edges that are looked at before the search ends where it is.
fn budget_of_a_round(things: usize) -> u64 {
    2_000_000 + 100_000 * things as u64
}

/// The least distance between two borders as far as it is no more than `most`, and the pairs of edges looked at.
fn gap(a: &[Edge], b: &[Edge], most: f64) -> (f64, u64) {
    let around = |edges: &[Edge]| Bounds::around(edges.iter().flat_map(|e| [e.0, e.1])).grown(most);
    let near = |edges: &[Edge], other: &Bounds<2>| -> Vec<Edge> {
        edges.iter().filter(|e| Bounds::around([e.0, e.1]).intersects(other)).copied().collect()
    };
    let (a, b) = (near(a, &around(b)), near(b, &around(a)));
    let b = Sorted::new(&b, 0.0);
    let (mut least, mut cost) = (f64::INFINITY, 1);
    for &p in &a {
        let asked = Bounds::around([p.0, p.1]).grown(most.min(least));
        for &(q, _) in b.near(&asked) {
            cost += 1;
            least = edge_distance(p, q).min(least);
            if least == 0.0 {
                return (0.0, cost);
            }
        }
    }
    (least, cost)
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;

    fn square(x: f64) -> Outline<2> {
        let corners = [(x, 0.0), (x + 2.0, 0.0), (x + 2.0, 2.0), (x, 2.0)];
        Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] }
    }

    #[test]
    fn the_shortest_links_come_first_and_no_ring_is_closed() {
        let squares = [square(0.0), square(3.0), square(9.0), square(5.5)];
        let all: Vec<_> = squares.iter().collect();
        let found = links(&all, 50.0, &Budget::default()).unwrap();
        assert_eq!(found.iter().map(|link| link.gap).collect::<Vec<_>>(), [0.5, 1.0, 1.5]);
        assert_eq!(found[0].ends, (1, 3));
        assert_eq!(links(&all, 1.2, &Budget::default()).unwrap().len(), 2);
    }

    #[test]
    fn what_lies_in_another_is_at_no_distance() {
        let large = Outline { rings: vec![square(0.0).rings[0].iter().map(|&p| p * 20.0).collect()] };
        let small = Outline { rings: vec![square(0.0).rings[0].iter().map(|&p| p + Vector::xy(15.0, 15.0)).collect()] };
        assert_eq!(links(&[&large, &small], 50.0, &Budget::default()).unwrap()[0].gap, 0.0);
    }
}
