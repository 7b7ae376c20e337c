//! What a method has to do to be reached through the one door: [`crate::Recipe`], [`crate::Prepared`], [`crate::Artwork`].
//!
//! Its part of [`crate::Recipe::prepare`] turns a [`Preparation`] into something [`Ready`], which turns a [`RunContext`] into an
//! [`Artwork`] around what it [`Made`]. Everything else, from the bytes of files to the recipe in a result, is written once around them.

use std::{fmt::Debug, ops::ControlFlow, sync::Arc};

use arabesque_core::{Budget, Forecast, Progress, Result, Warning, Watch};

use crate::{
    artwork::{Artwork, Made, Origin},
    recipe::{Input, Job, OutputOptions, Recipe},
    resources::Files,
};

/// On the way from a recipe to something prepared.
pub(crate) struct Preparation<'a> {
    pub(crate) files: &'a Files,
    pub(crate) exemplar: Input,
    /// The job as results carry it: with small inputs inside it.
    pub(crate) job: Job,
    pub(crate) warnings: Vec<Warning>,
}

/// On the way from a request to an artwork.
pub(crate) struct RunContext<'a> {
    pub(crate) files: &'a Files,
    /// The recipe that was prepared.
    pub(crate) recipe: &'a Recipe,
    /// The job as the result carries it: with small inputs inside it.
    pub(crate) job: Job,
    pub(crate) seed: u64,
    /// What was noticed, while preparing too.
    pub(crate) warnings: Vec<Warning>,
}

/// An exemplar, read and analysed, ready for any number of runs.
pub(crate) trait Ready: Debug + Send + Sync {
    /// What was understood of the exemplar, in words.
    fn understood(&self) -> String;

    /// Resolves the request of `context`, and runs it.
    fn run(self: Arc<Self>, context: RunContext<'_>, watch: &mut dyn Watch<Artwork>) -> Result<Artwork>;
}

impl RunContext<'_> {
    pub(crate) fn budget(&self) -> &Budget {
        self.files.budget()
    }

    /// What the recipe says of its output; the resolution counts where areas are avoided pixel by pixel.
    pub(crate) fn output(&self) -> &OutputOptions {
        &self.recipe.output
    }

    /// The name of the exemplar for messages.
    pub(crate) fn exemplar_name(&self) -> &str {
        self.recipe.exemplar.name()
    }

    /// Where an artwork of this context comes from; the job must be resolved by then.
    pub(crate) fn origin(&self) -> Arc<Origin> {
        let recipe = Recipe { job: self.job.clone(), seed: self.seed, ..self.recipe.clone() };
        Arc::new(Origin { recipe, budget: self.budget().clone() })
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
    fn foreseen(&mut self, forecast: &Forecast) {
        self.watch.foreseen(forecast);
    }

    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> P) -> ControlFlow<()> {
        let (make, origin) = (&self.make, self.origin);
        self.watch.step(progress, &|| Artwork::new(Arc::clone(origin), make(preview())))
    }
}
