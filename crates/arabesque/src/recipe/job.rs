//! What is to be made of an exemplar.

use crate::{
    method::Method,
    recipe::{Fill, Redo, Ribbon, Space},
};

/// What is to be made, one variant a kind of job; each owns the options that it has.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// Fill a page, a shape or a seamless tile of the plane.
    Fill(Fill),
    /// Fill a region of the exemplar's own file again, and leave the rest of it as it is.
    Redo(Redo),
    /// Fill a box in space.
    Space(Space),
    /// Lay the pattern of a picture along curves.
    Ribbon(Ribbon),
}

impl Job {
    /// The name of the table that holds this job in a recipe.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Fill(_) => "fill",
            Self::Redo(_) => "redo",
            Self::Space(_) => "space",
            Self::Ribbon(_) => "ribbon",
        }
    }

    /// What carries the job out.
    pub(crate) fn method(&self) -> &dyn Method {
        match self {
            Self::Fill(job) => job,
            Self::Redo(job) => job,
            Self::Space(job) => job,
            Self::Ribbon(job) => job,
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

impl From<Ribbon> for Job {
    fn from(job: Ribbon) -> Self {
        Self::Ribbon(job)
    }
}
