//! Fills of any width that run through the frame and do not repeat: the coat of a zebra, camouflage.
//!
//! They are continued as distances from their borders, patch by patch [Efros 2001], and traced again.

pub(crate) mod quilt;
pub(crate) mod sheet;
pub(crate) mod trace;

use arabesque_core::{
    Border, Budget, Covered, Domain, Error, Exemplar, Forecast, Matrix, Outcome, Outline, Progress, Request, Result,
    Snapshot, StopReason, Vector, Watch,
};

use crate::{
    ending::heard,
    obstacles::obstacles,
    regular::{
        areas::Cut,
        grid::{Grid, Ground, constant},
    },
    repeat::{Anchor, Explains, Extent, Lattice, Repeat},
};
use quilt::quilt;
use sheet::Sheet;
use trace::{Values, rings};

/// Work for a place, for the forecast, and most places of a page.
const PER_PLACE: f64 = 3e3;
const MOST: usize = 4_000_000;
/// Places beyond the border of a page that are made as well.
const BEYOND: usize = 3;

/// Fills, ready for any number of runs.
#[derive(Clone, Debug)]
pub(crate) struct Ink {
    sheet: Sheet,
}

/// Whether an exemplar draws nothing but fills of a few paints, some of which run through its frame.
pub(crate) fn takes(exemplar: &Exemplar<2>) -> bool {
    sheet::is_all_ink(exemplar)
}

impl Ink {
    /// Finds the fills; `None` where anything else is drawn.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        Ok(Sheet::new(exemplar, &budget.stage("measuring fills"))?.map(|sheet| Self { sheet }))
    }

    /// Fills a domain; `None` where fields bend the pattern, or something stays.
    ///
    /// # Errors
    /// As for [`crate::Prepared::run`].
    pub(crate) fn fill(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Outcome<2>>> {
        let stays = !request.frozen.is_empty() || !request.frozen_curves.is_empty() || request.known.is_some();
        let Some((turn, _, scale)) = constant(&request.fields) else { return Ok(None) };
        let wraps = matches!(request.domain, Domain::Torus(_));
        if stays || request.border == Border::Turn || (wraps && turn != Matrix::identity()) {
            return Ok(None);
        }
        let budget = &request.budget.stage("quilting fills");
        // The box of the page as it lies in the plane of the exemplar.
        let bounds = request.domain.bounds();
        let back = |p: Vector<2>| turn.transpose().apply(p) * (1.0 / scale);
        let corners = [
            bounds.min,
            Vector::xy(bounds.max[0], bounds.min[1]),
            bounds.max,
            Vector::xy(bounds.min[0], bounds.max[1]),
        ];
        let there = arabesque_core::Bounds::around(corners.map(back));
        let step = self.sheet.step;
        let beyond = if wraps { 0 } else { BEYOND };
        let size = [0, 1].map(|k| (there.size()[k] / step).round() as usize + 2 * beyond + usize::from(!wraps));
        let count = size[0].saturating_mul(size[1]);
        budget.within("places of the page", count, ("output-elements", MOST))?;
        let work = count as f64 * PER_PLACE;
        watch.foreseen(&Forecast { count: count as f64, work, allowed: request.budget.allowed() as f64 });
        let quilt = quilt(&self.sheet, size.map(|n| n.max(1)), wraps, request.seed, budget)?;
        // Around a tile places are as far apart as fits.
        let steps = [0, 1].map(|k| if wraps { there.size()[k] / size[k].max(1) as f64 } else { step });
        let first = there.min - Vector(steps.map(|step| step * (beyond + if wraps { BEYOND } else { 0 }) as f64));
        let place = |p: Vector<2>| turn.apply(first + Vector([p[0] * steps[0], p[1] * steps[1]])) * scale;
        let shown = if wraps { quilt.size.map(|n| n + 2 * BEYOND + 1) } else { quilt.size };
        let areas = self.areas(
            (exemplar, request),
            &|c, i, j| {
                let n = if wraps {
                    let around = |i: usize, n: usize| (i + n - BEYOND % n) % n;
                    around(j, quilt.size[1]) * quilt.size[0] + around(i, quilt.size[0])
                } else {
                    j * quilt.size[0] + i
                };
                f64::from(quilt.values[n * self.sheet.channels() + c])
            },
            (shown, &place),
            budget,
        )?;
        if areas.is_empty() {
            let advice = "make the domain larger, or lower the scale";
            return Err(Error::no_result("no fill fits into the domain", advice));
        }
        let count = areas.len();
        let made = Progress { stage: "quilting fills".into(), done: 1, total: 1, fraction: 1.0, energy: None, count };
        let preview = || Snapshot { areas: areas.clone(), ..Snapshot::default() };
        let stopped = match heard(watch.step(&made, &preview), &made) {
            Ok(()) => StopReason::Finished,
            Err(_) => StopReason::Stopped,
        };
        let (placements, sequence, curves, energy, warnings) = Default::default();
        Ok(Some(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    /// The fills of a quilt of which the values are given, cut at the border of the domain.
    fn areas(
        &self,
        (exemplar, request): (&Exemplar<2>, &Request<2>),
        value: &dyn Fn(usize, usize, usize) -> f64,
        (size, place): ([usize; 2], &dyn Fn(Vector<2>) -> Vector<2>),
        budget: &Budget,
    ) -> Result<Vec<Covered<2>>> {
        let obstacles = obstacles(request)?;
        let sides = exemplar.window.size();
        let Some(lattice) = Lattice::new(Vector::xy(sides[0], 0.0), Vector::xy(0.0, sides[1])) else {
            return Ok(Vec::new());
        };
        let (explains, extent) = (Explains::Everything, Extent::Plane);
        let grid = Grid::flat(&Repeat { lattice, explains, extent, anchor: Anchor::Centre, jitter: 0.0, share: 1.0 });
        let ground = Ground { grid: &grid, request, obstacles: obstacles.as_ref() };
        let cut = Cut::new(&ground);
        let mut made = Vec::new();
        for (channel, &source) in self.sheet.sources.iter().enumerate() {
            let values = Values { size, at: &|i, j| value(channel, i, j) };
            let rings = rings(&values, budget)?.into_iter().map(|ring| ring.into_iter().map(place).collect()).collect();
            let outline = cut.apply(Outline { rings }, budget)?;
            if !outline.rings.is_empty() {
                made.push(Covered { outline, source, paint: (Matrix::identity(), Vector::ZERO) });
            }
        }
        Ok(made)
    }
}
