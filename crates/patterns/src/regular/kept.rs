//! Strokes that stay: whether they lie where the lattice has strokes, and how the new ones join them.

use arabesque_core::{Budget, Domain, Drawn, Exemplar, GridIndex, Measured, Path, Request, Result, Vector, straight};

use crate::regular::{grid::Grid, joints::Cell};

/// A place on a stroke that stays lies on one of the lattice when it is no farther from it than this share of the
/// shorter vector.
const ON: f64 = 0.04;

/// Share of such places that must.
const MOST: f64 = 0.9;

/// A new stroke is led to the end of one that stays when that is no farther than this share of the shorter vector, and
/// gives way over such a length.
const JOIN: (f64, f64) = (0.08, 0.5);

/// Strokes meet in a corner where the cosine of the angle between their directions is less than this.
const STRAIGHT: f64 = 0.99;

/// Places are this share of the shorter vector apart.
const STEP: f64 = 0.02;

/// Places along all strokes that stay, at most.
const PLACES: usize = 2_000_000;

/// Work for each place.
const PLACE: u64 = 60;

/// A place on a stroke: its style, and which way it runs there.
type Mark = (usize, Vector<2>);

/// Places along strokes.
struct Places {
    marks: Vec<Mark>,
    index: GridIndex<2>,
}

impl Places {
    fn new(places: &[(Vector<2>, Mark)], cell: f64) -> Self {
        let points: Vec<Vector<2>> = places.iter().map(|(p, _)| *p).collect();
        let around = arabesque_core::Bounds::around(points.iter().copied()).grown(cell);
        let index = GridIndex::new(&points, cell, &Domain::Box(around));
        Self { marks: places.iter().map(|(_, mark)| *mark).collect(), index }
    }

    /// Whether a stroke of this style that runs about this way, or the opposite one, lies within `reach` of a place.
    fn has(&self, p: Vector<2>, (style, way): Mark, reach: f64) -> bool {
        let mut met = false;
        self.index.within(p, reach, |k, _| {
            let (other, along) = self.marks[k];
            met = met || (other == style && along.dot(way).abs() > 0.8);
        });
        met
    }
}

/// The strokes that stay.
pub(crate) struct Kept {
    places: Places,
    /// Their ends, the styles of these, and the directions into the strokes.
    ends: Vec<(Vector<2>, usize, Vector<2>)>,
    unit: f64,
    /// Whether they lie around a region alone.
    are_around: bool,
}

impl Kept {
    /// The strokes that stay, as far as they are near the domain; `None` where there are none. `unit`: the shorter vector
    /// in the output.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(request: &Request<2>, exemplar: &Exemplar<2>, unit: f64) -> Result<Option<Self>> {
        if request.frozen_curves.is_empty() {
            return Ok(None);
        }
        let budget = request.budget.stage("looking at what is kept");
        let near = request.domain.bounds().grown(unit);
        let (mut places, mut ends) = (Vec::new(), Vec::new());
        for drawn in &request.frozen_curves {
            let style = exemplar.curves[drawn.source].style;
            let along = along(&drawn.path, unit, &budget)?;
            places.extend(along.into_iter().filter(|(p, _)| near.contains(*p)).map(|(p, way)| (p, (style, way))));
            budget.within("places along kept strokes", places.len(), ("places", PLACES))?;
            if !drawn.path.closed {
                let both = [tip(&drawn.path), tip(&drawn.path.reversed())].into_iter().flatten();
                ends.extend(both.filter(|(p, _)| near.contains(*p)).map(|(p, way)| (p, style, way)));
            }
        }
        let are_around = request.known.is_some();
        Ok(Some(Self { places: Places::new(&places, ON * unit), ends, unit, are_around }))
    }

    /// Whether the strokes that stay in the domain lie where the lattice has some of their style.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn lies_on(request: &Request<2>, exemplar: &Exemplar<2>, cell: &Cell, grid: &Grid) -> Result<bool> {
        let budget = request.budget.stage("looking at what is kept");
        let unit = grid.lattice.shorter();
        let mut places = Vec::new();
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [i, j]));
        for node in around {
            for part in &cell.parts {
                let style = exemplar.curves[part.curve].style;
                let path = part.path.map(|p| grid.place(p, node));
                places.extend(along(&path, unit, &budget)?.into_iter().map(|(p, way)| (p, (style, way))));
            }
        }
        let lattice = Places::new(&places, ON * unit);
        let origin = grid.place(cell.origin, [0, 0]);
        let (mut seen, mut met) = (0_usize, 0_usize);
        for drawn in &request.frozen_curves {
            let style = exemplar.curves[drawn.source].style;
            for (p, way) in along(&drawn.path, unit, &budget)? {
                if request.domain.signed_distance(p) < -unit {
                    continue;
                }
                seen += 1;
                let inside = origin + grid.lattice.folded(p - origin);
                met += usize::from(lattice.has(inside, (style, way), ON * unit + STEP * unit));
            }
        }
        Ok(met as f64 >= MOST * seen as f64)
    }

    /// Whether one of the strokes that stay runs here, in this style and about this way.
    pub(crate) fn covers(&self, p: Vector<2>, way: Vector<2>, style: usize) -> bool {
        self.places.has(p, (style, way), ON * self.unit)
    }

    /// Whether one of the strokes that stay runs here in this style, whichever way.
    pub(crate) fn has_any(&self, p: Vector<2>, style: usize) -> bool {
        let mut met = false;
        self.places.index.within(p, ON * self.unit, |k, _| met = met || self.places.marks[k].0 == style);
        met
    }

    /// The path with its ends led to those of strokes that stay. Where it meets one in a corner, it goes on around that
    /// for half of its width, so that the corner is whole.
    pub(crate) fn joined(&self, path: Path<2>, (style, width): (usize, f64)) -> Path<2> {
        if path.closed {
            return path;
        }
        let one = self.joined_at_start(path, (style, width)).reversed();
        self.joined_at_start(one, (style, width)).reversed()
    }

    /// The way to the nearest place on strokes of a style that stay, where one is as near as those that new ones end at.
    fn nearest(&self, p: Vector<2>, style: usize) -> Option<Vector<2>> {
        let mut best: Option<Vector<2>> = None;
        self.places.index.within(p, 1.5 * ON * self.unit, |k, offset| {
            if self.places.marks[k].0 == style && best.is_none_or(|b| offset.norm2() < b.norm2()) {
                best = Some(offset);
            }
        });
        best
    }

    fn joined_at_start(&self, mut path: Path<2>, (style, width): (usize, f64)) -> Path<2> {
        let Some((start, way)) = tip(&path) else { return path };
        let near = self.ends.iter().filter(|(_, other, _)| *other == style).map(|(p, _, into)| (*p - start, *into));
        let nearest = near.min_by(|a, b| a.0.norm2().total_cmp(&b.0.norm2()));
        let Some((by, into)) = nearest.filter(|(by, _)| by.norm() <= JOIN.0 * self.unit) else {
            if let Some(by) = self.nearest(start, style).filter(|_| !self.are_around) {
                lead(&mut path, by, JOIN.1 * self.unit);
            }
            return path;
        };
        if by.norm() > 0.0 {
            lead(&mut path, by, JOIN.1 * self.unit);
        }
        if into.dot(way) > -STRAIGHT {
            path.cubics.insert(0, straight(start + by + into * (0.5 * width), start + by));
        }
        path
    }
}

/// The start of a path, and the direction into it.
fn tip(path: &Path<2>) -> Option<(Vector<2>, Vector<2>)> {
    let c = path.cubics.first()?;
    let way = c[1..].iter().map(|p| *p - c[0]).find(|w| w.norm2() > 0.0)?;
    Some((c[0], way.unit_or_zero()))
}

/// Moves the start of a path; what comes after it gives way less and less over a length.
pub(crate) fn lead(path: &mut Path<2>, by: Vector<2>, over: f64) {
    let length: f64 = path.cubics.iter().flat_map(|c| c.windows(2)).map(|w| (w[1] - w[0]).norm()).sum();
    let over = over.min(0.5 * length).max(f64::MIN_POSITIVE);
    let mut from_start = 0.0;
    for cubic in &mut path.cubics {
        let old = *cubic;
        for k in 0..4 {
            if k > 0 {
                from_start += (old[k] - old[k - 1]).norm();
            }
            let left = (1.0 - from_start / over).max(0.0);
            cubic[k] += by * (left * left * (3.0 - 2.0 * left));
        }
        if from_start > over {
            break;
        }
    }
}

/// Places along a path with the directions there.
fn along(path: &Path<2>, unit: f64, budget: &Budget) -> Result<Vec<(Vector<2>, Vector<2>)>> {
    let measured = Measured::new(path.clone(), 0.1 * STEP * unit);
    let count = (measured.length() / (STEP * unit)).ceil().clamp(1.0, 1e5) as usize;
    budget.spend(PLACE * (count + path.cubics.len()) as u64)?;
    let at = |k: f64| measured.point(measured.length() * k / count as f64);
    let one = |k: usize| (at(k as f64 + 0.5), (at(k as f64 + 1.0) - at(k as f64)).unit_or_zero());
    Ok((0..count).map(one).collect())
}

/// Whether most of a stroke runs along one that stays.
pub(crate) fn is_covered(kept: &Kept, drawn: &Drawn<2>, style: usize) -> bool {
    let length = Measured::new(drawn.path.clone(), 0.1 * STEP * kept.unit);
    let at = |share: f64| length.point(share * length.length());
    let shares = [0.1, 0.3, 0.5, 0.7, 0.9];
    // A shorter one is near its own ends all along, where strokes that stay go on.
    length.length() > 4.0 * ON * kept.unit
        && shares.iter().all(|&s| kept.covers(at(s), (at(s + 0.01) - at(s - 0.01)).unit_or_zero(), style))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::*;

    #[test]
    fn only_the_end_of_a_path_that_is_led_somewhere_moves() {
        let points: Vec<_> = (0..11).map(|k| Vector::xy(f64::from(k), 0.0)).collect();
        let mut path = Path::polyline(&points);
        lead(&mut path, Vector::xy(0.0, 0.3), 4.0);
        assert_eq!(path.start().unwrap(), Vector::xy(0.0, 0.3));
        assert_eq!(path.end().unwrap(), Vector::xy(10.0, 0.0));
        assert!(path.cubics.windows(2).all(|w| w[0][3] == w[1][0]), "it stays whole");
        assert!(path.cubics[6..].iter().flatten().all(|p| p[1] == 0.0));
    }
}
