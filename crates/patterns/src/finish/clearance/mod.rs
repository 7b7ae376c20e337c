//! The last check of the output: no element overlaps another, or anything in the way, more than the exemplar shows, and
//! none breaks the rule of the border.
//!
//! Checked on the real outlines. What the exemplar does, the output may do: elements of classes that touch there may
//! touch, with the slight overlaps of an unsteady hand, and those that overlap may do so as deeply. What is wrong is mended
//! with the smallest change that works: a shift, then a smaller element of the same class, then removal; what would leave a
//! wider hole than the exemplar has is undone. In space, and for points, there is nothing to check.

mod arrangement;
mod border_check;
mod edges;
mod figure;
mod holes;
mod limits;
mod relax;
mod repair;
mod summary;
#[cfg(test)]
mod tests;

use arabesque_core::{Budget, Domain, Exemplar, Placement, Request, Result, Vector};

use crate::dimension::Dimension;
pub(crate) use arrangement::{Arrangement, PlacedFigure};
pub(crate) use limits::ExemplarClearance;
use summary::Summary;

/// Measures the exemplar. `None` where overlaps have no meaning: in space, and for points.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn measure<const D: usize>(exemplar: &Exemplar<D>, budget: &Budget) -> Result<Option<ExemplarClearance>>
where
    Vector<D>: Dimension<D>,
{
    Vector::plane_exemplar(exemplar).map_or(Ok(None), |exemplar| ExemplarClearance::new(exemplar, budget))
}

/// Mends overlaps and border violations in `placements`; those with a `frozen` entry stay untouched. Order is kept.
///
/// `clearance` is [`measure`]d from the exemplar of the placements.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop; then the placements stay as they are.
pub(crate) fn repair<const D: usize>(
    clearance: Option<&ExemplarClearance>,
    request: &Request<D>,
    placements: &mut Vec<Placement<D>>,
    budget: &Budget,
) -> Result<Summary>
where
    Vector<D>: Dimension<D>,
{
    let (request, placements) = (Vector::plane_request(request), Vector::plane_placements(placements));
    match (clearance, request, placements) {
        (Some(clearance), Some(request), Some(placements)) => {
            repair::repair(clearance, request, placements, &budget.stage("mending overlaps"))
        }
        _ => Ok(Summary::default()),
    }
}

/// Common area of all pairs of elements as a share of the area of all elements; 0 for points.
///
/// `placements` refer to the elements of `exemplar`; on a torus every element counts once, with the images of the
/// others.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn overlap_ratio(
    exemplar: &Exemplar<2>,
    placements: &[Placement<2>],
    domain: &Domain<2>,
    budget: &Budget,
) -> Result<f64> {
    let Some(clearance) = ExemplarClearance::new(exemplar, budget)? else {
        return Ok(0.0);
    };
    let (own, bodies) = clearance.bodies(placements, budget)?;
    let arrangement = Arrangement::new(domain, budget.clone(), &clearance.figures, own, bodies);
    let common = arrangement.overlaps()?.iter().fold(0.0, |sum, overlap| sum + overlap.area);
    Ok(common / limits::ink(&arrangement).max(f64::MIN_POSITIVE))
}
