//! What can be recognised on lines: ends, crossings of straight stretches, and the places where a line passes through
//! one of a few directions, which on a smooth line are points and on a corner the corner.

use std::{collections::BTreeMap, sync::Arc};

use arabesque_core::{Bounds, Budget, Exemplar, Result, Segment, Vector, segment};

use crate::repeat::unknown::Unknown;

/// Directions that lines are looked at for: half a turn is divided evenly, from a start that no drawing program prefers.
const DIRECTIONS: usize = 8;
const FIRST: f64 = 0.1426;

/// A turn sharper than this many radians is a corner.
const CORNER: f64 = 0.26;

/// Lines are flattened to this share of the side of the frame.
const FLAT: f64 = 5e-5;

/// Features nearer to the frame than this share of its side may have been made by it.
pub(crate) const AT_FRAME: f64 = 1e-3;

/// More features than this tell no more.
const MOST: usize = 60_000;

/// Straight stretches are looked at for crossings when they are longer than this share of the side of the frame, and
/// when there are no more of them than this.
const STRETCH: (f64, usize) = (0.04, 2000);

/// Crossings of one kind that are nearer than this share of the side of the frame are one: as coordinates are rounded at worst.
const SAME: f64 = 4e-4;

/// Stretches that cross at a smaller angle than this, by its sine, cross nowhere in particular.
const SLANT: f64 = 0.1;

/// Work for each point of a line, and for two stretches that are compared.
const WORK: (u64, u64) = (60, 3);

/// What a feature is: features of one kind may be the same one seen again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Feature {
    /// A line of this style ends.
    End(usize),
    /// A line of this style passes through a direction, bending to one side of it; the border of an area also tells whether
    /// that is the side of its inside.
    Direction(usize, usize, bool, Option<bool>),
    /// Straight stretches of these styles cross.
    Crossing(usize, usize),
}

/// A line as it is compared: points, whether it is closed, its style.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub(crate) points: Vec<Vector<2>>,
    pub(crate) closed: bool,
    pub(crate) style: usize,
    /// Whether it is the border of an area, which lies on one side of it all along.
    pub(crate) is_border: bool,
}

/// The lines of an exemplar: strokes, and the borders of areas.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    pub(crate) tracks: Vec<Track>,
    pub(crate) features: Vec<(Vector<2>, Feature)>,
    /// Straight stretches, with their styles.
    pub(crate) stretches: Vec<(Segment<2>, usize)>,
    /// Where lines may be that are not seen.
    pub(crate) unknown: Arc<Unknown>,
}

impl Lines {
    /// The lines of an exemplar.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Self> {
        let window = exemplar.window;
        let side = exemplar.view().side();
        let mut tracks = Vec::new();
        for curve in &exemplar.curves {
            let points = curve.path.flatten(FLAT * side);
            budget.spend(WORK.0 * points.len() as u64)?;
            tracks.push(Track { points, closed: curve.path.closed, style: curve.style, is_border: false });
        }
        for area in &exemplar.areas {
            for ring in &area.outline.rings {
                budget.spend(WORK.0 * ring.len() as u64)?;
                tracks.push(Track { points: ring.clone(), closed: true, style: area.style, is_border: true });
            }
        }
        let mut lines =
            Self { tracks, features: Vec::new(), stretches: Vec::new(), unknown: Arc::new(Unknown::of(exemplar)) };
        let seen = window.grown(-AT_FRAME * side);
        for k in 0..lines.tracks.len() {
            let track = &lines.tracks[k];
            budget.spend(WORK.0 * track.points.len() as u64)?;
            features(track, &mut lines.features);
            stretches(track, STRETCH.0 * side, &window, &mut lines.stretches);
            if lines.features.len() > MOST {
                break;
            }
        }
        if lines.stretches.len() <= STRETCH.1 {
            budget.spend(WORK.1 * (lines.stretches.len() as u64).pow(2))?;
            let found = crossings(&lines.stretches);
            budget.spend(WORK.0 * found.len() as u64)?;
            lines.features.extend(merged(found, SAME * side));
        }
        lines.features.retain(|(place, _)| seen.contains(*place) && !exemplar.hole.is_some_and(|h| h.contains(*place)));
        lines.features.truncate(MOST);
        Ok(lines)
    }

    /// Whether there is no line.
    pub(crate) fn is_empty(&self) -> bool {
        self.tracks.is_empty()
    }
}

/// Steps of a track that have a length, around the back on a closed one.
fn steps(track: &Track) -> Vec<(Vector<2>, Vector<2>)> {
    let mut steps: Vec<_> = track.points.windows(2).map(|w| (w[0], w[1])).filter(|(a, b)| a != b).collect();
    if let (true, Some(&first), Some(&last)) = (track.closed, track.points.first(), track.points.last())
        && first != last
    {
        steps.push((last, first));
    }
    steps
}

fn features(track: &Track, into: &mut Vec<(Vector<2>, Feature)>) {
    let steps = steps(track);
    let (Some(first), Some(last)) = (steps.first(), steps.last()) else { return };
    if !track.closed {
        into.push((first.0, Feature::End(track.style)));
        into.push((last.1, Feature::End(track.style)));
    }
    let count = steps.len();
    let turns = if track.closed { count } else { count - 1 };
    for k in 0..turns {
        let (before, after) = (steps[k], steps[(k + 1) % count]);
        let (u, v) = ((before.1 - before.0).unit_or_zero(), (after.1 - after.0).unit_or_zero());
        let turn = u.angle_to(v);
        let heading = u[1].atan2(u[0]);
        for direction in 0..DIRECTIONS {
            let aim = FIRST + std::f64::consts::PI * direction as f64 / DIRECTIONS as f64;
            // The angle from the heading to the direction or its opposite, whichever lies on the way.
            let way = (aim - heading).rem_euclid(std::f64::consts::PI);
            let way = if turn < 0.0 { way - std::f64::consts::PI } else { way };
            if (turn >= 0.0 && way >= turn) || (turn < 0.0 && way <= turn) {
                continue;
            }
            let place = if turn.abs() > CORNER {
                before.1
            } else {
                let (from, to) = ((before.0 + before.1) * 0.5, (after.0 + after.1) * 0.5);
                let share = way / turn;
                let bend = from + (to - from) * share;
                // Between the middles of two chords the line runs through their common point.
                bend + (before.1 - (from + to) * 0.5) * (2.0 * share.min(1.0 - share))
            };
            let normal = Vector::xy(-aim.sin(), aim.cos());
            let inside = track.is_border.then_some(turn > 0.0);
            into.push((place, Feature::Direction(track.style, direction, (v - u).dot(normal) > 0.0, inside)));
        }
    }
}

/// Collects straight stretches that are long enough, whatever points lie on them.
fn stretches(track: &Track, least: f64, window: &Bounds<2>, into: &mut Vec<(Segment<2>, usize)>) {
    let mut current: Option<Segment<2>> = None;
    let mut close = |stretch: Segment<2>| {
        let is_seen = Bounds::around([stretch.0, stretch.1]).intersects(window);
        if is_seen && (stretch.1 - stretch.0).norm() >= least {
            into.push((stretch, track.style));
        }
    };
    for (a, b) in steps(track) {
        current = match current {
            Some((start, end)) if (end - start).unit_or_zero().cross((b - a).unit_or_zero()).abs() < 1e-4 => {
                Some((start, b))
            }
            other => {
                other.into_iter().for_each(&mut close);
                Some((a, b))
            }
        };
    }
    current.into_iter().for_each(close);
}

fn crossings(stretches: &[(Segment<2>, usize)]) -> Vec<(Vector<2>, Feature)> {
    let mut found = Vec::new();
    for (k, &(a, style)) in stretches.iter().enumerate() {
        let way = (a.1 - a.0).unit_or_zero();
        for &(b, other) in &stretches[k + 1..] {
            if way.cross((b.1 - b.0).unit_or_zero()).abs() < SLANT {
                continue;
            }
            if let Some([s, t]) = segment::crossing(a, b)
                && (0.0..=1.0).contains(&s)
                && (0.0..=1.0).contains(&t)
            {
                let styles = (style.min(other), style.max(other));
                found.push((a.0 + (a.1 - a.0) * s, Feature::Crossing(styles.0, styles.1)));
                if found.len() > 2 * MOST {
                    return found;
                }
            }
        }
    }
    found
}

/// Features with those of one kind that lie within a distance of the first of them as one, at their mean: where three lines meet, as on
/// isometric paper, each pair of them crosses, and rounding tells these crossings apart.
fn merged(features: Vec<(Vector<2>, Feature)>, within: f64) -> Vec<(Vector<2>, Feature)> {
    let mut known: BTreeMap<(Feature, [i64; 2]), Vec<usize>> = BTreeMap::new();
    // The first of those that are one, the sum of their places, and how many they are.
    let mut all: Vec<(Vector<2>, Feature, Vector<2>, f64)> = Vec::new();
    for (place, feature) in features {
        let [x, y] = place.0.map(|c| (c / within).floor() as i64);
        let around = (0..9).flat_map(|k| known.get(&(feature, [x + k % 3 - 1, y + k / 3 - 1])).into_iter().flatten());
        match around.copied().find(|&n| (all[n].0 - place).norm() <= within) {
            Some(n) => (all[n].2, all[n].3) = (all[n].2 + place, all[n].3 + 1.0),
            None => {
                known.entry((feature, [x, y])).or_default().push(all.len());
                all.push((place, feature, place, 1.0));
            }
        }
    }
    all.into_iter().map(|(_, feature, sum, count)| (sum * (1.0 / count), feature)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_meet_in_threes_cross_once() {
        let at = |x: f64, y: f64| Vector::xy(x, y);
        let stretches = [
            ((at(-10.0, 0.001), at(10.0, 0.001)), 0),
            ((at(-10.0, -10.0), at(10.0, 10.0)), 0),
            ((at(-10.0, 10.002), at(10.0, -9.998)), 0),
            ((at(5.0, -10.0), at(5.0, 10.0)), 1),
        ];
        let found = crossings(&stretches);
        assert_eq!(found.len(), 6);
        let once = merged(found, 0.01);
        let of = |a: usize, b: usize| once.iter().filter(|(_, f)| *f == Feature::Crossing(a, b)).count();
        assert_eq!((of(0, 0), of(0, 1)), (1, 3), "and the upright one, in another colour, crosses each by itself");
        assert!(once[0].0.norm() < 0.002, "{:?}", once[0]);
    }
}
