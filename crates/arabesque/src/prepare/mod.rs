//! From a recipe to something that can be run as often as wanted: files are read, the exemplar is analysed.

mod exemplar;
mod fields;
mod place;
mod plane;
mod redo;
mod resources;
mod ribbon;
mod space;
mod spacing;
mod surroundings;

pub use exemplar::LoadedExemplar;
pub use resources::Resources;

pub(crate) use exemplar::points_as_drawing;
pub(crate) use place::Units;
pub(crate) use plane::{Plane, PlaneRequest};
pub(crate) use resources::Files;
pub(crate) use ribbon::{RibbonReady, Track};
pub(crate) use space::Volume;
pub(crate) use spacing::{length, spacing};

use std::sync::Arc;

use arabesque_core::{Error, Limits, Result, Warning, Watch};

use crate::{
    Artwork, Input, Job, OutputOptions, Recipe,
    artwork::Origin,
    method::{Made, Ready},
};

/// What one run is to make from what is prepared: everything but the exemplar and how it is analysed.
///
/// [`Prepared::request`] gives the one of the recipe. A request may change where the pattern goes and what is around it (size, tile,
/// domain, border, fields, kept and avoided things, curves to follow) and the seed; see [`Prepared::run`].
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The job, of the same kind as the one that was prepared.
    pub job: Job,
    /// Seed of all random choices.
    pub seed: u64,
}

impl Request {
    /// This job, with seed 0.
    pub fn new(job: impl Into<Job>) -> Self {
        Self { job: job.into(), seed: 0 }
    }

    /// The same with another seed.
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

/// A recipe whose exemplar is read and analysed. It owns all it needs, and a clone shares it: one prepared exemplar serves any number
/// of requests, from any number of threads.
#[derive(Clone, Debug)]
pub struct Prepared(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    /// The recipe, with its exemplar inside it where that is small.
    recipe: Recipe,
    files: Files,
    ready: Arc<dyn Ready>,
    /// What was noticed while reading.
    warnings: Vec<Warning>,
}

/// On the way from a recipe to something prepared.
pub(crate) struct Preparation<'a> {
    pub(crate) files: &'a Files,
    pub(crate) exemplar: Input,
    /// The job as results carry it: with small inputs inside it.
    pub(crate) job: Job,
    pub(crate) warnings: Vec<Warning>,
}

/// On the way from a request to an artwork.
pub(crate) struct Session<'a> {
    pub(crate) prepared: &'a Prepared,
    /// The job as the result carries it: with small inputs inside it.
    pub(crate) job: Job,
    pub(crate) seed: u64,
    /// What was noticed, while preparing too.
    pub(crate) warnings: Vec<Warning>,
}

impl Recipe {
    /// Reads the exemplar and analyses it for the job of this recipe.
    ///
    /// # Errors
    /// Whatever the files or the parameters are wrong with; the message names the file or the parameter.
    pub fn prepare(&self, resources: &Resources) -> Result<Prepared> {
        let files = Files::new(resources.clone());
        let mut preparation = Preparation {
            files: &files,
            exemplar: self.exemplar.clone(),
            job: self.job.clone(),
            warnings: version_warning(&self.arabesque).into_iter().collect(),
        };
        let ready = self.job.method().prepare(&mut preparation)?;
        let Preparation { exemplar, job, warnings, .. } = preparation;
        let recipe = Self { exemplar, job, ..self.clone() };
        Ok(Prepared(Arc::new(Inner { recipe, files, ready, warnings })))
    }
}

fn version_warning(theirs: &str) -> Option<Warning> {
    let ours = env!("CARGO_PKG_VERSION");
    (theirs != ours).then(|| {
        Warning::new(
            format!("the recipe was written by version {theirs}, and this is {ours}: the result may differ"),
            format!("use version {theirs} to repeat it exactly"),
        )
    })
}

impl Prepared {
    /// What the recipe itself asks for.
    pub fn request(&self) -> Request {
        Request { job: self.0.recipe.job.clone(), seed: self.0.recipe.seed }
    }

    /// Carries out a request. Any number of runs may be made from one preparation; equal requests give equal results.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a request of another kind, or one that changes the exemplar or its analysis (method, parameters, regions
    /// of the file, strips); whatever its files are wrong with; [`Error::NoResult`] when nothing can be placed, [`Error::Limit`] when a
    /// limit is reached.
    pub fn run(&self, request: &Request, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let (asked, prepared) = (request.job.method().fixed(), self.0.recipe.job.method().fixed());
        if asked != prepared {
            let expected =
                format!("a request for the {} that was prepared, with the same method and parameters", prepared.name());
            return Err(Error::parameter("request", asked.name(), expected));
        }
        let session =
            Session { prepared: self, job: request.job.clone(), seed: request.seed, warnings: self.0.warnings.clone() };
        Arc::clone(&self.0.ready).run(session, watch)
    }

    /// The recipe, with its exemplar inside it where that is small.
    pub fn recipe(&self) -> &Recipe {
        &self.0.recipe
    }

    /// What was noticed while reading.
    pub fn warnings(&self) -> &[Warning] {
        &self.0.warnings
    }

    /// What was understood of the exemplar, in words.
    pub fn understood(&self) -> String {
        self.0.ready.understood()
    }
}

impl Session<'_> {
    pub(crate) fn files(&self) -> &Files {
        &self.prepared.0.files
    }

    pub(crate) fn limits(&self) -> Limits {
        self.files().limits()
    }

    /// What the recipe says of its output; the resolution counts where areas are avoided pixel by pixel.
    pub(crate) fn output(&self) -> &OutputOptions {
        &self.prepared.0.recipe.output
    }

    /// The name of the exemplar for messages.
    pub(crate) fn exemplar_name(&self) -> &str {
        self.prepared.0.recipe.exemplar.name()
    }

    /// Where an artwork of this session comes from; the job must be resolved by then.
    pub(crate) fn origin(&self) -> Arc<Origin> {
        let recipe = Recipe { job: self.job.clone(), seed: self.seed, ..self.prepared.0.recipe.clone() };
        Arc::new(Origin { recipe, limits: self.limits() })
    }
}

/// Shows an engine's snapshots to whoever watches the run, as artworks.
pub(crate) struct Show<'a, F> {
    pub(crate) watch: &'a mut dyn Watch<Artwork>,
    pub(crate) origin: &'a Arc<Origin>,
    /// Makes something of a snapshot that can be written.
    pub(crate) make: F,
}

impl<P, M: Made + 'static, F: Fn(P) -> M> Watch<P> for Show<'_, F> {
    fn step(&mut self, progress: &arabesque_core::Progress, preview: &dyn Fn() -> P) -> std::ops::ControlFlow<()> {
        let (make, origin) = (&self.make, self.origin);
        self.watch.step(progress, &|| Artwork::new(Arc::clone(origin), make(preview())))
    }
}
