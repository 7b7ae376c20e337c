//! Inside of closed meshes: foams, sponges, heaps.

use std::fmt;

use arabesque_core::{Budget, Domain, Error, Matrix, Result, Vector};
use arabesque_surface::{MeshIndex, MeshReport, inside_grid};

use super::{Site, SitePlan, Territory, shell::along_curve};

/// What a closed mesh encloses, filled by a pattern that is turned and scaled the same way everywhere.
pub struct Hollow {
    mesh: MeshIndex,
    volume: f64,
    rotation: Matrix<3>,
    scale: f64,
}

impl fmt::Debug for Hollow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Hollow")
            .field("triangles", &self.mesh.triangles())
            .field("scale", &self.scale)
            .finish_non_exhaustive()
    }
}

impl Hollow {
    /// The inside of the mesh that `report` tells of.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a scale that is not positive.
    pub fn new(mesh: MeshIndex, report: &MeshReport, rotation: Matrix<3>, scale: f64) -> Result<Self> {
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Error::parameter("scale", scale, "a positive number"));
        }
        Ok(Self { mesh, volume: report.volume.abs(), rotation, scale })
    }
}

impl Territory<3> for Hollow {
    fn sites(&self, plan: &SitePlan<3>, budget: &Budget) -> Result<Vec<Site<3>>> {
        if plan.base != [true; 3] {
            let what = "a structure that does not repeat along all three directions, inside of a mesh".into();
            let advice = "set repeats=3 if it does, or use it with on, along or size";
            return Err(Error::Unsupported { what, advice: advice.into() });
        }
        let places = inside_grid(&self.mesh, plan.step * self.scale, plan.margin * self.scale, budget)?;
        let (rotation, scale) = (self.rotation, self.scale);
        let mut sites: Vec<_> = places.into_iter().map(|place| Site { place, rotation, scale, weight: 1.0 }).collect();
        let bounds = self.mesh.bounds();
        sites.sort_by_cached_key(|site| (along_curve(site.place, &bounds), site.place.0.map(f64::to_bits)));
        Ok(sites)
    }

    fn contains(&self, p: Vector<3>, _: &SitePlan<3>) -> bool {
        self.mesh.is_inside(p)
    }

    fn surroundings(&self) -> Domain<3> {
        Domain::Box(self.mesh.bounds())
    }

    fn measure(&self, _: usize) -> f64 {
        self.volume
    }
}
