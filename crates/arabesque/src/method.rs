//! What a method has to do to be reached through the one door: [`crate::Recipe`], [`crate::Prepared`], [`crate::Artwork`].
//!
//! A kind of job implements [`Method`], what it prepares implements [`Ready`], and what comes out of a run implements [`Made`].
//! Everything else, from the bytes of files to the recipe in a result, is written once around them.

use std::{fmt::Debug, sync::Arc};

use arabesque_core::{EnergyPoint, Limits, Result, StopReason, Warning, Watch};

use crate::{
    Artwork, Encoded, Format, Geometry, Input, Job, OutputOptions, Summary,
    prepare::{Preparation, Session},
};

/// A kind of job: what is to be made, with its options.
pub(crate) trait Method: Debug {
    /// The file format where nobody says which.
    fn usual_format(&self, exemplar: &Input) -> Format;

    /// The same job without what a request may change: two jobs that are equal in this can share what is prepared.
    fn fixed(&self) -> Job;

    /// Reads the exemplar and analyses it.
    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<Arc<dyn Ready>>;
}

/// An exemplar, read and analysed, ready for any number of runs.
pub(crate) trait Ready: Debug + Send + Sync {
    /// What was understood of the exemplar, in words.
    fn understood(&self) -> String;

    /// Resolves the request of `session`, and runs it.
    fn run(self: Arc<Self>, session: Session<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork>;
}

/// What came out of a run, or is there so far.
pub(crate) trait Made: Debug + Send + Sync {
    /// Its file.
    fn encode(&self, sheet: &Sheet<'_>) -> Result<Encoded>;

    /// How much of what there is.
    fn summary(&self) -> Summary;

    /// The bare geometry.
    fn geometry(&self) -> Geometry;

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
    /// The recipe that the file carries.
    pub(crate) recipe: Option<&'a str>,
    pub(crate) limits: &'a Limits,
}
