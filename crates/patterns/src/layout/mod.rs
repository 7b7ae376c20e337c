//! The first layout, and mending of holes.

pub(crate) mod coverage;
pub(crate) mod grains;
pub(crate) mod grow;
pub(crate) mod noise;
pub(crate) mod patch_site;

use arabesque_core::{Matrix, Meter, Request, Result};

use crate::{
    border::Extent,
    exemplar::library::Library,
    layout::{
        coverage::Coverage,
        grow::{Grower, Watch},
        patch_site::GrowParams,
    },
    output::{
        canvas::Canvas,
        draft::{Draft, Items},
        state::State,
    },
    params::{Initialisation, Params},
};

/// Patch radius of the context relative to that of the patch.
const CONTEXT: f64 = 1.5;

/// Raster cell of the coverage, in mean spacings: three cells between two elements tell apart what is covered.
const CELL: f64 = 0.3;

/// A hole is laid out anew when its radius exceeds this share of the largest one in the exemplar.
const HOLE: f64 = 0.9;

/// The same where there are strokes: the meshes of a net are all about as large as the largest one, and are to stay
/// empty.
const HOLE_STROKES: f64 = 1.0;

/// Items that a patch is registered on, where it is to join what is there.
const ANCHORS: usize = 3;

/// Lays out one output.
pub(crate) struct Layout<'a, const D: usize> {
    pub(crate) library: &'a Library<D>,
    pub(crate) params: &'a Params,
    pub(crate) request: &'a Request<D>,
    pub(crate) extent: &'a Extent<'a, D>,
    /// First pseudo element, see [`crate::exemplar::level::Level::base`].
    pub(crate) base: u32,
}

impl<const D: usize> Layout<'_, D> {
    /// The first state: what is frozen, and everything else by the chosen initialisation.
    /// Where it is cut short, what there is so far.
    pub(crate) fn initialise(&self, frozen: Draft<D>, watch: Watch<'_, D>) -> (Draft<D>, Result<()>) {
        match self.params.initialisation {
            Initialisation::PatchCopy => return self.grow(frozen, &Items::new(), ANCHORS, watch),
            Initialisation::RandomCopy => return self.grow(frozen, &Items::new(), 0, watch),
            Initialisation::WhiteNoise => {}
        }
        let mut canvas = self.canvas();
        frozen.items.iter().for_each(|(item, _)| canvas.push(*item));
        let ended = noise::scatter(self.library, self.request, self.extent, &mut canvas);
        (Draft { items: self.with_turns(canvas, &frozen.items), links: frozen.links }, ended)
    }

    /// Patches that join what is frozen and the items of a `grain`.
    pub(crate) fn regrow(&self, frozen: Draft<D>, grain: &Items<D>, watch: Watch<'_, D>) -> (Draft<D>, Result<()>) {
        self.grow(frozen, grain, ANCHORS, watch)
    }

    /// Patches around what is frozen and around the items of a `grain`, each registered on `anchors` items.
    fn grow(&self, frozen: Draft<D>, grain: &Items<D>, anchors: usize, watch: Watch<'_, D>) -> (Draft<D>, Result<()>) {
        let mut canvas = self.canvas();
        frozen.items.iter().chain(grain).for_each(|(item, _)| canvas.push(*item));
        let ended = self.grow_around(&mut canvas, &frozen, grain, anchors, watch);
        let known: Items<D> = frozen.items.iter().chain(grain).copied().collect();
        (Draft { items: self.with_turns(canvas, &known), links: frozen.links }, ended)
    }

    fn grow_around(
        &self,
        canvas: &mut Canvas<D>,
        frozen: &Draft<D>,
        grain: &Items<D>,
        anchors: usize,
        watch: Watch<'_, D>,
    ) -> Result<()> {
        let mut coverage = self.coverage()?;
        let budget = self.request.budget.stage("laying out");
        let mut meter = budget.meter();
        // What the user drew is complete as it is: patches join it, they do not fill it up.
        let drawn = frozen.items.iter().filter(|(item, _)| item.source >= self.base);
        // What lies outside does not say that anything inside is complete.
        let inside = |p: &arabesque_core::Vector<D>| self.extent.depth(*p) > self.library.spacing;
        let drawn: Vec<_> = drawn.map(|(item, _)| item.position).filter(inside).collect();
        if !drawn.is_empty() {
            coverage.cover_closed(&drawn, self.hole() * self.extent.largest_spacing_scale, &mut meter)?;
        }
        self.cover(&mut coverage, grain.iter().map(|(item, _)| item.position), &mut meter)?;
        self.grower(anchors).fill(canvas, &mut coverage, watch)
    }

    /// Lays out anew what is emptier than anything in the exemplar.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop; then the state stays as it is.
    pub(crate) fn fill_holes(&self, state: &mut State<'_, D>) -> Result<()> {
        let budget = self.request.budget.stage("filling holes");
        let mut meter = budget.meter();
        let mut canvas = self.canvas();
        let mut coverage = self.coverage()?;
        state.items().iter().filter(|live| live.alive).for_each(|live| canvas.push(live.item));
        let known = canvas.items.len();
        self.cover(&mut coverage, canvas.items.iter().map(|i| i.position), &mut meter)?;
        if self.has_strokes() {
            // At the rim of the margin there is room only because nothing is known beyond it.
            let rim = (self.hole() * self.extent.smallest_spacing_scale - self.extent.margin).min(0.0);
            coverage.close(|p| self.request.domain.signed_distance(p) < rim, &mut meter)?;
        }
        // Holes are few and small: nothing is told of them.
        self.grower(ANCHORS).fill(&mut canvas, &mut coverage, &mut |_, _| Ok(()))?;
        canvas.items.iter().skip(known).for_each(|&item| _ = state.push(item, Matrix::identity()));
        state.reindex();
        Ok(())
    }

    /// Takes for complete what lies around `places`.
    fn cover(
        &self,
        coverage: &mut Coverage<D>,
        places: impl Iterator<Item = arabesque_core::Vector<D>>,
        meter: &mut Meter<'_>,
    ) -> Result<()> {
        let (reach, fields) = (self.hole(), &self.request.fields);
        coverage.cover_around(places, |p| reach * fields.frame(p).spacing_scale, meter)
    }

    /// Radius, exemplar units, up to which a hole is meant to be there.
    fn hole(&self) -> f64 {
        self.library.emptiness * if self.has_strokes() { HOLE_STROKES } else { HOLE }
    }

    fn with_turns(&self, canvas: Canvas<D>, known: &Items<D>) -> Items<D> {
        let turns = known.iter().map(|(_, turn)| *turn).chain(std::iter::repeat(Matrix::identity()));
        canvas.items.into_iter().zip(turns).collect()
    }

    fn patch_radius(&self) -> f64 {
        let shortest = |v: arabesque_core::Vector<D>| v.0.into_iter().fold(f64::INFINITY, f64::min);
        let side = self.library.view.side();
        let radius = self.library.radius_for(self.params.patch);
        // A handful of curve samples is not a patch: several strokes side by side are.
        let radius = if self.has_strokes() { f64::INFINITY } else { radius }.min(self.params.patch_share * side);
        match self.request.domain.period() {
            // On a small tile the surroundings must not reach around the back.
            Some(period) => radius.min(0.5 * shortest(period) / (CONTEXT * self.extent.largest_spacing_scale)),
            None => radius,
        }
    }

    fn has_strokes(&self) -> bool {
        (self.base as usize) < self.library.len()
    }

    fn canvas(&self) -> Canvas<D> {
        let cell = 0.7 * self.patch_radius() * self.extent.largest_spacing_scale;
        Canvas::new(&self.request.domain, self.extent.margin, cell)
    }

    fn coverage(&self) -> Result<Coverage<D>> {
        let cell = CELL * self.library.spacing * self.extent.smallest_spacing_scale;
        Coverage::new(&self.request.domain, self.extent.margin, cell, &self.request.budget.stage("laying out"))
    }

    fn grower(&self, anchors: usize) -> Grower<'_, D> {
        let patch = self.patch_radius();
        let params = GrowParams {
            patch,
            context: CONTEXT * patch,
            repeat: self.params.novelty,
            balance: self.params.balance,
            base: self.base,
            anchors,
        };
        Grower::new(self.library, self.request, self.extent, params)
    }
}
