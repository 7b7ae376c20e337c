//! Surfaces of points.

mod after;
mod made;

use std::sync::Arc;

use arabesque_core::{Error, PointSet, Result, TriangleMesh, Watch};
use arabesque_surface::{SurfaceParams, reconstruct};

use crate::{
    artwork::Artwork,
    method::{Preparation, Ready, RunContext, Show},
    recipe::{Job, Surface},
    solid::read::{cloud, indexed_mesh, raised},
};

use after::SURFACE;
pub(crate) use after::{Surfaced, surfaced};
pub(crate) use made::SurfaceMade;

/// Points, read.
#[derive(Debug)]
pub(crate) struct Points {
    points: PointSet<3>,
    params: SurfaceParams,
}

/// Reads the points that become a surface.
pub(crate) fn prepare(surface: &Surface, preparation: &mut Preparation<'_>) -> Result<Points> {
    let params = surface.engine_params()?;
    let bytes = preparation.files.read(&preparation.exemplar)?;
    let (points, warnings) = cloud(preparation.exemplar.name(), &bytes, preparation.files)?;
    preparation.warnings.extend(warnings);
    preparation.exemplar = preparation.exemplar.embedding(&bytes);
    Ok(Points { points: raised(points), params })
}

impl Ready for Points {
    fn understood(&self) -> String {
        let has = [
            (self.points.normals.is_some(), "normals"),
            (self.points.radii.is_some(), "radii"),
            (self.points.colours.is_some(), "colours"),
            (self.points.groups.is_some(), "groups"),
            (self.points.elements.is_some(), "elements"),
            (self.points.classes.is_some(), "classes"),
        ];
        let names: Vec<_> = has.iter().filter(|(is_there, _)| *is_there).map(|(_, name)| *name).collect();
        let with = if names.is_empty() { String::new() } else { format!(" with {}", names.join(", ")) };
        format!("exemplar: {} points{with}", self.points.len())
    }

    fn run(self: Arc<Self>, mut context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let Job::Surface(mut surface) = context.job.clone() else {
            return Err(Error::parameter("request", context.job.name(), "a request for a surface"));
        };
        let trim = match &mut surface.trim {
            None => None,
            Some(input) => {
                let (mesh, warnings) = indexed_mesh(input, context.files)?;
                context.warnings.extend(warnings);
                Some(mesh)
            }
        };
        context.job = Job::Surface(surface);
        let origin = context.origin();
        let make = |mesh: TriangleMesh| SurfaceMade::unfinished(mesh);
        let mut show = Show { watch, origin: &origin, make };
        let mut found =
            reconstruct(&self.points, &self.params, trim.as_ref(), &context.budget().stage(SURFACE), &mut show)
                .map_err(|error| crate::plane::in_exemplar(error, context.exemplar_name()))?;
        found.warnings.splice(0..0, context.warnings);
        Ok(Artwork::new(origin, SurfaceMade::new(found)))
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Unobserved;

    use super::*;
    use crate::{Format, Input, OutputOptions, Recipe, Resources, recipe_in};

    /// A ball of points with normals, as a table.
    fn ball() -> String {
        let rows = (0..600).map(|k| {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 600.0;
            let (angle, r) = (2.4 * f64::from(k), (1.0 - z * z).sqrt());
            let (x, y) = (r * angle.cos(), r * angle.sin());
            format!("{x},{y},{z},{x},{y},{z}\n")
        });
        format!("x,y,z,nx,ny,nz\n{}", rows.collect::<String>())
    }

    fn made(job: Surface, format: Format) -> Vec<u8> {
        let recipe = Recipe::new(Input::file("ball.csv").embedding(ball().as_bytes()), job);
        let prepared = recipe.prepare(&Resources::default()).unwrap();
        let artwork = prepared.run(&prepared.request(), &mut Unobserved).unwrap();
        assert!(artwork.summary().triangles > 1000, "{:?}", artwork.summary());
        artwork.encode(&OutputOptions { format: Some(format), ..OutputOptions::default() }).unwrap().bytes
    }

    #[test]
    fn points_become_a_surface_and_the_recipe_repeats_it() {
        for format in [Format::Ply, Format::Obj, Format::Glb, Format::Json] {
            let bytes = made(Surface::default(), format);
            let name = format!("ball-out.{}", format.name());
            let again = recipe_in(&name, &bytes).unwrap();
            assert!(matches!(again.job, Job::Surface(_)), "{name}");
            let prepared = again.prepare(&Resources::default()).unwrap();
            let artwork = prepared.run(&prepared.request(), &mut Unobserved).unwrap();
            assert_eq!(artwork.encode(&again.output).unwrap().bytes, bytes, "{name}");
        }
    }

    #[test]
    fn parameters_are_checked_before_files_are_read() {
        let job = Surface { params: [("kernal".to_owned(), "2".to_owned())].into(), ..Surface::default() };
        let message = Recipe::new(Input::file("none.ply"), job).prepare(&Resources::default()).unwrap_err().to_string();
        assert!(message.contains("kernel"), "{message}");
    }
}
