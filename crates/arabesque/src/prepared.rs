//! From a recipe to something that can be run as often as wanted: files are read, the exemplar is analysed.

use std::sync::Arc;

use arabesque_core::{Error, Result, Warning, Watch};

use crate::{
    artwork::Artwork,
    method::{Preparation, Ready, RunContext},
    plane,
    recipe::{Job, Recipe},
    relief,
    resources::{Files, Resources},
    ribbon, space, structure, surface,
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
    /// The job as it was given, before its inputs were put inside it.
    given: Job,
    files: Files,
    ready: Arc<dyn Ready>,
    /// What was noticed while reading.
    warnings: Vec<Warning>,
}

impl Recipe {
    /// Reads the exemplar and analyses it for the job of this recipe.
    ///
    /// # Errors
    /// Whatever the files or the parameters are wrong with; the message names the file or the parameter.
    pub fn prepare(&self, resources: &Resources) -> Result<Prepared> {
        let files = Files::new(resources.clone(), self);
        let mut preparation = Preparation {
            files: &files,
            exemplar: self.exemplar.clone(),
            job: self.job.clone(),
            warnings: version_warning(&self.arabesque).into_iter().collect(),
        };
        let ready: Arc<dyn Ready> = match &self.job {
            Job::Fill(job) => Arc::new(plane::prepare(job, &mut preparation)?),
            Job::Redo(job) => Arc::new(plane::prepare_region(job, &mut preparation)?),
            Job::Space(job) => Arc::new(space::prepare(job, &mut preparation)?),
            Job::Ribbon(job) => Arc::new(ribbon::prepare(job, &mut preparation)?),
            Job::Structures(job) => Arc::new(structure::prepare(job, &mut preparation)?),
            Job::Relief(job) => Arc::new(relief::prepare(job, &mut preparation)?),
            Job::Surface(job) => Arc::new(surface::prepare(job, &mut preparation)?),
        };
        let Preparation { exemplar, job, warnings, .. } = preparation;
        let recipe = Self { exemplar, job, ..self.clone() };
        Ok(Prepared(Arc::new(Inner { recipe, given: self.job.clone(), files, ready, warnings })))
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
    /// limit is reached; for a recipe with edits [`Error::Input`] when the run made another result than the one that was edited.
    pub fn run(&self, request: &Request, watch: &mut dyn Watch<Artwork>) -> Result<Artwork> {
        let (asked, prepared) = (request.job.prepared_part(), self.0.recipe.job.prepared_part());
        if asked != prepared && asked != self.0.given.prepared_part() {
            let expected =
                format!("a request for the {} that was prepared, with the same method and parameters", prepared.name());
            return Err(Error::parameter("request", asked.name(), expected));
        }
        let files = self.0.files.again();
        let context = RunContext {
            files: &files,
            recipe: &self.0.recipe,
            job: request.job.with_inputs_of(&self.0.recipe.job),
            seed: request.seed,
            warnings: self.0.warnings.clone(),
        };
        Arc::clone(&self.0.ready).run(context, watch)?.with_edits()
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
