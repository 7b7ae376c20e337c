//! Where a pattern ends: there nothing is missing.

use arabesque_core::{Bounds, Budget, GridIndex, Result, Vector};

/// Mean direction of what is around a place, from which on it all lies on one side of it.
const ONE_SIDED: f64 = 0.55;

/// The extent of a pattern.
#[derive(Debug)]
pub(super) struct Edge<'a, const D: usize> {
    pub(super) index: &'a GridIndex<D>,
    /// The page; none where it has no edge.
    pub(super) page: Option<Bounds<D>>,
    pub(super) radius: f64,
}

impl<const D: usize> Edge<'_, D> {
    /// Whether the pattern does not reach to `p`: beyond the page, or where all that is near lies on one side.
    pub(super) fn is_beyond(&self, p: Vector<D>, budget: &Budget) -> Result<bool> {
        let Some(page) = &self.page else { return Ok(false) };
        if !page.contains(p) {
            return Ok(true);
        }
        let (mut sum, mut count) = (Vector::ZERO, 0.0);
        let cost = self.index.within(p, self.radius, |_, offset| {
            let length = offset.norm();
            if length > 0.0 {
                sum += offset * (1.0 / length);
            }
            count += 1.0;
        });
        budget.spend(cost)?;
        Ok(count == 0.0 || sum.norm() > ONE_SIDED * count)
    }
}
