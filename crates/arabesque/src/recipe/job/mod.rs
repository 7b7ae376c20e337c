//! What is to be made of an exemplar.

mod convention;
mod deform;
mod fill;
mod inputs;
mod parameters;
mod physics;
mod redo;
mod relief;
mod ribbon;
mod space;
mod structures;
mod surface;

pub use convention::{Unit, Up};
pub use deform::Deform;
pub use fill::{ExemplarTile, Fill, Method, Reading};
pub use parameters::Parameters;
pub use physics::Physics;
pub use redo::Redo;
pub use relief::Relief;
pub use ribbon::{Ribbon, WidthSource, ribbon_options};
pub use space::{Constraint, Space};
pub use structures::{Direction, Structures};
pub use surface::Surface;

pub(super) use parameters::plain_values;

use arabesque_core::{Error, Result};

use crate::recipe::{format::Format, input::Input};

/// What is to be made, one variant a kind of job; each owns the options that it has.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there are few jobs at a time, and they are seldom moved")]
pub enum Job {
    /// Fill a page, a shape or a seamless tile of the plane.
    Fill(Fill),
    /// Fill a region of the exemplar's own file again, and leave the rest of it as it is.
    Redo(Redo),
    /// Fill a box in space.
    Space(Space),
    /// Lay the pattern of a picture along curves.
    Ribbon(Ribbon),
    /// Make a surface of points.
    Surface(Surface),
    /// Continue a repetitive structure that is given as points.
    Structures(Box<Structures>),
    /// Continue a relief.
    Relief(Box<Relief>),
}

impl Job {
    /// The name of the table that holds this job in a recipe.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Fill(_) => "fill",
            Self::Redo(_) => "redo",
            Self::Space(_) => "space",
            Self::Ribbon(_) => "ribbon",
            Self::Surface(_) => "surface",
            Self::Structures(_) => "structures",
            Self::Relief(_) => "relief",
        }
    }

    /// The file format where nobody says which: SVG for the plane, OBJ for curves and CSV for points in space, PNG for ribbons, GLB
    /// for ribbons in space, PLY for surfaces, reliefs and structures, CSV for structures from a table.
    pub(crate) fn usual_format(&self, exemplar: &Input) -> Format {
        let is = |input: &Input, format| Format::of_path(&input.path).ok().flatten() == Some(format);
        match self {
            Self::Fill(_) | Self::Redo(_) => Format::Svg,
            Self::Space(_) if is(exemplar, Format::Csv) => Format::Csv,
            Self::Space(_) if is(exemplar, Format::Glb) || is(exemplar, Format::Gltf) => Format::Glb,
            Self::Space(_) => Format::Obj,
            Self::Ribbon(ribbon) if is(&ribbon.along, Format::Obj) => Format::Glb,
            Self::Ribbon(_) => Format::Png,
            Self::Structures(_) if is(exemplar, Format::Csv) => Format::Csv,
            Self::Surface(_) | Self::Structures(_) | Self::Relief(_) => Format::Ply,
        }
    }

    /// Refuses a file format that never holds what this job makes, whatever is read.
    pub(crate) fn check_format(&self, format: Format) -> Result<()> {
        let (what, advice) = match self {
            Self::Surface(_) => ("a surface", "write ply, obj, glb, json or png"),
            Self::Structures(_) | Self::Relief(_) => {
                ("points with attributes", "write ply, csv, obj, glb, json or png")
            }
            _ => return Ok(()),
        };
        if format != Format::Svg {
            return Ok(());
        }
        Err(Error::Unsupported { what: format!("{what} as {}", format.name()), advice: advice.into() })
    }

    /// The same job with the inputs of `prepared` that were put inside that when it was prepared.
    pub(crate) fn with_inputs_of(&self, prepared: &Self) -> Self {
        let mut job = self.clone();
        match (&mut job, prepared) {
            (Self::Redo(job), Self::Redo(prepared)) => {
                job.region.clone_from(&prepared.region);
                job.from.clone_from(&prepared.from);
            }
            (Self::Ribbon(job), Self::Ribbon(prepared)) => job.then.clone_from(&prepared.then),
            _ => {}
        }
        job
    }

    /// The same job without what a request may change: jobs that are equal in this can share what is prepared.
    pub(crate) fn prepared_part(&self) -> Self {
        match self {
            Self::Fill(job) => Self::Fill(job.prepared_part()),
            Self::Redo(job) => Self::Redo(job.prepared_part()),
            Self::Space(job) => Self::Space(job.prepared_part()),
            Self::Ribbon(job) => Self::Ribbon(job.prepared_part()),
            Self::Surface(job) => Self::Surface(job.prepared_part()),
            Self::Structures(job) => Self::Structures(Box::new(job.prepared_part())),
            Self::Relief(job) => Self::Relief(Box::new(job.prepared_part())),
        }
    }
}

impl From<Fill> for Job {
    fn from(job: Fill) -> Self {
        Self::Fill(job)
    }
}

impl From<Redo> for Job {
    fn from(job: Redo) -> Self {
        Self::Redo(job)
    }
}

impl From<Space> for Job {
    fn from(job: Space) -> Self {
        Self::Space(job)
    }
}

impl From<Structures> for Job {
    fn from(job: Structures) -> Self {
        Self::Structures(Box::new(job))
    }
}

impl From<Relief> for Job {
    fn from(job: Relief) -> Self {
        Self::Relief(Box::new(job))
    }
}

impl From<Surface> for Job {
    fn from(job: Surface) -> Self {
        Self::Surface(job)
    }
}

impl From<Ribbon> for Job {
    fn from(job: Ribbon) -> Self {
        Self::Ribbon(job)
    }
}
