//! Pieces that leave no clear space between them: most of the border of each runs along others.

use arabesque_core::{Bounds, Budget, DisjointSets, Outline, Result, Vector, ring, segment};

use crate::svg::shape::{
    adjacency::{Edge, meeting},
    extent::longer,
};

/// Gap that is no clear space, as a share of the size of a piece.
const GAP: f64 = 0.15;
/// Share of its border that a crowded piece has along others at least.
const SHARE: f64 = 0.5;
/// Places along a border that are looked at.
const PLACES: usize = 32;
/// Work for a place and an edge.
const EDGE: u64 = 3;

/// Groups of crowded pieces that run along one another. Each piece is given by its outlines.
///
/// # Errors
/// As [`Budget::spend`].
pub(crate) fn crowds(pieces: &[Vec<&Outline<2>>], budget: &Budget) -> Result<Vec<Vec<usize>>> {
    let extent = |piece: &Vec<&Outline<2>>| piece.iter().fold(Bounds::EMPTY, |all, o| all.union(&o.bounds()));
    let boxes: Vec<_> = pieces.iter().map(extent).collect();
    let reach: Vec<f64> = boxes.iter().map(|b| GAP * longer(b)).collect();
    let edges: Vec<Vec<Edge>> = pieces.iter().map(|piece| piece.iter().flat_map(|o| o.edges()).collect()).collect();
    let places: Vec<Vec<Vector<2>>> = pieces.iter().map(|piece| along(&outer(piece))).collect();
    let mut beside: Vec<Vec<bool>> = places.iter().map(|places| vec![false; places.len()]).collect();
    let (mut pairs, mut failed) = (Vec::new(), None);
    let mut meter = budget.meter();
    meeting(
        &boxes,
        |i| reach[i],
        budget,
        |i, j| {
            let mut meets = false;
            for (a, b) in [(i, j), (j, i)] {
                let (near, cost) = near(&places[a], &edges[b], &boxes[a], reach[a]);
                meets |= !near.is_empty();
                near.into_iter().for_each(|place| beside[a][place] = true);
                failed = failed.take().or(meter.spend(EDGE * cost).err());
            }
            pairs.extend(meets.then_some((i, j)));
            failed.is_none()
        },
    )?;
    if let Some(error) = failed {
        return Err(error);
    }
    let share = |beside: &Vec<bool>| beside.iter().filter(|b| **b).count() as f64 / beside.len().max(1) as f64;
    let is_crowded: Vec<bool> = beside.iter().map(|beside| share(beside) >= SHARE).collect();
    let mut sets = DisjointSets::new(pieces.len());
    pairs.into_iter().filter(|&(i, j)| is_crowded[i] && is_crowded[j]).for_each(|(i, j)| sets.join(i, j));
    Ok(sets.groups().into_iter().filter(|group| group.len() > 1).collect())
}

/// The edges of outlines without those of their holes.
fn outer(outlines: &[&Outline<2>]) -> Vec<Edge> {
    let rings = outlines.iter().flat_map(|outline| &outline.rings).filter(|r| ring::area(r) > 0.0);
    rings.flat_map(|r| ring::edges(r)).collect()
}

/// The places within `reach` of edges, and the pairs looked at.
fn near(places: &[Vector<2>], edges: &[Edge], extent: &Bounds<2>, reach: f64) -> (Vec<usize>, u64) {
    let around = extent.grown(reach);
    let edges: Vec<Edge> = edges.iter().filter(|e| Bounds::around([e.0, e.1]).intersects(&around)).copied().collect();
    let is_near = |p: Vector<2>| edges.iter().any(|&e| segment::distance(e, p) <= reach);
    let found = (0..places.len()).filter(|&k| is_near(places[k])).collect();
    (found, 1 + (places.len() * edges.len()) as u64)
}

/// Places at equal steps along edges.
fn along(edges: &[Edge]) -> Vec<Vector<2>> {
    let length: f64 = edges.iter().map(|e| (e.1 - e.0).norm()).sum();
    let step = length / PLACES as f64;
    let (mut places, mut ahead) = (Vec::with_capacity(PLACES), 0.5 * step);
    if !(step.is_finite() && step > 0.0) {
        return places;
    }
    for &(a, b) in edges {
        let length = (b - a).norm();
        while ahead < length && places.len() < PLACES {
            places.push(a + (b - a) * (ahead / length));
            ahead += step;
        }
        ahead -= length;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> Outline<2> {
        let corners = [(x, y), (x + 10.0, y), (x + 10.0, y + 10.0), (x, y + 10.0)];
        Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] }
    }

    fn crowd(step: f64) -> Vec<Vec<usize>> {
        let squares: Vec<_> = (0..9).map(|k| square(step * f64::from(k % 3), step * f64::from(k / 3))).collect();
        crowds(&squares.iter().map(|s| vec![s]).collect::<Vec<_>>(), &Budget::default()).unwrap()
    }

    #[test]
    fn squares_side_by_side_are_a_crowd_and_squares_apart_are_not() {
        assert_eq!(crowd(11.0), [(0..9).collect::<Vec<_>>()]);
        assert!(crowd(13.0).is_empty());
    }
}
