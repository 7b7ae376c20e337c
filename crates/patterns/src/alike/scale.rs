//! How far apart the elements of a pattern are.

use arabesque_core::{Budget, GridIndex, Result, Vector};

/// How many neighbours are counted.
const NEIGHBOURS: usize = 8;
/// How far a neighbourhood reaches, in distances of the last of them: between two rings of neighbours of the common lattices.
const REACH: f64 = 1.3;
/// Most places that are looked at.
const LOOKED: usize = 400;

/// Distances of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Mean spacing of elements.
    pub(super) spacing: f64,
    /// Radius of neighbourhoods.
    pub(super) radius: f64,
}

/// The scale of `points`: by the median distance of the eighth neighbour, which is the diagonal of a square grid. `guess` is about the
/// spacing.
pub(super) fn scale<const D: usize>(
    points: &[Vector<D>],
    index: &GridIndex<D>,
    guess: f64,
    budget: &Budget,
) -> Result<Scale> {
    let stride = points.len().div_ceil(LOOKED).max(1);
    let count = NEIGHBOURS.min(points.len().saturating_sub(1)).max(1);
    let mut found = Vec::new();
    for &p in points.iter().step_by(stride) {
        let mut radius = 2.0 * guess;
        let mut near = Vec::new();
        // As often as the guess may be doubled until it is the size of anything.
        for _ in 0..64 {
            near.clear();
            budget.spend(index.within(p, radius, |_, offset| near.push(offset.norm())))?;
            if near.len() > count {
                break;
            }
            radius *= 2.0;
        }
        near.sort_by(f64::total_cmp);
        found.extend(near.get(count.min(near.len().saturating_sub(1))).copied());
    }
    found.sort_by(f64::total_cmp);
    let median = found.get(found.len() / 2).copied().filter(|d| *d > 0.0).unwrap_or(guess);
    Ok(Scale { spacing: median / std::f64::consts::SQRT_2, radius: REACH * median })
}
