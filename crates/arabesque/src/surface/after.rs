//! The surface of points that a method made just before.

use arabesque_core::{Budget, Error, PointSet, Result, StopReason, Unobserved, Warning};
use arabesque_surface::{Reconstruction, SurfaceParams, reconstruct};

/// What is being done where points become a surface.
pub(super) const SURFACE: &str = "making the surface";

/// What became of points.
#[derive(Debug)]
pub(crate) enum Surfaced {
    /// Their surface, with what was told of the points too.
    Mesh(Reconstruction),
    /// Nothing, because somebody asked to stop before: the points are what there is. What is to be told.
    Left(Vec<Warning>),
}

/// Makes the surface of points that a run ended with, of which `warnings` were told. Where the run was stopped, or is while the surface is
/// made, the points are the best so far, and no more time is taken.
///
/// # Errors
/// As [`reconstruct`], but for [`Error::Stopped`].
pub(crate) fn surfaced(
    points: &PointSet<3>,
    (warnings, stopped): (Vec<Warning>, StopReason),
    params: &SurfaceParams,
    budget: &Budget,
) -> Result<Surfaced> {
    if stopped == StopReason::Stopped {
        return Ok(left(warnings));
    }
    // The surface of what was made until the work was used up has an account of its own, as its file has.
    let budget = if stopped == StopReason::Limit { budget.fresh() } else { budget.clone() };
    let mut found = match reconstruct(points, params, None, &budget.stage(SURFACE), &mut Unobserved) {
        Err(Error::Stopped { .. }) => return Ok(left(warnings)),
        found => found?,
    };
    found.warnings.splice(0..0, warnings);
    if found.stopped == StopReason::Finished {
        found.stopped = stopped;
    }
    Ok(Surfaced::Mesh(found))
}

fn left(mut warnings: Vec<Warning>) -> Surfaced {
    warnings.push(Warning::new(
        "there was no time for the surface: the file has the points that it would have been made of",
        "give it more time, or make the surface of the points with `arabesque surface`",
    ));
    Surfaced::Left(warnings)
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Limits, Vector};

    use super::*;

    /// A sheet of points that look up.
    fn sheet() -> PointSet<3> {
        let places = (0..400).map(|k| Vector([f64::from(k % 20), f64::from(k / 20), 0.0])).collect();
        PointSet { normals: Some(vec![Vector([0.0, 0.0, 1.0]); 400]), ..PointSet::at(places) }
    }

    #[test]
    fn whoever_asks_to_stop_gets_the_points() {
        let params = SurfaceParams::default();
        let make = |stopped, budget: &Budget| surfaced(&sheet(), (Vec::new(), stopped), &params, budget).unwrap();
        let is_left = |made: &Surfaced| matches!(made, Surfaced::Left(told) if told[0].message.contains("the points"));
        assert!(matches!(make(StopReason::Finished, &Budget::default()), Surfaced::Mesh(_)));
        assert!(is_left(&make(StopReason::Stopped, &Budget::default())));
        for n in [1, 2, 5] {
            assert!(is_left(&make(StopReason::Finished, &Budget::stopping_at(Limits::default(), n))), "{n}");
        }
    }
}
