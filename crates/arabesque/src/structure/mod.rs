//! Repetitive structures: points with attributes in the plane, in boxes and along curves.

mod fields;
mod made;
mod place;
mod scene;
mod shapes;

use std::sync::Arc;

use arabesque_core::{Error, PointSet, Result, StopReason, Watch};
use arabesque_io::geometry::Cloud;
use arabesque_structures::{Prepared as Engine, Solid, StructureOutcome, StructureRequest};
use arabesque_surface::SurfaceParams;

use crate::{
    artwork::{Artwork, Origin},
    method::{Preparation, Ready, RunContext, Show},
    plane::in_exemplar,
    recipe::{Job, Structures},
    surface::{SurfaceMade, Surfaced, surfaced},
};
use made::{PlanePoints, SpacePoints};
pub(crate) use place::{directions, filled, lines, surface};
use scene::{SceneMade, beside};
use shapes::{Shapes, exemplar};

/// A structure, analysed.
#[derive(Debug)]
pub(crate) enum Structure {
    Plane(Engine<2>, Arc<PointSet<2>>),
    Space(Engine<3>, Arc<PointSet<3>>, Shapes),
}

/// Reads a structure to continue it.
pub(crate) fn prepare(job: &Structures, preparation: &mut Preparation<'_>) -> Result<Structure> {
    let params = job.engine_params()?;
    job.surface_params()?;
    job.place()?;
    let bytes = preparation.files.read(&preparation.exemplar)?;
    let (points, shapes, warnings) = exemplar(preparation.exemplar.name(), &bytes, preparation.files)?;
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
            Structure::Space(Engine::new(Arc::clone(&points), &params, budget).map_err(explained)?, points, shapes)
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
            Self::Space(engine, points, _) => (points.len(), engine.spacing(), engine.repeats(), engine.window()),
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
            Self::Space(engine, points, shapes) => {
                // Known without the mesh, which may take a while to look over.
                if job.inside.is_some() && engine.repeats() < 3 {
                    return Err(Solid::shallow());
                }
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
                let artwork = match surface {
                    _ if !shapes.is_empty() => in_places(outcome, shapes, surface.as_ref(), &context, &origin)?,
                    None => Artwork::new(origin, SpacePoints(outcome)),
                    Some(params) => {
                        let told = (std::mem::take(&mut outcome.warnings), outcome.stopped);
                        match surfaced(&outcome.points, told, &params, context.budget())? {
                            Surfaced::Mesh(found) => Artwork::new(origin, SurfaceMade::new(found)),
                            Surfaced::Left(warnings) => {
                                let stopped = StopReason::Stopped;
                                Artwork::new(origin, SpacePoints(StructureOutcome { warnings, stopped, ..outcome }))
                            }
                        }
                    }
                };
                Ok(artwork)
            }
        }
    }
}

/// What was made, with meshes for the elements that stand for them.
fn in_places(
    mut outcome: StructureOutcome<3>,
    shapes: &Shapes,
    surface: Option<&SurfaceParams>,
    context: &RunContext<'_>,
    origin: &Arc<Origin>,
) -> Result<Artwork> {
    let points = beside(&outcome, shapes);
    let mesh = match surface.filter(|_| !points.is_empty()) {
        None => None,
        Some(params) => {
            let told = (std::mem::take(&mut outcome.warnings), outcome.stopped);
            match surfaced(&points, told, params, context.budget())? {
                Surfaced::Mesh(found) => {
                    (outcome.warnings, outcome.stopped) = (found.warnings, found.stopped);
                    Some(found.mesh)
                }
                Surfaced::Left(warnings) => {
                    (outcome.warnings, outcome.stopped) = (warnings, StopReason::Stopped);
                    None
                }
            }
        }
    };
    Ok(Artwork::new(Arc::clone(origin), SceneMade::new(outcome, shapes, points, mesh.as_ref())))
}

#[cfg(test)]
mod tests;
