//! Structures as files.

use arabesque_core::{EnergyPoint, PointSet, Result, StopReason, Warning};
use arabesque_io::render::Item;
use arabesque_structures::StructureOutcome;

use crate::{
    artwork::{Encoded, Geometry, Made, Sheet, Summary},
    solid::write::{Said, encode_points},
};

/// Points in the plane.
#[derive(Debug)]
pub(super) struct PlanePoints(pub(super) StructureOutcome<2>);

/// Points in space.
#[derive(Debug)]
pub(super) struct SpacePoints(pub(super) StructureOutcome<3>);

/// What a run has so far.
fn so_far<const D: usize>(points: PointSet<D>) -> StructureOutcome<D> {
    let stopped = StopReason::Stopped;
    StructureOutcome {
        points,
        sources: Vec::new(),
        elements: Vec::new(),
        energy: Vec::new(),
        warnings: Vec::new(),
        stopped,
    }
}

fn counted<const D: usize>(outcome: &StructureOutcome<D>) -> Summary {
    let energy = outcome.energy.last().map(|e| e.energy);
    Summary { points: outcome.points.len(), elements: outcome.elements.len(), energy, ..Summary::default() }
}

impl PlanePoints {
    pub(super) fn unfinished(points: PointSet<2>) -> Self {
        Self(so_far(points))
    }
}

impl SpacePoints {
    pub(super) fn unfinished(points: PointSet<3>) -> Self {
        Self(so_far(points))
    }
}

/// What both have to say.
macro_rules! made {
    ($type:ident, $geometry:ident, $item:ident) => {
        impl Made for $type {
            fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
                let StructureOutcome { points, warnings, stopped, .. } = &self.0;
                encode_points(points, Item::$item(points), sheet, Said { warnings, stopped: *stopped })
            }

            fn summary(&self) -> Summary {
                counted(&self.0)
            }

            fn geometry(&self) -> Geometry {
                Geometry::$geometry(self.0.points.clone())
            }

            fn warnings(&self) -> &[Warning] {
                &self.0.warnings
            }

            fn energy(&self) -> &[EnergyPoint] {
                &self.0.energy
            }

            fn stopped(&self) -> StopReason {
                self.0.stopped
            }
        }
    };
}

made!(PlanePoints, PlanePoints, Plane);
made!(SpacePoints, SpacePoints, Points);
