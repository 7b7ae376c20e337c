//! The first layout, and mending of holes.

use std::ops::ControlFlow;

use arabesque_core::{Matrix, Request};

use crate::{
    canvas::{Canvas, Item},
    coverage::Coverage,
    extent::Extent,
    grow::{GrowParams, Grower},
    library::Library,
    noise,
    params::{Initialisation, Params},
};

/// Patch radius of the context relative to that of the patch.
const CONTEXT: f64 = 1.5;

/// Raster cell of the coverage, in mean spacings: three cells between two elements tell apart what is covered.
const CELL: f64 = 0.3;

/// A hole is laid out anew when its radius exceeds this share of the largest one in the exemplar.
const HOLE: f64 = 0.9;

/// Items with their turns, as they are handed from level to level.
pub(crate) type Items<const D: usize> = Vec<(Item<D>, Matrix<D>)>;

/// Lays out one output.
pub(crate) struct Layout<'a, const D: usize> {
    pub(crate) library: &'a Library<D>,
    pub(crate) params: &'a Params,
    pub(crate) request: &'a Request<D>,
    pub(crate) extent: &'a Extent<'a, D>,
}

/// What the layout tells while it works: the state, and the share that is done.
pub(crate) type Watch<'a, const D: usize> = &'a mut dyn FnMut(&[Item<D>], f64) -> ControlFlow<()>;

impl<const D: usize> Layout<'_, D> {
    /// The first state: frozen items, and everything else by the chosen initialisation.
    pub(crate) fn initialise(&self, watch: Watch<'_, D>) -> (Items<D>, ControlFlow<()>) {
        let frozen = self.frozen();
        let mut canvas = self.canvas();
        frozen.iter().for_each(|(item, _)| canvas.push(*item));
        let mut flow = ControlFlow::Continue(());
        if self.params.initialisation == Initialisation::WhiteNoise {
            noise::scatter(self.library, self.request, self.extent, &mut canvas);
        } else {
            let mut coverage = self.coverage();
            flow = self.grower().fill(&mut canvas, &mut coverage, watch);
        }
        (self.with_turns(canvas, &frozen), flow)
    }

    /// Lays out anew what is emptier than anything in the exemplar.
    pub(crate) fn fill_holes(&self, items: &Items<D>) -> Items<D> {
        let mut canvas = self.canvas();
        let mut coverage = self.coverage();
        items.iter().for_each(|(item, _)| canvas.push(*item));
        let reach = HOLE * self.library.emptiness;
        let fields = &self.request.fields;
        coverage.cover_around(canvas.items.iter().map(|i| i.position), |p| reach * fields.frame(p).spacing_scale);
        // Holes are few and small: they are filled without asking whether to go on.
        let _ = self.grower().fill(&mut canvas, &mut coverage, &mut |_, _| ControlFlow::Continue(()));
        self.with_turns(canvas, items)
    }

    /// The user's items, with their turns relative to the local frame.
    fn frozen(&self) -> Items<D> {
        let one = |(n, placement): (usize, &arabesque_core::Placement<D>)| {
            let source = placement.source as u32;
            let position = placement.transform.apply(self.library.centre[placement.source]);
            let frame = self.request.fields.frame(position);
            let turn = frame.rotation.transpose().compose(&placement.transform.rotation);
            (Item { source, position, frozen: Some(n as u32) }, turn)
        };
        self.request.frozen.iter().enumerate().map(one).collect()
    }

    fn with_turns(&self, canvas: Canvas<D>, known: &Items<D>) -> Items<D> {
        let turns = known.iter().map(|(_, turn)| *turn).chain(std::iter::repeat(Matrix::identity()));
        canvas.items.into_iter().zip(turns).collect()
    }

    fn patch_radius(&self) -> f64 {
        let shortest = |v: arabesque_core::Vector<D>| v.0.into_iter().fold(f64::INFINITY, f64::min);
        let side = shortest(self.library.window.size());
        let radius = self.library.radius_for(self.params.patch).min(self.params.patch_share * side);
        match self.request.domain.period() {
            // On a small tile the surroundings must not reach around the back.
            Some(period) => radius.min(0.5 * shortest(period) / (CONTEXT * self.extent.largest_spacing_scale)),
            None => radius,
        }
    }

    fn canvas(&self) -> Canvas<D> {
        let cell = 0.7 * self.patch_radius() * self.extent.largest_spacing_scale;
        Canvas::new(&self.request.domain, self.extent.margin, cell)
    }

    fn coverage(&self) -> Coverage<D> {
        let cell = CELL * self.library.spacing * self.extent.smallest_spacing_scale;
        Coverage::new(&self.request.domain, self.extent.margin, cell)
    }

    fn grower(&self) -> Grower<'_, D> {
        let patch = self.patch_radius();
        let params = GrowParams {
            patch,
            context: CONTEXT * patch,
            repeat: self.params.novelty,
            balance: self.params.balance,
            anchors: if self.params.initialisation == Initialisation::RandomCopy { 0 } else { 3 },
        };
        Grower::new(self.library, self.request, self.extent, params)
    }
}
