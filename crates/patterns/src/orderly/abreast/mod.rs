//! Lines that run side by side through the frame: contour lines, the grain of wood, waves and stripes drawn by hand.
//!
//! Such lines are heights over one axis, in an order. What is drawn is how each rises and how far the next is from it; both are
//! taken from patches of the exemplar that go on as one another, and the lines are those that come nearest to that in the sense of
//! least squares. So each runs through from side to side, none meets another, and on a tile they close up.
//!
//! Symbols: a place is a line and a column; a rise is the difference of heights from a column to the next, a gap that from a line to
//! the next above it.

mod draw;
mod find;
mod heights;
mod quilt;
mod styles;
#[cfg(test)]
mod tests;

use arabesque_core::{
    Border, Budget, Domain, Drawn, Error, Exemplar, Matrix, Outcome, Progress, Request, Result, Snapshot, Stage,
    StopReason, Stream, Vector, Watch,
};

use crate::{
    ending::heard,
    exemplar::checks,
    obstacles::obstacles,
    regular::{
        grid::{Grid, Ground, constant},
        strokes::BorderCut,
    },
    repeat::{Lattice, Repeat},
};
use find::Lines;
use heights::{Measures, heights};
use quilt::{Sheet, quilt};

/// Draws of this module.
const STYLES: Stage = Stage::new(15);

/// Work for a place, for the forecast.
const PER_PLACE: f64 = 3e4;
/// How much nearer than in the exemplar lines may come, as shares of what nearly all of its lines keep, and all.
const NEARER: (f64, f64) = (0.9, 0.7);
/// Lines beyond the page, in how far those of the exemplar wander, and in lines.
const BEYOND: (f64, f64) = (2.0, 3.0);
/// A cell by which a page is laid on the exemplar, in distances of lines.
const CELL: f64 = 4.0;

/// An exemplar of lines side by side, ready for any number of runs.
#[derive(Clone, Debug)]
pub(crate) struct Abreast {
    lines: Lines,
}

/// The lines of an output, before they are drawn.
struct Page {
    sheet: Sheet,
    /// The style of each line.
    styles: Vec<usize>,
    measures: Measures,
    /// Where the first line begins, along and across, and the mean slope.
    origin: [f64; 2],
    slope: f64,
}

impl Abreast {
    /// Finds the lines; `None` where anything else is drawn.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let lines = Lines::find(exemplar, &budget.stage("looking for lines side by side"))?;
        Ok(lines.map(|lines| Self { lines }))
    }

    /// Fills a domain; `None` where fields bend the lines, a tile turns them, or something stays.
    ///
    /// # Errors
    /// As for [`crate::Prepared::run`].
    pub(crate) fn fill(
        &self,
        exemplar: &Exemplar<2>,
        request: &Request<2>,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<Option<Outcome<2>>> {
        let is_tile = matches!(request.domain, Domain::Torus(_));
        let stays = !request.frozen.is_empty() || !request.frozen_curves.is_empty() || request.known.is_some();
        if stays || (request.border == Border::Turn && !is_tile) {
            return Ok(None);
        }
        let Some((turn, _, spacing)) = constant(&request.fields) else { return Ok(None) };
        if is_tile && turn != Matrix::identity() {
            return Ok(None);
        }
        let Some(repeat) = self.repeat(&request.domain, spacing) else { return Ok(None) };
        let Ok(grid) = Grid::new(&repeat, exemplar, request) else { return Ok(None) };
        let budget = &request.budget.stage("drawing lines side by side");
        let page = match &request.domain {
            Domain::Torus(tile) => self.tile((tile.size(), spacing), request.seed, budget)?,
            domain => {
                let units = [Vector::xy(1.0, 0.0), Vector::xy(0.0, 1.0)];
                let axes = [units[self.lines.axis], units[1 - self.lines.axis]];
                self.page(grid.ranges(domain, axes), request.seed, budget)?
            }
        };
        let count = page.sheet.rows as f64 * page.sheet.columns as f64;
        watch.foreseen(&request.budget.forecast(count, count * PER_PLACE));
        let obstacles = obstacles(request)?;
        let ground = Ground { grid: &grid, request, obstacles: obstacles.as_ref() };
        let curves = self.drawn(&page, exemplar, &ground, budget)?;
        if curves.is_empty() {
            let advice = "make the domain larger, or lower the scale";
            return Err(Error::no_result("no stroke fits into the domain", advice));
        }
        let count = curves.len();
        let stage = "drawing lines side by side".into();
        let made = Progress { stage, done: 1, total: 1, fraction: 1.0, energy: None, count };
        let preview = || Snapshot { curves: curves.clone(), ..Snapshot::default() };
        let stopped = match heard(watch.step(&made, &preview), &made) {
            Ok(()) => StopReason::Finished,
            Err(_) => StopReason::Stopped,
        };
        let (placements, sequence, areas, energy, warnings) = Default::default();
        Ok(Some(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    /// A cell by which a page is laid on the exemplar, or the whole of a tile.
    fn repeat(&self, domain: &Domain<2>, spacing: f64) -> Option<Repeat> {
        let sides = match domain {
            Domain::Torus(tile) => (tile.size() * (1.0 / spacing)).0,
            _ if self.lines.axis == 0 => [CELL * self.lines.gap, self.lines.gap],
            _ => [self.lines.gap, CELL * self.lines.gap],
        };
        Lattice::new(Vector::xy(sides[0], 0.0), Vector::xy(0.0, sides[1])).map(Repeat::drawn)
    }

    /// Lines that cover what lies between these places, along and across.
    fn page(&self, [along, across]: [[f64; 2]; 2], seed: u64, budget: &Budget) -> Result<Page> {
        let Lines { step, slope, gap, wander, .. } = self.lines;
        let columns = ((along[1] - along[0]) / step).ceil() as usize + 3;
        let origin = along[0] - step;
        // The lines rise by so much from the first column to the last.
        let rise = slope * step * (columns - 1) as f64;
        let beyond = BEYOND.0 * wander + BEYOND.1 * gap;
        let low = across[0] - rise.max(0.0) - beyond;
        let rows = ((across[1] - rise.min(0.0) + beyond - low) / gap).ceil() as usize + 1;
        checks::expected(rows as f64 * columns as f64, budget)?;
        let styles = styles::styles(&self.lines, rows, &mut Stream::new(seed, STYLES, 0), budget)?;
        let sheet = Sheet { rows, columns, closes: None };
        Ok(Page { sheet, styles, measures: self.measures(step, gap), origin: [origin, low], slope })
    }

    /// Lines that close up on a tile.
    fn tile(&self, (size, spacing): (Vector<2>, f64), seed: u64, budget: &Budget) -> Result<Page> {
        let lines = &self.lines;
        let [length, height] = [size[lines.axis] / spacing, size[1 - lines.axis] / spacing];
        let columns = (length / lines.step).round().max(4.0);
        checks::expected(columns * (height / lines.gap), budget)?;
        let mut stream = Stream::new(seed, STYLES, 0);
        let styles = styles::closed(lines, height / lines.gap, &mut stream, budget)?;
        let rows = styles.len();
        let (step, gap) = (length / columns, height / rows as f64);
        // After one turn around, a line goes on as one of its style, as nearly as the slope asks for.
        let wanted = lines.slope * length / gap;
        let goes_on = |&shift: &i64| {
            (0..rows).all(|row| styles[row] == styles[(row as i64 + shift).rem_euclid(rows as i64) as usize])
        };
        let around = (wanted.round() as i64 - rows as i64)..=(wanted.round() as i64 + rows as i64);
        let off = |shift: &i64| (*shift as f64 - wanted).abs();
        let mut shifts: Vec<i64> = around.collect();
        shifts.sort_by(|a, b| off(a).total_cmp(&off(b)));
        let shift = shifts.into_iter().find(goes_on).unwrap_or(0);
        let closes = Some(shift.rem_euclid(rows as i64) as usize);
        let sheet = Sheet { rows, columns: columns as usize, closes };
        // Lines begin anywhere.
        let low = stream.range(0.0, gap);
        let slope = shift as f64 * gap / length;
        Ok(Page { sheet, styles, measures: self.measures(step, gap), origin: [0.0, low], slope })
    }

    fn measures(&self, step: f64, gap: f64) -> Measures {
        let lines = &self.lines;
        let share = gap / lines.gap;
        Measures {
            step,
            gap,
            length: lines.step * lines.columns as f64,
            wanted: NEARER.0 * lines.usual_least * share,
            least: NEARER.1 * lines.least * share,
        }
    }

    /// The lines of a page, cut at the border of the domain.
    fn drawn(
        &self,
        page: &Page,
        exemplar: &Exemplar<2>,
        ground: &Ground<'_>,
        budget: &Budget,
    ) -> Result<Vec<Drawn<2>>> {
        let (sheet, measures, lines) = (page.sheet, &page.measures, &self.lines);
        let seed = ground.request.seed;
        let mut wanted = quilt(lines, sheet, &page.styles, seed, budget)?;
        // A tile stretches steps and distances a little.
        wanted.rises.iter_mut().for_each(|(rise, _)| *rise *= measures.gap / lines.gap);
        wanted.gaps.iter_mut().for_each(|(gap, _)| *gap *= measures.gap / lines.gap);
        let heights = heights(sheet, &wanted, measures, budget)?;
        let mut stream = Stream::new(seed, STYLES, 1);
        let cut = BorderCut::new(ground, None);
        let corner = if sheet.closes.is_some() { exemplar.window.min } else { Vector::ZERO };
        let end = if sheet.closes.is_some() { sheet.columns + 1 } else { sheet.columns };
        let mut curves = Vec::new();
        for row in 0..sheet.rows {
            let of_style: Vec<usize> =
                lines.lines.iter().filter(|line| line.style == page.styles[row]).map(|line| line.curve).collect();
            let source = of_style[stream.below(of_style.len())];
            let point = |column: usize| {
                let beside = sheet.number(row, column).map_or(0.0, |n| heights[n]);
                let along = page.origin[0] + column as f64 * measures.step;
                let rise = page.slope * column as f64 * measures.step;
                let across = page.origin[1] + row as f64 * measures.gap + rise + beside;
                let p = if lines.axis == 0 { Vector::xy(along, across) } else { Vector::xy(across, along) };
                ground.grid.place(corner + p, [0, 0])
            };
            let points: Vec<Vector<2>> = (0..end).map(point).collect();
            let path = draw::smooth(&points, measures.gap * ground.grid.scale());
            let curve = &exemplar.curves[source];
            let line = Drawn { path, source, scale: ground.grid.scale(), frozen: None };
            cut.cut(line, (curve.style, curve.width), budget, &mut curves)?;
        }
        Ok(curves)
    }
}
