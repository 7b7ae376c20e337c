//! The last check of the output: no element overlaps another, or anything in the way, more than the exemplar shows, and
//! none breaks the rule of the border.
//!
//! Checked on the real outlines. What is wrong is mended with the smallest change that works: a shift, then a smaller
//! element of the same class, then removal. In space, and for points, there is nothing to check.

mod arrangement;
mod border_check;
mod edges;
mod figure;
mod limits;
mod relax;
mod repair;
mod summary;
#[cfg(test)]
mod tests;

use arabesque_core::{Domain, Exemplar, Placement, Request, Vector};

use crate::dimension::Dimension;
use arrangement::Arrangement;
pub(crate) use limits::ExemplarClearance;
use summary::Summary;

/// Measures the exemplar. `None` where overlaps have no meaning: in space, and for points.
pub(crate) fn measure<const D: usize>(exemplar: &Exemplar<D>) -> Option<ExemplarClearance>
where
    Vector<D>: Dimension<D>,
{
    Vector::plane_exemplar(exemplar).and_then(ExemplarClearance::new)
}

/// Mends overlaps and border violations in `placements`; those with a `frozen` entry stay untouched. Order is kept.
///
/// `clearance` is [`measure`]d from the exemplar of the placements.
pub(crate) fn repair<const D: usize>(
    clearance: Option<&ExemplarClearance>,
    request: &Request<D>,
    placements: &mut Vec<Placement<D>>,
) -> Summary
where
    Vector<D>: Dimension<D>,
{
    let (request, placements) = (Vector::plane_request(request), Vector::plane_placements(placements));
    match (clearance, request, placements) {
        (Some(clearance), Some(request), Some(placements)) => repair::repair(clearance, request, placements),
        _ => Summary::default(),
    }
}

/// Common area of all pairs of elements as a share of the area of all elements; 0 for points.
///
/// `placements` refer to the elements of `exemplar`; on a torus every element counts once, with the images of the
/// others.
pub fn overlap_ratio(exemplar: &Exemplar<2>, placements: &[Placement<2>], domain: &Domain<2>) -> f64 {
    let Some(clearance) = ExemplarClearance::new(exemplar) else {
        return 0.0;
    };
    let (own, bodies) = clearance.bodies(placements);
    let arrangement = Arrangement::new(domain, &clearance.figures, own, bodies);
    let common = arrangement.overlaps().iter().fold(0.0, |sum, overlap| sum + overlap.area);
    common / limits::ink(&arrangement).max(f64::MIN_POSITIVE)
}
