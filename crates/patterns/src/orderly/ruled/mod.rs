//! Lines on squared paper: mazes, traces of circuits, tiles of lines that are turned at random.
//!
//! All lines of the exemplar run from node to node of a lattice, along it or half way between, and all things lie on its
//! nodes. The output is decided node by node: each gets the steps and the thing of a node of the exemplar around which
//! the same is drawn as far as it is decided [Efros 1999]. Steps have two ends, which agree, so that lines go on; where the
//! exemplar has no rings, none are closed.

mod draw;
mod grow;
mod net;
mod sheet;
mod star;
#[cfg(test)]
mod tests;

use arabesque_core::{
    Border, Budget, Domain, Error, Exemplar, Outcome, Placement, Progress, Request, Result, Similarity, Snapshot,
    StopReason, Vector, Warning, Watch,
};

use crate::{
    ending::heard,
    exemplar::checks,
    obstacles::obstacles,
    regular::{
        admit::{Admission, outline_of},
        grid::{Grid, Ground},
        strokes::BorderCut,
    },
    repeat::Repeat,
};
use net::Net;
use sheet::Sheet;

/// Work for a node, for the forecast.
const PER_NODE: f64 = 1e5;

/// An exemplar on squared paper, ready for any number of runs.
#[derive(Clone, Debug)]
pub(crate) struct Ruled {
    sheet: Sheet,
    repeat: Repeat,
}

impl Ruled {
    /// Finds the paper; `None` where there is none.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let Some(sheet) = Sheet::new(exemplar, &budget.stage("looking for squared paper"))? else { return Ok(None) };
        Ok(Some(Self { repeat: Repeat::drawn(sheet.lattice), sheet }))
    }

    /// Fills a domain; `None` where fields bend the paper, a tile does not suit it, or something stays.
    ///
    /// # Errors
    /// [`Error::Limit`] when the output would be too large, or a limit is reached; [`Error::Stopped`] when somebody asks to
    /// stop; [`Error::NoResult`] when nothing fits into the domain.
    pub(crate) fn fill(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Outcome<2>>> {
        let turns = request.border == Border::Turn && !matches!(request.domain, Domain::Torus(_));
        let stays = !request.frozen.is_empty() || !request.frozen_curves.is_empty() || request.known.is_some();
        if turns || stays {
            return Ok(None);
        }
        let Ok(grid) = Grid::new(&self.repeat, exemplar, request) else { return Ok(None) };
        let count = request.domain.measure() / grid.lattice.cell();
        checks::expected(count, &request.budget)?;
        watch.foreseen(&request.budget.forecast(count, count * PER_NODE));
        let progress = |done: usize, count: usize| Progress {
            stage: "drawing on squared paper".into(),
            done,
            total: 2,
            fraction: 0.5 * done as f64,
            energy: None,
            count,
        };
        heard(watch.step(&progress(0, 0), &Snapshot::default), &progress(0, 0))?;
        let [a, b] = self.sheet.lattice.vectors;
        let corner = self.sheet.origin - (a + b) * 0.5;
        let bounds = request.domain.bounds().grown(grid.lattice.shorter());
        let budget = &request.budget.stage("drawing on squared paper");
        let mut net = Net::new(&self.sheet, &grid, grid.nodes(corner, &bounds, budget)?);
        grow::grow(&mut net, request.seed, budget)?;
        let obstacles = obstacles(request)?;
        let ground = Ground { grid: &grid, request, obstacles: obstacles.as_ref() };
        let mut curves = Vec::new();
        let cut = BorderCut::new(&ground, None);
        for line in draw::lines(&net, budget)? {
            let curve = &exemplar.curves[line.source];
            cut.cut(line, (curve.style, curve.width), budget, &mut curves)?;
        }
        let placements = things(&net, exemplar, &ground, budget)?;
        if curves.is_empty() && placements.is_empty() {
            let advice = "make the domain larger, or lower the scale";
            return Err(Error::no_result("no stroke fits into the domain", advice));
        }
        let made = progress(2, curves.len());
        let preview = || Snapshot { placements: placements.clone(), curves: curves.clone(), ..Snapshot::default() };
        let stopped = match heard(watch.step(&made, &preview), &made) {
            Ok(()) => StopReason::Finished,
            Err(_) => StopReason::Stopped,
        };
        let (sequence, areas, energy, warnings) = (Vec::new(), Vec::new(), Vec::new(), self.warnings());
        Ok(Some(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    fn warnings(&self) -> Vec<Warning> {
        if self.sheet.walls == 0 {
            return Vec::new();
        }
        vec![Warning::new(
            "the walls around the drawing are left out: the pattern goes on beyond them",
            "draw a wall around the result, or leave it out of the exemplar",
        )]
    }
}

/// The things on the nodes of a net.
fn things(net: &Net<'_>, exemplar: &Exemplar<2>, ground: &Ground<'_>, budget: &Budget) -> Result<Vec<Placement<2>>> {
    let admission = Admission::new(ground.request, ground.obstacles, Vec::new());
    let mut made = Vec::new();
    for (node, star) in net.nodes.iter().zip(&net.stars) {
        let Some(source) = star.thing.filter(|thing| *thing > 0).map(|thing| thing as usize - 1) else { continue };
        let centre = exemplar.elements[source].centre;
        let (_, rest) = net.sheet.lattice.nearest(centre - net.sheet.origin);
        let at: Vector<2> = net.grid.place(net.sheet.origin, *node) + net.grid.vector(rest);
        let at = ground.request.domain.wrap(at);
        let transform = Similarity::about(centre, at, net.grid.rotation, net.grid.element_scale);
        let placement = Placement { source, transform, control: Vec::new(), frozen: None };
        if admission.admits(&outline_of(&placement, exemplar), at, budget)? {
            made.push(placement);
        }
    }
    Ok(made)
}
