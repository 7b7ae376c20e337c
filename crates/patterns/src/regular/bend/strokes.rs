//! Strokes on a bent lattice: drawn flat in the coordinates of the exemplar, and carried over.

use arabesque_core::{
    Border, Budget, Cubic, Domain, Drawn, Exemplar, Measured, Path, Region, Request, Result, Vector, cubic_part,
    spans_inside,
};

use crate::{
    regular::{
        bend::{
            chart::{Chart, Spot},
            elements::{BAND, Bending},
            seams::{Strand, joined},
        },
        grid::{Grid, Ground},
        joints::Cell,
        strokes::Strokes,
    },
    repeat::lattice::Node,
};

/// Pieces of strokes that are carried over one by one are no longer than this share of the shorter vector.
const PIECE: f64 = 0.12;

/// Steps in which a stroke is looked through for the border, and how finely it is flattened for that, as shares of the
/// shorter vector.
const STEP: f64 = 0.02;
const FLAT: f64 = 0.002;

/// A stroke whose width changes by more than this share is drawn in pieces.
const WIDTH: f64 = 0.05;

/// Widths differ by no more than this from what growth in the mean makes of them.
const WIDEST: (f64, f64) = (0.6, 1.6);

/// Pieces of one stroke overlap by what of a piece comes after this share of it.
const OVERLAP: f64 = 0.85;

/// Scraps shorter than this share of the shorter vector are dropped.
const SCRAP: f64 = 0.02;

/// Work for a place that is looked for.
const FIND: u64 = 1500;

/// Places in a cell, along each side, of which one must lie in a chart.
const LOOK: usize = 4;

/// Strokes of the exemplar, to be bent.
pub(crate) struct BentStrokes<'a> {
    pub(crate) bending: &'a Bending<'a>,
    pub(crate) exemplar: &'a Exemplar<2>,
    pub(crate) cell: &'a Cell,
    /// The lattice as it lies in the exemplar.
    pub(crate) flat: &'a Grid,
}

impl BentStrokes<'_> {
    /// The cells that show in a chart.
    ///
    /// # Errors
    /// When there are too many, the budget is used up, or somebody asks to stop.
    pub(crate) fn nodes(&self, chart: &Chart) -> Result<Vec<Node>> {
        let lattice = self.bending.lattice;
        let mut shown = Vec::new();
        for node in self.bending.nodes(chart, self.cell.origin)? {
            self.bending.request.budget.spend(FIND * 4)?;
            let share = |k: usize| k as f64 / LOOK as f64;
            let corner = self.cell.origin + lattice.at(node);
            let mut places = (0..=LOOK).flat_map(|i| (0..=LOOK).map(move |j| Vector::xy(share(i), share(j))));
            if places.any(|p| chart.find(corner + lattice.vector(p)).is_some()) {
                shown.push(node);
            }
        }
        Ok(shown)
    }

    /// Adds the strokes of all charts to `made`.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn draw(&self, made: &mut Vec<Drawn<2>>) -> Result<()> {
        let budget = self.bending.request.budget.stage("drawing strokes");
        let mut strands = Vec::new();
        for chart in &self.bending.charts.all {
            let nodes = self.nodes(chart)?;
            for line in self.drawn_flat(chart, &nodes)? {
                self.carry(chart, &line, &budget, &mut strands)?;
            }
        }
        made.extend(joined(strands, self.bending, self.exemplar, &budget)?);
        Ok(())
    }

    /// The strokes in the coordinates of the exemplar.
    fn drawn_flat(&self, chart: &Chart, nodes: &[Node]) -> Result<Vec<Drawn<2>>> {
        let request = self.bending.request;
        let flat = Request {
            border: Border::Cross,
            budget: request.budget.clone(),
            ..Request::new(Domain::Box(chart.extent().grown(self.bending.lattice.shorter())))
        };
        let strokes = Strokes { exemplar: self.exemplar, cell: self.cell, kept: None };
        let mut lines = Vec::new();
        strokes.draw(&Ground { grid: self.flat, request: &flat, obstacles: None }, nodes, &mut lines)?;
        Ok(lines)
    }

    /// Carries a stroke over, as far as it lies in the chart and may be seen.
    fn carry(&self, chart: &Chart, line: &Drawn<2>, budget: &Budget, into: &mut Vec<Strand>) -> Result<()> {
        let unit = self.bending.lattice.shorter();
        let width = self.exemplar.curves[line.source].width;
        let measured = Measured::new(line.path.clone(), FLAT * unit);
        budget.spend(FIND * (measured.length() / (STEP * unit) + 50.0) as u64)?;
        let holds = |image: Vector<2>| chart.find(image).is_some_and(|spot| self.shows(&spot, width));
        let length = measured.length();
        for (a, b) in spans_inside(&measured, STEP * unit, &holds).into_iter().filter(|(a, b)| b - a > SCRAP * unit) {
            let is_whole = a <= 0.0 && b >= length && measured.is_closed();
            let part = measured.part(a, b);
            budget.spend(FIND * (2.0 * (b - a) / (PIECE * unit) + part.cubics.len() as f64) as u64)?;
            // An end at which the page goes on lies where another chart does.
            let at_seam = |arc: f64| {
                let spot = chart.find(measured.point(arc)).or_else(|| chart.find_near(measured.point(arc)));
                spot.is_some_and(|spot| {
                    let inner = 1e-3 * unit * spot.frame().1;
                    self.bending.request.domain.signed_distance(spot.at) > self.margin(&spot, width) + inner
                        && !self.is_blocked(&spot, width + 2.0 * inner)
                })
            };
            let ends = if is_whole { [false; 2] } else { [a, b].map(at_seam) };
            self.bent(chart, &part, line.source, ends, into);
        }
        Ok(())
    }

    /// How far inside the border the middle of a stroke must lie.
    fn margin(&self, spot: &Spot, width: f64) -> f64 {
        let growth = spot.frame().1;
        let half = 0.5 * width * growth;
        match self.bending.request.border {
            Border::Clip if width > BAND * self.bending.lattice.shorter() => -1.5 * half,
            Border::Clip => 0.0,
            Border::Inside | Border::Turn => half,
            Border::Cross => f64::NEG_INFINITY,
        }
    }

    fn is_blocked(&self, spot: &Spot, width: f64) -> bool {
        let half = 0.5 * width * spot.frame().1;
        self.bending.obstacles.is_some_and(|o| o.signed_distance(spot.at) > -half)
    }

    fn shows(&self, spot: &Spot, width: f64) -> bool {
        self.bending.request.domain.signed_distance(spot.at) >= self.margin(spot, width)
            && !self.is_blocked(spot, width)
    }

    /// The strands that a path becomes: as many as its width takes.
    fn bent(&self, chart: &Chart, path: &Path<2>, source: usize, ends: [bool; 2], into: &mut Vec<Strand>) {
        let mut pieces: Vec<(Cubic<2>, f64)> = Vec::new();
        for cubic in &path.cubics {
            let length: f64 = cubic.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
            let count = (length / (PIECE * self.bending.lattice.shorter())).ceil().clamp(1.0, 1000.0);
            for k in 0..count as usize {
                let part = cubic_part(cubic, k as f64 / count, (k as f64 + 1.0) / count);
                pieces.extend(carried(chart, &part));
            }
        }
        let mut groups: Vec<Strand> = Vec::new();
        for (cubic, scale) in pieces {
            match groups.last_mut() {
                Some(group) if (scale / group.scale - 1.0).abs() <= WIDTH => group.path.cubics.push(cubic),
                last => {
                    // A little of the piece before, so that no hair line is left between them.
                    let before = last.and_then(|group| group.path.cubics.last()).map(|c| cubic_part(c, OVERLAP, 1.0));
                    let path = Path { cubics: before.into_iter().chain([cubic]).collect(), closed: false };
                    groups.push(Strand { path, source, scale, ends: [false; 2] });
                }
            }
        }
        let count = groups.len();
        for (k, group) in groups.iter_mut().enumerate() {
            group.ends = [ends[0] && k == 0, ends[1] && k + 1 == count];
            group.path.closed = path.closed && count == 1;
        }
        into.extend(groups);
    }
}

/// A short piece on the page, and by how much its width grows: by what lengths across it do.
fn carried(chart: &Chart, piece: &Cubic<2>) -> Option<(Cubic<2>, f64)> {
    let spot = |image: Vector<2>| chart.find(image).or_else(|| chart.find_near(image));
    let (start, end) = (spot(piece[0])?, spot(piece[3])?);
    let way = (piece[3] - piece[0]).unit_or_zero();
    let across = Vector::xy(-way[1], way[0]);
    let scale = |spot: &Spot| {
        let (is, mean) = (spot.inward.transpose().apply(across).norm(), spot.frame().1);
        (1.0 / is.max(f64::MIN_POSITIVE)).clamp(WIDEST.0 * mean, WIDEST.1 * mean)
    };
    let bent = [
        start.at,
        start.at + start.outward.apply(piece[1] - piece[0]),
        end.at + end.outward.apply(piece[2] - piece[3]),
        end.at,
    ];
    Some((bent, 0.5 * (scale(&start) + scale(&end))))
}
