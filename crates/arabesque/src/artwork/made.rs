//! What the methods have to say of what they made.

use std::fmt::Debug;

use arabesque_core::{Budget, EnergyPoint, Error, PointSet, Result, Snapshot, StopReason, TriangleMesh, Warning};

use crate::{
    artwork::{points::PlacedPoint, summary::Summary},
    recipe::{Format, OutputOptions},
};

/// What came out of a run, or is there so far.
pub(crate) trait Made: Debug + Send + Sync {
    /// Its file.
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded>;

    /// The format that a file of `format` is made from once it was edited; `None` where it can be edited itself.
    fn drawn_from(&self, _format: Format) -> Option<Format> {
        None
    }

    /// Its file, made from one of another format that was edited.
    fn encode_edited(&self, _edited: &[u8], sheet: &Sheet<'_>) -> Result<Encoded> {
        Err(Error::Unsupported {
            what: format!("an edited result as {}", sheet.format.name()),
            advice: "write the format that was edited".into(),
        })
    }

    /// Whether a draft of its file takes less time than the file itself.
    fn has_draft(&self, format: Format) -> bool {
        format == Format::Png
    }

    /// How much of what there is.
    fn summary(&self) -> Summary;

    /// The bare geometry.
    fn geometry(&self) -> Geometry;

    /// The centres of the elements.
    fn points(&self) -> Vec<PlacedPoint> {
        Vec::new()
    }

    /// What the user should know.
    fn warnings(&self) -> &[Warning];

    /// Mean energy after each iteration, where the method has one.
    fn energy(&self) -> &[EnergyPoint] {
        &[]
    }

    /// Why the run ended.
    fn stopped(&self) -> StopReason;
}

/// How something that was made is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet<'a> {
    /// The format; never [`Format::Toml`], which holds the recipe alone.
    pub(crate) format: Format,
    pub(crate) output: &'a OutputOptions,
    /// What the recipe of the run says of its output.
    pub(crate) ran: &'a OutputOptions,
    /// The recipe that the file carries.
    pub(crate) recipe: Option<&'a str>,
    pub(crate) budget: &'a Budget,
    /// Whether a picture is drawn coarsely, for somebody who waits.
    pub(crate) is_draft: bool,
}

impl Sheet<'_> {
    /// Most pixels of a picture of which a draft has so many.
    pub(crate) fn most_pixels(&self, of_draft: usize) -> usize {
        if self.is_draft { of_draft } else { usize::MAX }
    }
}

/// A file, complete.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What could not be written as asked.
    pub warnings: Vec<Warning>,
    /// A file that it names and that has to lie beside it.
    pub companion: Option<Companion>,
}

/// A file that lies beside another one and is called like it but for its ending.
#[derive(Clone, Debug)]
pub struct Companion {
    /// Its ending, without the dot.
    pub ending: &'static str,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Geometry without ink: placements, strokes and pieces of pictures, in the units of the page or of the exemplar.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// In the plane; y points down.
    Plane(Snapshot<2>),
    /// In space.
    Space(Snapshot<3>),
    /// A mesh.
    Mesh(TriangleMesh),
    /// Points with attributes in the plane.
    PlanePoints(PointSet<2>),
    /// Points with attributes in space.
    SpacePoints(PointSet<3>),
}

impl Encoded {
    /// A text without warnings.
    pub(crate) fn plain(text: String) -> Self {
        Self { bytes: text.into_bytes(), warnings: Vec::new(), companion: None }
    }
}
