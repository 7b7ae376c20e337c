//! Results, whatever the method that made them.

mod made;
mod points;
mod summary;

pub use made::{Encoded, Geometry};
pub use points::PlacedPoint;
pub use summary::{PhysicsSummary, ReliefSummary, RibbonSummary, Summary};

pub(crate) use made::{Made, Sheet};
pub(crate) use points::points;

use std::sync::Arc;

use arabesque_core::{Budget, EnergyPoint, Result, StopReason, Warning};

use crate::recipe::{Format, OutputOptions, Recipe};

/// What a run made, or has made so far: a drawing, a file, numbers, bare geometry.
///
/// It owns or shares all it needs, so that it can be kept, sent and written later, in as many formats as wanted.
#[derive(Clone, Debug)]
pub struct Artwork {
    origin: Arc<Origin>,
    made: Arc<dyn Made>,
}

/// Where an artwork comes from.
#[derive(Debug)]
pub(crate) struct Origin {
    /// The recipe of this very artwork, with small inputs inside it.
    pub(crate) recipe: Recipe,
    pub(crate) budget: Budget,
}

impl Artwork {
    pub(crate) fn new(origin: Arc<Origin>, made: impl Made + 'static) -> Self {
        Self { origin, made: Arc::new(made) }
    }

    /// Seed of the run.
    pub fn seed(&self) -> u64 {
        self.origin.recipe.seed
    }

    /// What the user should know: what was noticed while reading, preparing and running. Of a preview nothing yet; what was noticed
    /// before the run is in [`crate::Prepared::warnings`].
    pub fn warnings(&self) -> &[Warning] {
        self.made.warnings()
    }

    /// Mean energy after each iteration; empty for methods without one.
    pub fn energy(&self) -> &[EnergyPoint] {
        self.made.energy()
    }

    /// Why the run ended; of a preview, that it was stopped.
    pub fn stopped(&self) -> StopReason {
        self.made.stopped()
    }

    /// Work that the run has done, in units of about a nanosecond; see [`Budget`].
    pub fn work(&self) -> u64 {
        self.origin.budget.work()
    }

    /// How much of what there is.
    pub fn summary(&self) -> Summary {
        self.made.summary()
    }

    /// The bare geometry.
    pub fn geometry(&self) -> Geometry {
        self.made.geometry()
    }

    /// The centres of the elements with their classes, in drawing order; empty for ribbons.
    pub fn points(&self) -> Vec<PlacedPoint> {
        self.made.points()
    }

    /// The recipe that repeats this very result and writes it as `output` says.
    pub fn recipe(&self, output: &OutputOptions) -> Recipe {
        // A recipe that stands alone leaves the format open: running it makes a result, not the recipe again.
        let format = output.format.filter(|f| *f != Format::Toml);
        let output = OutputOptions { path: None, format, ..output.clone() };
        let arabesque = env!("CARGO_PKG_VERSION").to_owned();
        Recipe { arabesque, output, ..self.origin.recipe.clone() }
    }

    /// The file in the format that `output` asks for, or else in the usual one: SVG for the plane, OBJ for curves and CSV for points in
    /// space, PNG for ribbons, GLB for ribbons in space.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Unsupported`] for a format that cannot hold what was made, [`arabesque_core::Error::Limit`] for a picture
    /// with too many pixels, [`arabesque_core::Error::Input`] when markup of the exemplar cannot be taken apart.
    pub fn encode(&self, output: &OutputOptions) -> Result<Encoded> {
        let format = output.format.unwrap_or_else(|| self.origin.recipe.usual_format());
        let recipe = self.recipe(&OutputOptions { format: Some(format), ..output.clone() }).to_toml()?;
        if format == Format::Toml {
            return Ok(Encoded::plain(recipe));
        }
        let recipe = (!output.bare).then_some(recipe.as_str());
        self.made.encode(&Sheet {
            format,
            output,
            ran: &self.origin.recipe.output,
            recipe,
            budget: &self.origin.budget.fresh().stage("encoding"),
        })
    }
}
