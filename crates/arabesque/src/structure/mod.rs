//! Repetitive structures: points with attributes in the plane, in boxes and along curves.

mod made;
mod place;

use std::sync::Arc;

use arabesque_core::{Error, PointSet, Result, StopReason, Unobserved, Warning, Watch};
use arabesque_io::geometry::Cloud;
use arabesque_structures::{Prepared as Engine, StructureOutcome, StructureRequest};
use arabesque_surface::{SurfaceParams, reconstruct};

use crate::{
    artwork::Artwork,
    method::{Preparation, Ready, RunContext, Show},
    plane::in_exemplar,
    recipe::{Job, Structures},
    solid::read::cloud,
    surface::SurfaceMade,
};
use made::{PlanePoints, SpacePoints};
pub(crate) use place::directions;

/// A structure, analysed.
#[derive(Debug)]
pub(crate) enum Structure {
    Plane(Engine<2>, Arc<PointSet<2>>),
    Space(Engine<3>, Arc<PointSet<3>>),
}

/// Reads a structure to continue it.
pub(crate) fn prepare(job: &Structures, preparation: &mut Preparation<'_>) -> Result<Structure> {
    let params = job.engine_params()?;
    job.surface_params()?;
    job.place()?;
    let bytes = preparation.files.read(&preparation.exemplar)?;
    let (points, warnings) = cloud(preparation.exemplar.name(), &bytes, preparation.files)?;
    preparation.warnings.extend(warnings);
    preparation.exemplar = preparation.exemplar.embedding(&bytes);
    let (name, budget) = (preparation.exemplar.name(), preparation.files.budget());
    let explained = |error| in_exemplar(error, name);
    Ok(match points {
        Cloud::Plane(points) => {
            let points = Arc::new(points);
            Structure::Plane(Engine::new(Arc::clone(&points), &params, budget).map_err(explained)?, points)
        }
        Cloud::Space(points) => {
            let points = Arc::new(points);
            Structure::Space(Engine::new(Arc::clone(&points), &params, budget).map_err(explained)?, points)
        }
    })
}

/// How many directions a structure repeats along, in words.
fn along(repeats: usize) -> &'static str {
    ["nothing", "one direction", "two directions", "three directions"][repeats.min(3)]
}

impl Ready for Structure {
    fn understood(&self) -> String {
        let (count, spacing, repeats, window) = match self {
            Self::Plane(engine, points) => (points.len(), engine.spacing(), engine.repeats(), engine.window()),
            Self::Space(engine, points) => (points.len(), engine.spacing(), engine.repeats(), engine.window()),
        };
        format!(
            "exemplar: a structure of {count} points, {spacing:.4} apart, that repeats along {}; window {window:.4}",
            along(repeats)
        )
    }

    fn run(self: Arc<Self>, mut context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let Job::Structures(mut job) = context.job.clone() else {
            return Err(Error::parameter("request", context.job.name(), "a request for a structure"));
        };
        match &*self {
            Self::Plane(engine, _) => {
                let mut request = StructureRequest::new(place::in_plane(&mut job, &mut context)?);
                if let Some(input) = &mut job.keep {
                    request.kept = place::kept(input, &mut context, |points| match points {
                        Cloud::Plane(points) => Some(points),
                        Cloud::Space(_) => None,
                    })?;
                }
                (request.seed, request.budget) = (context.seed, context.budget().clone());
                if job.mesh {
                    let advice = "leave the mesh out, or give points with a z";
                    return Err(Error::Unsupported {
                        what: "the surface of points in the plane".into(),
                        advice: advice.into(),
                    });
                }
                context.job = Job::Structures(job);
                let origin = context.origin();
                let make = |points| PlanePoints::unfinished(points);
                let mut outcome = engine.run(&request, &mut Show { watch, origin: &origin, make })?;
                outcome.warnings.splice(0..0, context.warnings);
                Ok(Artwork::new(origin, PlanePoints(outcome)))
            }
            Self::Space(engine, points) => {
                let mut request = StructureRequest::new(place::in_space(&mut job, points, &mut context)?);
                if let Some(input) = &mut job.keep {
                    request.kept = place::kept(input, &mut context, |points| match points {
                        Cloud::Plane(_) => None,
                        Cloud::Space(points) => Some(points),
                    })?;
                }
                (request.seed, request.budget) = (context.seed, context.budget().clone());
                let surface = if job.mesh { Some(job.surface_params()?) } else { None };
                context.job = Job::Structures(job);
                let origin = context.origin();
                let make = |points| SpacePoints::unfinished(points);
                let mut outcome = engine.run(&request, &mut Show { watch, origin: &origin, make })?;
                outcome.warnings.splice(0..0, std::mem::take(&mut context.warnings));
                match surface {
                    None => Ok(Artwork::new(origin, SpacePoints(outcome))),
                    Some(params) => Ok(Artwork::new(Arc::clone(&origin), surfaced(outcome, &params, &context)?)),
                }
            }
        }
    }
}

/// The surface of what was made.
fn surfaced(outcome: StructureOutcome<3>, params: &SurfaceParams, context: &RunContext<'_>) -> Result<SurfaceMade> {
    let StructureOutcome { points, warnings, stopped, .. } = outcome;
    // The surface of the best so far has an account of its own, as its file has.
    let budget = if stopped == StopReason::Finished { context.budget().clone() } else { context.budget().fresh() };
    let mut found = reconstruct(&points, params, None, &budget, &mut Unobserved)?;
    let own: Vec<Warning> = std::mem::take(&mut found.warnings);
    found.warnings = warnings.into_iter().chain(own).collect();
    if found.stopped == StopReason::Finished {
        found.stopped = stopped;
    }
    Ok(SurfaceMade::new(found))
}

#[cfg(test)]
mod tests;
