//! What a translation is supported by: the share of marks, and of the length of lines, that it takes to another of
//! their kind.

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Segment, Vector, segment};

use crate::repeat::{
    lines::{AT_FRAME, Lines},
    marks::Marks,
};

/// A share of marks that must have a partner.
const ENOUGH: f64 = 0.95;

/// The same of the length of lines.
const ENOUGH_LINE: f64 = 0.975;

/// Marks that are looked at before a hopeless translation is given up, and the share of them that must have a partner.
const FIRST: (usize, f64) = (24, 0.6);

/// The same of many, which tell nearly what all will: where a part repeats and the rest does not, it takes most of them to others.
const MORE: (usize, f64) = (400, 0.85);

/// Of so many marks, less than a quarter with a partner is hopeless.
const HOPELESS: usize = 8;

/// Places along the lines of an exemplar that are compared.
const PLACES: f64 = 3000.0;

/// Work for each mark, and for each entry of an index that is looked at.
const MARK: u64 = 3;
const LOOK: u64 = 8;

/// Whether a translation takes nearly every mark to one of its kind, within `tolerance`. It tells nothing when fewer
/// marks than `least` should be seen again, as a number and as a share of all.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn is_supported(
    marks: &Marks,
    by: Vector<2>,
    tolerance: f64,
    least: (usize, f64),
    budget: &Budget,
) -> Result<bool> {
    let count = marks.all.len();
    let window = marks.window.grown(1e-6 * marks.window.size().norm());
    let (mut seen, mut found, mut hidden) = ([0_usize; 2], [0_usize; 2], false);
    let mut meter = budget.meter();
    // A stride that shares no factor with the count meets all of them, far apart from one another.
    let stride = (1..).map(|k| (count * 21 / 34).max(1) + k).find(|s| coprime(*s, count)).unwrap_or(1);
    for k in 0..count {
        let mark = &marks.all[k * stride % count];
        meter.spend(MARK)?;
        if mark.is_context {
            continue;
        }
        for way in [by, -by] {
            let there = Bounds::new(mark.extent.min + way, mark.extent.max + way);
            if !(window.contains(there.min) && window.contains(there.max)) {
                continue;
            }
            let group = usize::from(mark.element.is_none());
            let (partner, looked) = marks.find(mark.place + way, mark.kind, tolerance);
            meter.spend(LOOK * (4 + looked))?;
            let is_unknown = || match mark.element {
                Some(_) => marks.unknown.hides(&there),
                None => marks.unknown.contains(mark.place + way),
            };
            if partner.is_none() && is_unknown() {
                hidden |= mark.element.is_some();
                continue;
            }
            seen[group] += 1;
            found[group] += usize::from(partner.is_some());
        }
        let (so_far, met) = (seen[0] + seen[1], found[0] + found[1]);
        let is_poor = [FIRST, MORE].iter().any(|(seen, share)| so_far >= *seen && (met as f64) < share * so_far as f64);
        if is_poor || (so_far >= HOPELESS && 4 * met < so_far) {
            break;
        }
    }
    let least = least.0.max((least.1 * count as f64) as usize);
    let holds = |g: usize| found[g] as f64 >= ENOUGH * seen[g] as f64;
    // Lines alone say nothing of elements whose places are all out of sight.
    let is_told = seen[0] > 0 || !hidden;
    Ok(seen[0] + seen[1] >= 2 * least && is_told && holds(0) && holds(1))
}

fn coprime(a: usize, b: usize) -> bool {
    let (mut a, mut b) = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// Short pieces of all lines, to be asked what is near a place.
pub(crate) struct LineIndex<'a> {
    lines: &'a Lines,
    window: Bounds<2>,
    /// Ends of the pieces, the styles of their lines, and whether these are borders of areas.
    pieces: Vec<(Segment<2>, usize, bool)>,
    index: GridIndex<2>,
    /// Longest piece.
    step: f64,
}

impl<'a> LineIndex<'a> {
    /// Cuts the lines into pieces.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(lines: &'a Lines, window: Bounds<2>, budget: &Budget) -> Result<Self> {
        let length: f64 = lines.tracks.iter().flat_map(|t| t.points.windows(2)).map(|w| (w[1] - w[0]).norm()).sum();
        let step = (length / PLACES).max(1e-4 * window.size().norm());
        let mut pieces = Vec::new();
        for track in &lines.tracks {
            let closing = track.closed.then(|| (track.points.last(), track.points.first()));
            let closing = closing.and_then(|(a, b)| Some((*a?, *b?)));
            for (a, b) in track.points.windows(2).map(|w| (w[0], w[1])).chain(closing).filter(|(a, b)| a != b) {
                let count = ((b - a).norm() / step).ceil().clamp(1.0, 1e5);
                budget.spend(30 * count as u64)?;
                let at = |k: f64| a + (b - a) * (k / count);
                pieces.extend(
                    (0..count as usize).map(|k| ((at(k as f64), at(k as f64 + 1.0)), track.style, track.is_border)),
                );
            }
        }
        let middles: Vec<_> = pieces.iter().map(|((a, b), ..)| (*a + *b) * 0.5).collect();
        let index = GridIndex::new(&middles, step, &Domain::Box(window));
        Ok(Self { lines, window, pieces, index, step })
    }

    /// The frame without what lies along its sides.
    pub(crate) fn seen(&self) -> Bounds<2> {
        self.window.grown(-AT_FRAME * self.window.size().0.into_iter().fold(f64::INFINITY, f64::min))
    }

    /// Whether no line reaches the sides of the frame that lie across an axis, or each that reaches one goes on where another
    /// reaches the other.
    pub(crate) fn are_within_or_go_on(&self, axis: usize) -> bool {
        self.are_within(axis) || self.go_on(axis)
    }

    /// Whether the frame cuts lines at both of these sides at the same places.
    fn go_on(&self, axis: usize) -> bool {
        let near = AT_FRAME * self.window.size()[axis];
        let [low, high] = [self.window.min[axis] + near, self.window.max[axis] - near].map(|c| self.cut_at(axis, c));
        let apart = 2.0 * AT_FRAME * self.window.size()[1 - axis];
        let is_same = |(a, b): (&(usize, f64), &(usize, f64))| a.0 == b.0 && (a.1 - b.1).abs() <= apart;
        !self.lines.tracks.iter().any(|track| track.is_border)
            && low.len() == high.len()
            && low.iter().zip(&high).all(is_same)
    }

    /// Where lines cross a line across an axis, with their styles.
    fn cut_at(&self, axis: usize, at: f64) -> Vec<(usize, f64)> {
        let mut cuts = Vec::new();
        for track in &self.lines.tracks {
            let closing = track.closed.then(|| track.points.last().zip(track.points.first())).flatten();
            for (a, b) in track.points.windows(2).map(|w| (&w[0], &w[1])).chain(closing) {
                if (a[axis] < at) != (b[axis] < at) {
                    let place = *a + (*b - *a) * ((at - a[axis]) / (b[axis] - a[axis]));
                    cuts.push((track.style, place[1 - axis]));
                }
            }
        }
        cuts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        cuts
    }

    /// Whether no line reaches the sides of the frame that lie across an axis.
    fn are_within(&self, axis: usize) -> bool {
        let near = AT_FRAME * self.window.size()[axis];
        let (low, high) = (self.window.min[axis] + near, self.window.max[axis] - near);
        self.lines.tracks.iter().flat_map(|t| &t.points).all(|p| (low..=high).contains(&p[axis]))
    }

    /// Distance of a place from the nearest line of a style that runs about the same way, where there is one within `reach`.
    fn distance(&self, place: Vector<2>, way: Vector<2>, style: usize, reach: f64) -> (Option<f64>, u64) {
        let mut best: Option<f64> = None;
        let looked = self.index.within(place, reach + 0.5 * self.step, |i, _| {
            let (piece, other, is_border) = self.pieces[i];
            let along = (piece.1 - piece.0).unit_or_zero();
            // Along the border of an area, the inside lies on one side.
            let turned = along.dot(way);
            if other == style && (turned > 0.9 || (turned < -0.9 && !is_border)) {
                let apart = segment::distance(piece, place);
                if apart <= reach && best.is_none_or(|b| apart < b) {
                    best = Some(apart);
                }
            }
        });
        (best, looked)
    }

    /// Whether a translation takes nearly all of the lines on to lines of their style.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn supports(&self, by: Vector<2>, tolerance: f64, budget: &Budget) -> Result<bool> {
        if self.lines.is_empty() {
            return Ok(true);
        }
        let stride = (self.pieces.len() as f64 / PLACES).ceil().max(1.0) as usize;
        // What lies along the frame may have been made by it.
        let at_frame = AT_FRAME * self.window.size().0.into_iter().fold(f64::INFINITY, f64::min);
        let (known, seen_in) = (self.window.grown(-at_frame), self.window.grown(-at_frame.max(2.0 * tolerance)));
        let (mut seen, mut found) = (0_usize, 0_usize);
        let mut meter = budget.meter();
        for ((a, b), style, _) in self.pieces.iter().step_by(stride) {
            let (place, way) = ((*a + *b) * 0.5, (*b - *a).unit_or_zero());
            for by in [by, -by] {
                let is_known = known.contains(place) && !self.lines.unknown.is_in_hole(place);
                if !(is_known && seen_in.contains(place + by)) {
                    continue;
                }
                let (near, looked) = self.distance(place + by, way, *style, tolerance);
                meter.spend(LOOK * (8 + looked))?;
                if near.is_none() && self.lines.unknown.contains(place + by) {
                    continue;
                }
                seen += 1;
                found += usize::from(near.is_some());
            }
            if seen >= 60 && (found as f64) < 0.85 * seen as f64 {
                break;
            }
        }
        Ok(seen > 0 && found as f64 >= ENOUGH_LINE * seen as f64)
    }
}
