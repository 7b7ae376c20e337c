//! Reliefs as files.

use arabesque_core::{Error, PointSet, Result, StopReason, Warning};
use arabesque_io::render::Item;
use arabesque_reliefs::{ReliefOutcome, Statistics};
use arabesque_surface::Reconstruction;

use crate::{
    artwork::{Encoded, Geometry, Made, ReliefSummary, Sheet, Summary},
    recipe::Format,
    relief::heights::{Grid, encode},
    solid::write::{Said, encode_mesh, encode_points},
};

/// A relief as points.
#[derive(Debug)]
pub(super) struct ReliefMade {
    outcome: ReliefOutcome,
    /// How a PNG is a height field, if it is one.
    grid: Option<Grid>,
}

/// A relief as a mesh.
#[derive(Debug)]
pub(super) struct ReliefMesh {
    found: Reconstruction,
    statistics: Statistics,
}

fn summary(statistics: &Statistics) -> ReliefSummary {
    ReliefSummary {
        patches: statistics.patches,
        folds: statistics.folds,
        passed: statistics.passed,
        unbent: statistics.unbent,
        overlapped: statistics.overlapped,
        by_ray: statistics.by_ray,
        by_projection: statistics.by_projection,
        seams: statistics.seams,
        cracks: statistics.cracks,
        merged: statistics.merged,
    }
}

impl ReliefMade {
    pub(super) fn new(outcome: ReliefOutcome, grid: Option<Grid>) -> Self {
        Self { outcome, grid }
    }

    /// What a run has so far.
    pub(super) fn unfinished(points: PointSet<3>, grid: Option<Grid>) -> Self {
        let outcome = ReliefOutcome {
            points,
            sources: Vec::new(),
            statistics: Statistics::default(),
            warnings: Vec::new(),
            stopped: StopReason::Stopped,
        };
        Self { outcome, grid }
    }
}

impl Made for ReliefMade {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let ReliefOutcome { points, warnings, stopped, .. } = &self.outcome;
        if let (Some(grid), Format::Png) = (&self.grid, sheet.format) {
            if sheet.output.view.is_some() {
                let what = "a view of a height field".into();
                return Err(Error::Unsupported { what, advice: "leave the view or the height field out".into() });
            }
            let bytes = encode(points, grid, sheet.recipe, sheet.budget)?;
            return Ok(Encoded { bytes, warnings: Vec::new(), companion: None });
        }
        encode_points(points, Item::Points(points), sheet, Said { warnings, stopped: *stopped })
    }

    fn has_draft(&self, format: Format) -> bool {
        // The pixels of a height field are what was made.
        format == Format::Png && self.grid.is_none()
    }

    fn summary(&self) -> Summary {
        let reliefs = Some(summary(&self.outcome.statistics));
        Summary { points: self.outcome.points.len(), reliefs, ..Summary::default() }
    }

    fn geometry(&self) -> Geometry {
        Geometry::SpacePoints(self.outcome.points.clone())
    }

    fn warnings(&self) -> &[Warning] {
        &self.outcome.warnings
    }

    fn stopped(&self) -> StopReason {
        self.outcome.stopped
    }
}

impl ReliefMesh {
    pub(super) fn new(found: Reconstruction, statistics: Statistics) -> Self {
        Self { found, statistics }
    }
}

impl Made for ReliefMesh {
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let Reconstruction { mesh, warnings, stopped } = &self.found;
        encode_mesh(mesh, sheet, Said { warnings, stopped: *stopped })
    }

    fn summary(&self) -> Summary {
        let reliefs = Some(summary(&self.statistics));
        Summary { triangles: self.found.mesh.triangles.len(), reliefs, ..Summary::default() }
    }

    fn geometry(&self) -> Geometry {
        Geometry::Mesh(self.found.mesh.clone())
    }

    fn warnings(&self) -> &[Warning] {
        &self.found.warnings
    }

    fn stopped(&self) -> StopReason {
        self.found.stopped
    }
}
