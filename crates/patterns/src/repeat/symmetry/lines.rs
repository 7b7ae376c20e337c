//! The lines of one cell: what lies on them, and where they pass through a direction.

use arabesque_core::{Bounds, Budget, Exemplar, Matrix, Result, Vector};

use crate::repeat::{
    lattice::Lattice,
    lines::{Feature, Lines, Track},
    symmetry::torus::Torus,
};

/// How far a line may lie off, as a share of the shorter vector.
const TOLERANCE: f64 = 0.012;

/// Lines this near to the frame, as a share of its side, may have been made by it.
const AT_FRAME: f64 = 1e-3;

/// Lines run the same way when the cosine of their angle is above this.
const SAME_WAY: f64 = 0.97;

/// Share of the places on lines that must be taken to lines.
const ENOUGH: f64 = 0.97;

/// Places on lines that are looked at for one operation, and looked at before a hopeless one is given up.
const PLACES: (usize, usize) = (600, 24);

/// A direction that no drawing program prefers: where lines pass through it, they can be recognised.
const AIM: f64 = 0.2371;

/// Work for each entry of an index that is looked at.
const LOOK: u64 = 6;

/// A place on a line: the way it runs there, its style, and whether it is the border of an area, which lies on one side of it.
#[derive(Clone, Copy, Debug)]
struct OnLine {
    way: Vector<2>,
    style: usize,
    is_border: bool,
}

/// The lines of a cell.
pub(super) struct CellLines {
    tracks: Vec<Track>,
    features: Vec<(Vector<2>, Feature)>,
    /// Where lines are not made by the frame.
    seen: Bounds<2>,
    index: Torus<OnLine>,
    places: Vec<(Vector<2>, OnLine)>,
    tolerance: f64,
    step: f64,
}

impl CellLines {
    /// The lines as far as they lie in the frame of the exemplar.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(super) fn new(exemplar: &Exemplar<2>, lattice: Lattice, budget: &Budget) -> Result<Self> {
        let lines = Lines::new(exemplar, budget)?;
        let shorter = lattice.shorter();
        let tolerance = TOLERANCE * shorter;
        let step = tolerance;
        // Along the frame lie the edges that it has cut.
        let seen = exemplar.window.grown(-AT_FRAME * exemplar.view().side());
        let (mut index, mut places) = (Torus::new(lattice, tolerance + step), Vec::new());
        for track in &lines.tracks {
            let closing = track.closed.then(|| (track.points.last(), track.points.first()));
            let closing = closing.and_then(|(a, b)| Some((*a?, *b?)));
            for (a, b) in track.points.windows(2).map(|w| (w[0], w[1])).chain(closing).filter(|(a, b)| a != b) {
                let count = ((b - a).norm() / step).ceil().clamp(1.0, 1e5);
                budget.spend(LOOK * count as u64)?;
                let on = OnLine { way: (b - a).unit_or_zero(), style: track.style, is_border: track.is_border };
                for k in 0..count as usize {
                    let place = a + (b - a) * ((k as f64 + 0.5) / count);
                    if seen.contains(place) {
                        index.insert(place, on);
                        places.push((place, on));
                    }
                }
            }
        }
        Ok(Self { tracks: lines.tracks, features: lines.features, seen, index, places, tolerance, step })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Whether an operation takes nearly all of the lines to lines of their style.
    pub(super) fn admit(&self, linear: &Matrix<2>, shift: Vector<2>, budget: &Budget) -> Result<bool> {
        let (count, mut met, mut looked) = (self.places.len(), 0_usize, 0);
        let stride = count.div_ceil(PLACES.0).max(1);
        let seen = count.div_ceil(stride);
        // Spread over the drawing, so that what does not fit is met early.
        let order = (0..seen).map(|k| k * 377 % seen.max(1) * stride);
        let order: Vec<usize> = if seen.is_multiple_of(13) || seen.is_multiple_of(29) {
            (0..count).step_by(stride).collect()
        } else {
            order.collect()
        };
        let [[a, b], [c, d]] = linear.0;
        // Seen in a mirror, an area lies on the other side of its border.
        let sign = (a * d - b * c).signum();
        for (k, &i) in order.iter().enumerate() {
            let (place, on) = self.places[i];
            let (there, way) = (linear.apply(place) + shift, linear.apply(on.way) * sign);
            let mut found = false;
            looked += self.index.near(there, |offset, other| {
                let across = offset.cross(other.way).abs();
                let is_on = across <= self.tolerance && offset.norm() <= self.tolerance + self.step;
                let along = other.way.dot(way);
                let same_way = along >= SAME_WAY || (along <= -SAME_WAY && !on.is_border);
                found = found || (is_on && other.style == on.style && same_way);
            });
            met += usize::from(found);
            if k + 1 == PLACES.1 && (met as f64) < 0.8 * PLACES.1 as f64 {
                break;
            }
        }
        budget.spend(LOOK * looked)?;
        Ok(met as f64 >= ENOUGH * seen as f64)
    }

    /// Marks on the lines, of the kind that a cell has fewest of, before and after an operation: one of the first must
    /// become one of the second. Nothing where the lines have no marks.
    pub(super) fn anchors(&self, lattice: Lattice, linear: &Matrix<2>) -> Option<(Vector<2>, Vec<Vector<2>>)> {
        let mut best: Option<(Vector<2>, Vec<Vector<2>>)> = None;
        let mut offer = |from: Vec<Vector<2>>, to: Vec<Vector<2>>| {
            let better = best.as_ref().is_none_or(|(_, known)| to.len() < known.len());
            if let (Some(first), true) = (from.first(), better && !to.is_empty()) {
                best = Some((*first, to));
            }
        };
        let mut kinds: Vec<Feature> =
            self.features.iter().map(|(_, kind)| *kind).filter(|k| !matches!(k, Feature::Direction(..))).collect();
        kinds.sort();
        kinds.dedup();
        for kind in kinds {
            let places = self.features.iter().filter(|(_, other)| *other == kind).map(|(place, _)| *place);
            let places = self.folded(places, lattice);
            offer(places.clone(), places);
        }
        let aim = Vector::xy(AIM.cos(), AIM.sin());
        let mut styles: Vec<usize> = self.tracks.iter().map(|t| t.style).collect();
        styles.sort_unstable();
        styles.dedup();
        for style in styles {
            let passing = |aim: Vector<2>| -> Vec<Vector<2>> {
                let tracks = self.tracks.iter().filter(|t| t.style == style);
                let passes = tracks.flat_map(|t| passes(t, aim));
                self.folded(passes.filter(|place| self.seen.contains(*place)), lattice)
            };
            let from = passing(aim);
            let to = if from.is_empty() { Vec::new() } else { passing(linear.apply(aim)) };
            offer(from, to);
        }
        best
    }

    /// Places that differ by more than a node of the lattice.
    fn folded(&self, places: impl Iterator<Item = Vector<2>>, lattice: Lattice) -> Vec<Vector<2>> {
        let within = 0.5 * self.tolerance;
        let (mut known, mut kept) = (Torus::new(lattice, within), Vec::new());
        for place in places {
            if !known.has(place, within, |()| true).0 {
                known.insert(place, ());
                kept.push(place);
            }
        }
        kept
    }
}

/// Where a line passes through a direction or its opposite; on a corner, the corner.
fn passes(track: &Track, aim: Vector<2>) -> Vec<Vector<2>> {
    let mut points = track.points.clone();
    points.dedup();
    if let (true, Some(&first)) = (track.closed, points.first()) {
        if points.last() != Some(&first) {
            points.push(first);
        }
        points.extend(points.get(1).copied());
    }
    let mut found = Vec::new();
    for w in points.windows(3) {
        let (u, v) = ((w[1] - w[0]).unit_or_zero(), (w[2] - w[1]).unit_or_zero());
        let (before, after) = (u.cross(aim), v.cross(aim));
        if (before > 0.0) == (after > 0.0) || u.dot(v) < -0.999 {
            continue;
        }
        // Between the middles of two chords the line turns evenly.
        let share = before / (before - after);
        let is_corner = u.cross(v).abs() > 0.25 || u.dot(v) < 0.0;
        let place = if is_corner {
            w[1]
        } else if share < 0.5 {
            w[0] + (w[1] - w[0]) * (0.5 + share)
        } else {
            w[1] + (w[2] - w[1]) * (share - 0.5)
        };
        found.push(place);
    }
    found
}
