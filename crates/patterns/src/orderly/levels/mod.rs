//! Lines that are the levels of something: contours of a map, the grain of wood.
//!
//! Lines that neither end nor meet part the frame so that each has one side below and one above. Heights between them are
//! continued patch by patch [Efros 2001] and their levels drawn: so lines of the result neither end nor meet.

mod heights;

use arabesque_core::{
    Border, Bounds, Budget, Cubic, Curve, Domain, Drawn, Element, Error, Exemplar, Forecast, Outcome, Path, Progress,
    Request, Result, Ring, Snapshot, StopReason, Vector, Watch, ring,
};

use crate::{
    ending::heard,
    finish::loose::LooseEnds,
    obstacles::obstacles,
    orderly::ink::{
        quilt::quilt,
        sheet::Sheet,
        trace::{Values, rings},
    },
    regular::{
        grid::{Grid, Ground, constant},
        strokes::BorderCut,
    },
    repeat::{Anchor, Explains, Extent, Lattice, Repeat},
};
use heights::Heights;

/// Lines at least.
const LINES: usize = 6;
/// Work for a place, for the forecast, and most places of a page.
const PER_PLACE: f64 = 3e3;
const MOST: usize = 4_000_000;
/// Places beyond the border of a page that are made as well.
const BEYOND: usize = 4;
/// Rings shorter than this, in mean distances of lines, are not drawn.
const SPECK: f64 = 0.8;
/// Widths and colours of one pen.
const PEN: f64 = 0.02;
const COLOUR: f64 = 0.02;
/// How thick the line of a ring may be, and how large a dot, in widths of the pen.
const THICK: f64 = 2.0;
const DOT: f64 = 4.0;

/// Levels, ready for any number of runs.
#[derive(Clone, Debug)]
pub(crate) struct Levels {
    sheet: Sheet,
}

impl Levels {
    /// Finds the heights; `None` where lines end, meet, or differ, or anything else is drawn.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Self>> {
        let lines = &exemplar.curves;
        if lines.len() < LINES || !exemplar.areas.is_empty() || exemplar.hole.is_some() {
            return Ok(None);
        }
        let is_like =
            |curve: &Curve<2>| curve.style == lines[0].style && (curve.width / lines[0].width - 1.0).abs() < PEN;
        if !lines.iter().all(is_like) {
            return Ok(None);
        }
        let budget = &budget.stage("looking for levels");
        let Some(ends) = LooseEnds::of(exemplar, budget)?.filter(LooseEnds::are_none) else { return Ok(None) };
        let rings: Option<Vec<Vec<Path<2>>>> = exemplar.elements.iter().map(|e| thin_ring(e, &lines[0])).collect();
        let Some(rings) = rings else { return Ok(None) };
        let Some(heights) = Heights::of(exemplar, &rings.concat(), ends.apart, budget)? else { return Ok(None) };
        let Heights { size, step, values } = heights;
        // Heights differ by one from line to line.
        let sheet = Sheet { sources: vec![0], size, step, apart: ends.apart, values, far: 1.0, is_height: true };
        Ok(Some(Self { sheet }))
    }

    /// Fills a domain; `None` for a tile, around which heights would have to close, and where fields bend the lines or something
    /// stays.
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
        let Some((turn, scale, spacing)) = constant(&request.fields) else { return Ok(None) };
        let is_even = (scale / spacing - 1.0).abs() < 1e-9;
        if stays || !is_even || request.border == Border::Turn || matches!(request.domain, Domain::Torus(_)) {
            return Ok(None);
        }
        let budget = &request.budget.stage("drawing levels");
        let bounds = request.domain.bounds();
        let back = |p: Vector<2>| turn.transpose().apply(p) * (1.0 / scale);
        let (low, high) = (bounds.min, bounds.max);
        let corners = [low, Vector::xy(high[0], low[1]), high, Vector::xy(low[0], high[1])];
        let there = Bounds::around(corners.map(back));
        let step = self.sheet.step;
        let size = [0, 1].map(|k| (there.size()[k] / step).round() as usize + 2 * BEYOND + 1);
        let count = size[0].saturating_mul(size[1]);
        budget.within("places of the page", count, ("output-elements", MOST))?;
        let work = count as f64 * PER_PLACE;
        watch.foreseen(&Forecast { count: count as f64, work, allowed: request.budget.allowed() as f64 });
        let made = quilt(&self.sheet, size, false, request.seed, budget)?;
        let first = there.min - Vector::xy(step, step) * BEYOND as f64;
        let place = |p: Vector<2>| turn.apply(first + p * step) * scale;
        let curves = self.lines((exemplar, request), (size, &made.values), (&place, scale), budget)?;
        if curves.is_empty() {
            let advice = "make the domain larger, or lower the scale";
            return Err(Error::no_result("no stroke fits into the domain", advice));
        }
        let count = curves.len();
        let made = Progress { stage: "drawing levels".into(), done: 1, total: 1, fraction: 1.0, energy: None, count };
        let preview = || Snapshot { curves: curves.clone(), ..Snapshot::default() };
        let stopped = match heard(watch.step(&made, &preview), &made) {
            Ok(()) => StopReason::Finished,
            Err(_) => StopReason::Stopped,
        };
        let (placements, sequence, areas, energy, warnings) = Default::default();
        Ok(Some(Outcome { placements, sequence, curves, areas, energy, warnings, stopped }))
    }

    /// The levels of heights, cut at the border of the domain.
    fn lines(
        &self,
        (exemplar, request): (&Exemplar<2>, &Request<2>),
        (size, heights): ([usize; 2], &[f32]),
        (place, scale): (&dyn Fn(Vector<2>) -> Vector<2>, f64),
        budget: &Budget,
    ) -> Result<Vec<Drawn<2>>> {
        let apart = self.sheet.apart;
        let Some(lattice) = Lattice::new(Vector::xy(apart, 0.0), Vector::xy(0.0, apart)) else { return Ok(Vec::new()) };
        let (explains, extent) = (Explains::Everything, Extent::Plane);
        let grid = Grid::flat(&Repeat { lattice, explains, extent, anchor: Anchor::Centre, jitter: 0.0, share: 1.0 });
        let obstacles = obstacles(request)?;
        let ground = Ground { grid: &grid, request, obstacles: obstacles.as_ref() };
        let cut = BorderCut::new(&ground, None);
        let curve = &exemplar.curves[0];
        let mut made = Vec::new();
        let lowest = heights.iter().copied().fold(f32::INFINITY, f32::min).floor() as i64;
        let highest = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max).ceil() as i64;
        for level in lowest..=highest {
            let level = level as f64 + 0.5;
            let values = Values { size, at: &|i, j| f64::from(heights[j * size[0] + i]) - level };
            for ring in rings(&values, budget)? {
                let length: f64 = sides(&ring).map(|(a, b)| (b - a).norm()).sum::<f64>() * self.sheet.step;
                if length < SPECK * apart {
                    continue;
                }
                let path = smooth(&ring.into_iter().map(place).collect::<Vec<_>>());
                let line = Drawn { path, source: 0, scale, frozen: None };
                cut.cut(line, (curve.style, curve.width), budget, &mut made)?;
            }
        }
        Ok(made)
    }
}

/// The line of an element that is a ring drawn with the pen of a curve, such as the top of a hill; nothing for a dot. `None` for anything
/// else.
fn thin_ring(element: &Element<2>, pen: &Curve<2>) -> Option<Vec<Path<2>>> {
    let is_like = element.colour.iter().zip(pen.colour).all(|(a, b)| (a - b).abs() < COLOUR);
    match element.outline.rings.as_slice() {
        _ if !is_like => None,
        [only] => {
            let size = Bounds::around(only.iter().copied()).size();
            (size[0].max(size[1]) < DOT * pen.width).then(Vec::new)
        }
        [a, b] => {
            let (outer, inner) = if ring::area(a).abs() > ring::area(b).abs() { (a, b) } else { (b, a) };
            let nearest =
                |p: &Vector<2>| inner.iter().copied().min_by(|x, y| (*x - *p).norm2().total_cmp(&(*y - *p).norm2()));
            let mut points: Vec<Vector<2>> = outer.iter().filter_map(|p| Some((*p + nearest(p)?) * 0.5)).collect();
            let is_thin = outer.iter().all(|p| nearest(p).is_some_and(|q| (q - *p).norm() < THICK * pen.width));
            points.extend(points.first().copied());
            (is_thin && points.len() > 3).then(|| vec![Path::polyline(&points)])
        }
        _ => None,
    }
}

/// The sides of a ring.
fn sides(ring: &[Vector<2>]) -> impl Iterator<Item = (Vector<2>, Vector<2>)> + '_ {
    ring.iter().copied().zip(ring.iter().copied().cycle().skip(1))
}

/// A smooth line around through the points of a ring.
fn smooth(ring: &Ring<2>) -> Path<2> {
    let n = ring.len();
    let slope = |k: usize| (ring[(k + 1) % n] - ring[(k + n - 1) % n]) * (1.0 / 6.0);
    let cubic = |k: usize| -> Cubic<2> {
        let next = (k + 1) % n;
        [ring[k], ring[k] + slope(k), ring[next] - slope(next), ring[next]]
    };
    Path { cubics: (0..n).map(cubic).collect(), closed: true }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use arabesque_core::{Class, Contents, Unobserved};

    use super::*;

    /// Wavy lines, one over the other, on a page of 100.
    fn grain() -> Exemplar<2> {
        let line = |y: f64| {
            let wave = |x: f64| y + 2.0 * (0.11 * x + 0.07 * y).sin() + 1.5 * (0.05 * x - 0.13 * y).cos();
            let points: Vec<_> = (0..=50).map(|k| 2.0 * f64::from(k)).map(|x| Vector::xy(x, wave(x))).collect();
            Curve { path: Path::polyline(&points), style: 0, width: 1.0, colour: [0.0; 3] }
        };
        let curves = (0..11).map(|k| line(5.0 + 9.0 * f64::from(k))).collect();
        let contents = Contents { curves, styles: vec![Class { name: "a".into() }], ..Contents::default() };
        Exemplar::with_curves("t", contents, page(100.0)).unwrap()
    }

    fn page(side: f64) -> Bounds<2> {
        Bounds::new(Vector::ZERO, Vector::xy(side, side))
    }

    #[test]
    fn levels_have_no_loose_ends() {
        let exemplar = grain();
        let levels = Levels::new(&exemplar, &Budget::default()).unwrap().unwrap();
        for seed in 0..3 {
            let request = Request { seed, ..Request::new(Domain::Box(page(220.0))) };
            let made = levels.fill(&exemplar, &request, &mut Unobserved).unwrap().unwrap();
            assert!(made.curves.len() > 15, "{}", made.curves.len());
            let is_at_side = |p: Vector<2>| page(220.0).signed_distance(p) < 0.5;
            for line in made.curves.iter().filter(|line| !line.path.closed) {
                let ends = [line.path.start().unwrap(), line.path.end().unwrap()];
                assert!(ends.iter().all(|&p| is_at_side(p)), "{ends:?}");
            }
        }
    }

    #[test]
    fn lines_that_meet_or_end_are_no_levels() {
        let mut meets = grain();
        meets.curves[0].path = Path::polyline(&[Vector::xy(50.0, 0.0), Vector::xy(50.0, 100.0)]);
        assert!(Levels::new(&meets, &Budget::default()).unwrap().is_none());
        let mut ends = grain();
        ends.curves[0].path = Path::polyline(&[Vector::xy(0.0, 50.0), Vector::xy(40.0, 50.0)]);
        assert!(Levels::new(&ends, &Budget::default()).unwrap().is_none());
    }
}
