//! How far points are from one another, which says how large they are drawn.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Vector};

/// Points that are looked at, evenly among all of them.
const LOOKED_AT: usize = 300;
/// Neighbours of each, whose mean distance counts.
const NEIGHBOURS: usize = 6;
/// Work of putting one point into the grid.
const PER_POINT: u64 = 40;

/// The median over some points of the mean distance to their nearest neighbours; 0 for fewer than two places.
pub(super) fn spacing(points: &[Vector<3>], budget: &Budget) -> Result<f64> {
    let bounds = Bounds::around(points.iter().copied());
    let diagonal = bounds.size().norm();
    if points.len() < 2 || diagonal <= 0.0 {
        return Ok(0.0);
    }
    budget.spend(PER_POINT.saturating_mul(points.len() as u64))?;
    // As if they lay on a sheet.
    let start = diagonal / (points.len() as f64).sqrt();
    let index = GridIndex::new(points, start, &Domain::Box(bounds));
    let wanted = NEIGHBOURS.min(points.len() - 1);
    let mut means = Vec::new();
    for n in (0..points.len()).step_by(points.len().div_ceil(LOOKED_AT)) {
        let mut reach = start;
        let mut near = Vec::new();
        while near.len() <= wanted && reach < 4.0 * diagonal {
            near.clear();
            let looked = index.within(points[n], reach, |_, offset| near.push(offset.norm()));
            budget.spend(10 * looked)?;
            reach *= 1.6;
        }
        near.sort_by(f64::total_cmp);
        // The first is the point itself.
        means.push(near.iter().skip(1).take(wanted).sum::<f64>() / wanted as f64);
    }
    means.sort_by(f64::total_cmp);
    Ok(means[means.len() / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_grid_has_the_spacing_of_its_cells_and_a_little_more() {
        let points: Vec<_> = (0..900).map(|k| Vector([f64::from(k % 30), f64::from(k / 30), 0.0])).collect();
        let found = spacing(&points, &Budget::default()).unwrap();
        assert!((1.0..1.25).contains(&found), "{found}");
    }

    #[test]
    fn few_points_and_one_place_have_what_there_is() {
        let budget = Budget::default();
        assert_eq!(spacing(&[Vector::ZERO; 5], &budget).unwrap(), 0.0);
        assert_eq!(spacing(&[], &budget).unwrap(), 0.0);
        assert_eq!(spacing(&[Vector::ZERO, Vector([3.0, 4.0, 0.0])], &budget).unwrap(), 5.0);
    }
}
