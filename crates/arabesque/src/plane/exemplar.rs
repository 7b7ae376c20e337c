//! An exemplar of the plane, as it was read.

use std::sync::Arc;

use arabesque_core::Exemplar;
use arabesque_io::svg::{Drawing, HostDocument};

use crate::plane::place::{Place, Units};

/// An exemplar of the plane.
#[derive(Debug)]
pub(crate) struct PlaneExemplar {
    /// The exemplar as it is drawn.
    pub(crate) drawing: Drawing,
    /// What the engine is given, where that is not the exemplar of the drawing: a file of points.
    pub(crate) points: Option<Arc<Exemplar<2>>>,
    /// The region of the exemplar's own file that is filled again, and the rest of it, which stays.
    pub(crate) region: Option<RegionOfFile>,
}

/// A region of the exemplar's own file.
#[derive(Debug)]
pub(crate) struct RegionOfFile {
    /// How messages call it.
    pub(crate) name: String,
    pub(crate) place: Place,
    /// Everything that stays.
    pub(crate) rest: HostDocument,
}

impl PlaneExemplar {
    /// Whether it has a unit of length.
    pub(crate) fn units(&self) -> Units {
        if self.points.is_some() { Units::None } else { Units::OfPage }
    }

    /// What the engine is given.
    pub(crate) fn exemplar(&self) -> &Arc<Exemplar<2>> {
        self.points.as_ref().unwrap_or(&self.drawing.exemplar)
    }
}
