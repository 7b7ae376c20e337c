//! Surfaces with a right and a wrong side.

use arabesque_core::{Error, Result, TriangleMesh};
use rapier3d::{
    math::{Pose, Vector as Vec3},
    parry::{
        query::PointQuery,
        shape::{SharedShape, TriMesh, TriMeshFlags},
    },
};

use crate::{
    shape::mesh_volume,
    surroundings::{Side, Surface},
    units::Units,
};

/// A surface as the solver sees it.
pub(crate) struct Guard {
    pub(crate) shape: SharedShape,
    /// The same, which tells on which side a place is: that of the elements is outside of it.
    sides: Option<TriMesh>,
}

impl Guard {
    /// The `number`-th surface.
    ///
    /// # Errors
    /// [`Error::Input`] where the solver cannot use it, and for a container that is not closed.
    pub(crate) fn new(number: usize, surface: &Surface, units: &Units) -> Result<Self> {
        let name = format!("surface {number}");
        let mesh: &TriangleMesh = &surface.mesh;
        let points: Vec<_> = mesh.positions.iter().map(|&p| units.place(p)).collect();
        let refused = |e| {
            let problem = format!("the solver cannot use it: {e:?}");
            Error::input(name.clone(), problem, "mend it in the program it came from")
        };
        let volume = mesh_volume(&points, &mesh.triangles);
        if surface.side == Side::Inside && volume.is_none() {
            return Err(Error::input(name, "a container with holes", "close it, or make it an obstacle"));
        }
        if surface.side == Side::Either {
            let flags = TriMeshFlags::FIX_INTERNAL_EDGES_TWO_SIDED;
            let mesh = TriMesh::with_flags(points, mesh.triangles.clone(), flags).map_err(refused)?;
            return Ok(Self { shape: SharedShape::new(mesh), sides: None });
        }
        // Inside out where the elements are inside, and where a closed mesh was so already.
        let is_turned = volume.is_some_and(|v| v < 0.0) != (surface.side == Side::Inside);
        let turned = |&[a, b, c]: &[u32; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
        let triangles = mesh.triangles.iter().map(turned).collect();
        let sides = TriMesh::with_flags(points, triangles, TriMeshFlags::ORIENTED | TriMeshFlags::FIX_INTERNAL_EDGES)
            .map_err(refused)?;
        Ok(Self { shape: SharedShape::new(sides.clone()), sides: Some(sides) })
    }

    /// For a place on the wrong side, the nearest one that is `room` beyond the surface.
    pub(crate) fn back(&self, place: Vec3, room: f32) -> Option<Vec3> {
        let found = self.sides.as_ref()?.project_point(&Pose::IDENTITY, place, false);
        if !found.is_inside {
            return None;
        }
        let way = (found.point - place).try_normalize()?;
        Some(found.point + way * room)
    }
}
