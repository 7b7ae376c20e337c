//! Results, whatever the method that made them.

pub(crate) mod draft;
mod made;
mod points;
mod summary;

pub use made::{Companion, Encoded, Geometry};
pub use points::PlacedPoint;
pub use summary::{PhysicsSummary, ReliefSummary, RibbonSummary, Summary};

pub(crate) use made::{Made, Sheet};
pub(crate) use points::points;

use std::sync::Arc;

use arabesque_core::{Budget, EnergyPoint, Result, StopReason, Warning};
use arabesque_io::mesh::gltf;

use crate::{
    edit::{Replayed, replay, to_geometry, to_points},
    recipe::{Format, OutputOptions, Recipe},
};

/// What a run made, or has made so far: a drawing, a file, numbers, bare geometry.
///
/// It owns or shares all it needs, so that it can be kept, sent and written later, in as many formats as wanted.
#[derive(Clone, Debug)]
pub struct Artwork {
    origin: Arc<Origin>,
    made: Arc<dyn Made>,
    /// What the edits of the recipe come to, where it has any and the run is over.
    edited: Option<Arc<Replayed>>,
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
        Self { origin, made: Arc::new(made), edited: None }
    }

    /// The same with the edits of its recipe.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Input`] for edits that were made to another result; those of encoding and of editing.
    pub(crate) fn with_edits(self) -> Result<Self> {
        let recipe = &self.origin.recipe;
        if recipe.edits.is_empty() {
            return Ok(self);
        }
        let budget = self.origin.budget.fresh().stage("editing");
        let output = &recipe.output;
        let encode = |format| self.made.encode(&self.sheet(format, output, None, &budget)).map(|file| file.bytes);
        let edited = Some(Arc::new(replay(recipe, encode, &budget)?));
        Ok(Self { edited, ..self })
    }

    fn sheet<'a>(
        &'a self,
        format: Format,
        output: &'a OutputOptions,
        recipe: Option<&'a str>,
        budget: &'a Budget,
    ) -> Sheet<'a> {
        Sheet { format, output, ran: &self.origin.recipe.output, recipe, budget, is_draft: false }
    }

    /// The format of its file where nobody says which.
    pub(crate) fn usual_format(&self) -> Format {
        self.origin.recipe.usual_format()
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
        let summary = self.made.summary();
        if self.edited.is_none() {
            return summary;
        }
        let points = self.points();
        let mut classes = std::collections::BTreeMap::new();
        points.iter().for_each(|point| *classes.entry(point.class.clone()).or_insert(0) += 1);
        Summary { elements: points.len(), classes, ..summary }
    }

    /// The bare geometry.
    pub fn geometry(&self) -> Geometry {
        let geometry = self.made.geometry();
        self.edited.iter().fold(geometry, |geometry, edited| to_geometry(geometry, &edited.changes))
    }

    /// The centres of the elements with their classes, in drawing order; empty for ribbons.
    pub fn points(&self) -> Vec<PlacedPoint> {
        let points = self.made.points();
        self.edited.iter().fold(points, |points, edited| to_points(points, &edited.changes))
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
    /// space, PNG for ribbons, GLB for ribbons in space. What is written under a name (`output.path`) may have a companion.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Unsupported`] for a format that cannot hold what was made, [`arabesque_core::Error::Limit`] for a picture
    /// with too many pixels, [`arabesque_core::Error::Input`] when markup of the exemplar cannot be taken apart.
    pub fn encode(&self, output: &OutputOptions) -> Result<Encoded> {
        self.encoded(output, false)
    }

    /// Whether [`Artwork::encode_draft`] takes less time than [`Artwork::encode`] where there is much to draw.
    pub fn has_draft(&self, output: &OutputOptions) -> bool {
        self.made.has_draft(output.format.unwrap_or_else(|| self.usual_format()))
    }

    /// As [`Artwork::encode`], for somebody who waits for the end: pictures, but for height fields, have at most a few hundred thousand
    /// pixels, and a warning tells so. Their recipe repeats the run with all pixels.
    ///
    /// # Errors
    /// As [`Artwork::encode`].
    pub fn encode_draft(&self, output: &OutputOptions) -> Result<Encoded> {
        self.encoded(output, true)
    }

    fn encoded(&self, output: &OutputOptions, is_draft: bool) -> Result<Encoded> {
        let format = output.format.unwrap_or_else(|| self.origin.recipe.usual_format());
        let recipe = self.recipe(&OutputOptions { format: Some(format), ..output.clone() }).to_toml()?;
        if format == Format::Toml {
            return Ok(Encoded::plain(recipe));
        }
        let recipe = (!output.bare).then_some(recipe.as_str());
        let budget = self.origin.budget.fresh().stage("encoding");
        if format == Format::Gltf {
            let glb = self.encode_as(&self.sheet(Format::Glb, output, recipe, &budget))?;
            return Ok(Encoded { bytes: gltf::as_text(&glb.bytes, &budget)?, ..glb });
        }
        self.encode_as(&Sheet { is_draft, ..self.sheet(format, output, recipe, &budget) })
    }

    /// The file, with the edits.
    fn encode_as(&self, sheet: &Sheet<'_>) -> Result<Encoded> {
        let (format, budget) = (sheet.format, sheet.budget);
        let Some(edited) = &self.edited else { return self.made.encode(sheet) };
        let own = &self.origin.recipe;
        // A picture is drawn of a file that was edited.
        let base = self.made.drawn_from(format).filter(|_| !own.edits.iter().all(|edit| edit.on == Some(format)));
        let Some(base) = base else {
            let encoded = self.made.encode(sheet)?;
            return Ok(Encoded { bytes: edited.apply(encoded.bytes, format, own, budget)?, ..encoded });
        };
        let encoded = self.made.encode(&Sheet { format: base, recipe: None, ..*sheet })?;
        self.made.encode_edited(&edited.apply(encoded.bytes, base, own, budget)?, sheet)
    }
}
