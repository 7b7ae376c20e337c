//! Surfaces as files.

use arabesque_core::{Result, StopReason, TriangleMesh, Warning};
use arabesque_surface::Reconstruction;

use crate::{
    artwork::{Encoded, Geometry, Made, Sheet, Summary},
    solid::write::{Said, encode_mesh},
};

/// The surface of points, or what there is of it so far.
#[derive(Debug)]
pub(crate) struct SurfaceMade(Reconstruction);

impl SurfaceMade {
    pub(crate) fn new(found: Reconstruction) -> Self {
        Self(found)
    }

    /// What a run has so far.
    pub(crate) fn unfinished(mesh: TriangleMesh) -> Self {
        Self(Reconstruction { mesh, warnings: Vec::new(), stopped: StopReason::Stopped })
    }
}

impl Made for SurfaceMade {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let Reconstruction { mesh, warnings, stopped } = &self.0;
        encode_mesh(mesh, sheet, Said { warnings, stopped: *stopped })
    }

    fn summary(&self) -> Summary {
        Summary { triangles: self.0.mesh.triangles.len(), ..Summary::default() }
    }

    fn geometry(&self) -> Geometry {
        Geometry::Mesh(self.0.mesh.clone())
    }

    fn warnings(&self) -> &[Warning] {
        &self.0.warnings
    }

    fn stopped(&self) -> StopReason {
        self.0.stopped
    }
}
