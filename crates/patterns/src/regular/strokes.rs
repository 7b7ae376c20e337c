//! Strokes on a lattice: the pieces of one cell, copied to all cells and joined to lines again.

use std::collections::BTreeMap;

use arabesque_core::{
    Border, Budget, Domain, Drawn, Exemplar, Measured, Path, Region, Result, Shape, Vector, spans_inside,
};

use crate::{
    regular::{
        grid::{Grid, Ground},
        joints::{Cell, Next},
        kept::{Kept, is_covered},
    },
    repeat::lattice::Node,
};

/// Scraps that the border leaves of a stroke are dropped when they are shorter than this many widths.
const SCRAP: f64 = 0.5;

/// Strokes wider than this share of the shorter vector are bands: their ink shows beyond the border that cuts their
/// middle.
const BAND: f64 = 0.05;

/// Lines are flattened to this share of the shorter vector where the border is looked for, and looked at in such steps.
const FLAT: (f64, f64) = (0.001, 0.02);

/// Work for each segment that is placed, and for each place at which the border is looked for.
const WORK: (u64, u64) = (100, 200);

/// Strokes of the exemplar in the cells of a lattice.
pub(crate) struct Strokes<'a> {
    pub(crate) exemplar: &'a Exemplar<2>,
    pub(crate) cell: &'a Cell,
    /// Strokes that stay.
    pub(crate) kept: Option<&'a Kept>,
}

/// A piece in a cell of the output, as its stroke runs through it.
#[derive(Clone, Copy, Debug)]
struct Place {
    node: Node,
    part: usize,
    /// The end at which the stroke enters it.
    enters: usize,
}

impl Strokes<'_> {
    /// Widest stroke.
    pub(crate) fn widest(&self) -> f64 {
        self.cell.parts.iter().map(|p| self.exemplar.curves[p.curve].width).fold(0.0, f64::max)
    }

    /// The cells of a tile, or all that may show.
    ///
    /// # Errors
    /// When there are too many.
    pub(crate) fn nodes(&self, ground: &Ground<'_>, margin: f64) -> Result<Vec<Node>> {
        let request = ground.request;
        ground.grid.nodes(self.cell.origin, &request.domain.bounds().grown(margin), &request.budget)
    }

    /// Adds the strokes in the cells `nodes` to `made`, cut at the border of the domain.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop; what is made by then is whole.
    pub(crate) fn draw(&self, ground: &Ground<'_>, nodes: &[Node], made: &mut Vec<Drawn<2>>) -> Result<()> {
        let grid = ground.grid;
        let budget = ground.request.budget.stage("drawing strokes");
        let number: BTreeMap<Node, usize> = nodes.iter().enumerate().map(|(k, &n)| (n, k)).collect();
        let count = self.cell.parts.len();
        let (mut is_drawn, _held) = budget.list("pieces of strokes", nodes.len() * count)?;
        is_drawn.resize(nodes.len() * count, false);
        let slot = |node: Node, part: usize| number.get(&grid.wrap(node)).map(|k| k * count + part);
        let border = BorderCut::new(ground, self.kept);
        for &node in nodes {
            for part in 0..count {
                if slot(node, part).is_none_or(|s| is_drawn[s]) {
                    continue;
                }
                let start = self.start(Place { node, part, enters: 0 }, grid, &slot);
                let chain = self.chain(start, grid, &mut |place| {
                    slot(place.node, place.part).is_some_and(|s| !std::mem::replace(&mut is_drawn[s], true))
                });
                budget.spend(
                    WORK.0 * chain.0.iter().map(|p| self.cell.parts[p.part].path.cubics.len() as u64).sum::<u64>(),
                )?;
                let line = self.drawn(&chain.0, chain.1, grid);
                let curve = &self.exemplar.curves[line.source];
                border.cut(line, (curve.style, curve.width), &budget, made)?;
            }
        }
        Ok(())
    }

    /// Where the place beyond an end of a piece is.
    fn beyond(&self, place: Place, end: usize) -> Option<Place> {
        let Next { part, end, step } = self.cell.parts[place.part].next[end]?;
        Some(Place { node: [place.node[0] + step[0], place.node[1] + step[1]], part, enters: end })
    }

    /// The first piece of the stroke through a place, looking back; the place itself where the stroke is closed.
    fn start(&self, place: Place, grid: &Grid, slot: &dyn Fn(Node, usize) -> Option<usize>) -> Place {
        let mut first = place;
        let home = (grid.wrap(place.node), place.part);
        while let Some(before) = self.beyond(first, first.enters) {
            if slot(before.node, before.part).is_none() {
                break;
            }
            if (grid.wrap(before.node), before.part) == home {
                return place;
            }
            // It leaves the piece before where it enters this one.
            first = Place { enters: 1 - before.enters, ..before };
        }
        first
    }

    /// The pieces from a place on, and whether the last one leads back to the first.
    fn chain(&self, start: Place, grid: &Grid, take: &mut dyn FnMut(Place) -> bool) -> (Vec<Place>, bool) {
        let mut chain = vec![start];
        take(start);
        while let Some(last) = chain.last().copied() {
            let Some(next) = self.beyond(last, 1 - last.enters) else { break };
            if (grid.wrap(next.node), next.part) == (grid.wrap(start.node), start.part) {
                return (chain, next.node == start.node);
            }
            if !take(next) {
                break;
            }
            chain.push(next);
        }
        (chain, false)
    }

    fn drawn(&self, chain: &[Place], closed: bool, grid: &Grid) -> Drawn<2> {
        let mut path = Path { cubics: Vec::new(), closed };
        for place in chain {
            let part = &self.cell.parts[place.part].path;
            path.closed |= part.closed;
            let moved = part.map(|p| grid.place(p, place.node));
            let moved = if place.enters == 0 { moved } else { moved.reversed() };
            let joint = path.cubics.len();
            path.cubics.extend(moved.cubics);
            if joint > 0 {
                join(&mut path, joint - 1, joint);
            }
        }
        if closed && path.cubics.len() > 1 {
            let last = path.cubics.len() - 1;
            join(&mut path, last, 0);
        }
        let source = chain.first().map_or(0, |place| self.cell.parts[place.part].curve);
        Drawn { path, source, scale: grid.scale(), frozen: None }
    }
}

/// Makes one segment begin where another ends: both give way by half.
fn join(path: &mut Path<2>, before: usize, after: usize) {
    let half = (path.cubics[after][0] - path.cubics[before][3]) * 0.5;
    for k in [2, 3] {
        path.cubics[before][k] += half;
    }
    path.cubics[after][1] -= half;
    path.cubics[after][0] = path.cubics[before][3];
}

/// Cutting strokes at the border and at what is in the way.
pub(crate) struct BorderCut<'a> {
    domain: &'a Domain<2>,
    border: Border,
    obstacles: Option<&'a Shape>,
    kept: Option<&'a Kept>,
    /// How far over the border of a region that is filled again strokes that run along it may lie; `None` where there is no
    /// such region.
    slack: Option<f64>,
    /// The shorter vector in the output.
    unit: f64,
}

impl<'a> BorderCut<'a> {
    /// For a domain and its surroundings.
    pub(crate) fn new(ground: &Ground<'a>, kept: Option<&'a Kept>) -> Self {
        let Ground { grid, request, obstacles } = *ground;
        let slack = request.known.map(|known| 1e-9 * known.size().norm());
        let unit = grid.lattice.shorter();
        Self { domain: &request.domain, border: request.border, obstacles, kept, slack, unit }
    }

    /// Adds what is left of a line of this style and width.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn cut(
        &self,
        line: Drawn<2>,
        (style, width): (usize, f64),
        budget: &Budget,
        into: &mut Vec<Drawn<2>>,
    ) -> Result<()> {
        let width = width * line.scale;
        let is_endless = self.domain.period().is_some();
        if is_endless && self.obstacles.is_none() && self.kept.is_none() {
            into.push(line);
            return Ok(());
        }
        let half = 0.5 * width;
        let margin = match self.border {
            // What stays goes on at the border.
            Border::Clip | Border::Cross if self.slack.is_some() => -self.slack.unwrap_or_default(),
            Border::Clip if width > BAND * self.unit => -1.5 * half,
            Border::Clip => 0.0,
            Border::Inside | Border::Turn => half,
            Border::Cross => f64::NEG_INFINITY,
        };
        let is_blocked = |p: Vector<2>| self.obstacles.is_some_and(|o| o.signed_distance(p) > -half);
        // Around a region everything that stays lies beyond the border; elsewhere new strokes end where one that stays goes on.
        let stays = self.kept.filter(|_| self.slack.is_none());
        let is_there = |p: Vector<2>| stays.is_some_and(|kept| kept.has_any(p, style));
        let holds = |p: Vector<2>| self.domain.signed_distance(p) >= margin && !is_blocked(p) && !is_there(p);
        let measured = Measured::new(line.path.clone(), FLAT.0 * self.unit);
        let step = if self.slack.is_some() { 0.25 } else { 1.0 } * FLAT.1 * self.unit;
        budget.spend(WORK.1 * (measured.points().len() as u64 + (measured.length() / step) as u64))?;
        let spans = spans_inside(&measured, step, &holds);
        if matches!(spans.as_slice(), [(a, b)] if *a <= 0.0 && *b >= measured.length()) {
            into.push(line);
            return Ok(());
        }
        // A stroke is as long as it was where another goes on with it.
        let least = if self.slack.is_some() { 0.0 } else { SCRAP * width }.max(1e-3 * self.unit);
        for (a, b) in spans.into_iter().filter(|(a, b)| b - a > least) {
            let mut part = Drawn { path: measured.part(a, b), ..line.clone() };
            if let Some(kept) = self.kept {
                if is_covered(kept, &part, style) {
                    continue;
                }
                part.path = kept.joined(part.path, (style, width));
            }
            if !part.path.is_empty() {
                into.push(part);
            }
        }
        Ok(())
    }
}
