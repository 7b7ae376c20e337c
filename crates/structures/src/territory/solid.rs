//! Inside of a closed mesh.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Domain, Error, Fields, Matrix, Result, Vector};
use arabesque_surface::{MeshIndex, inside_grid};

use super::{
    plan::{SitePlan, Territory},
    site::Site,
};

/// The inside of a closed mesh. Structures are made a little beyond it and cut at its surface.
#[derive(Clone, Debug)]
pub struct Solid {
    index: Arc<MeshIndex>,
    volume: f64,
    fields: Fields<3>,
}

impl Solid {
    /// The inside of the mesh of `index`, which encloses `volume`, with the pattern turned and scaled by `fields`; their density is not used.
    pub fn new(index: Arc<MeshIndex>, volume: f64, fields: Fields<3>) -> Self {
        Self { index, volume, fields }
    }

    /// What is told of structures that do not fill a volume.
    pub fn shallow() -> Error {
        Error::Unsupported {
            what: "a structure inside of a mesh that does not repeat along three directions".into(),
            advice: "give an exemplar that is as deep as it is wide, say repeats=3, or use --on or --along".into(),
        }
    }
}

impl Territory<3> for Solid {
    fn sites(&self, plan: &SitePlan<3>, budget: &Budget) -> Result<Vec<Site<3>>> {
        if plan.base != [true; 3] {
            return Err(Self::shallow());
        }
        let (smallest, largest) = self.fields.scale.range();
        if !(smallest > 0.0 && largest.is_finite()) {
            return Err(Error::parameter("scale", smallest, "a positive number everywhere"));
        }
        let step = plan.step * smallest;
        let places = inside_grid(&self.index, step, plan.margin * largest, budget)?;
        let site = |place: Vector<3>| {
            let scale = self.fields.scale.at(place);
            let rotation = self.fields.orientation.as_ref().map_or_else(Matrix::identity, |o| o.at(place));
            Site { place, rotation, scale, weight: (smallest / scale).powi(3) }
        };
        Ok(places.into_iter().map(site).collect())
    }

    fn contains(&self, p: Vector<3>, _: &SitePlan<3>) -> bool {
        self.index.is_inside(p)
    }

    fn surroundings(&self) -> Domain<3> {
        Domain::Box(self.index.bounds())
    }

    fn measure(&self, _: usize) -> f64 {
        self.volume
    }

    fn bounds(&self) -> Bounds<3> {
        self.index.bounds()
    }
}
