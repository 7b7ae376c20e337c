//! How far the exemplar is from where it looks like itself again.

use arabesque_core::{Budget, Result, Vector};

use super::{field::Field, pattern::Pattern};
use crate::each::each;

/// Points that are looked at.
const POINTS: usize = 500;
/// Share of the exemplar's length up to which lags are looked at.
const FARTHEST: f64 = 0.48;
/// Most shifts that are kept, not counting their opposites.
const SHIFTS: usize = 12;
/// A peak counts that rises at least so far towards the highest one.
const RISE: f64 = 0.7;

/// Steps of the grid within which of the border a field lacks what is beyond.
const RIM: f64 = 2.5;
/// How often peaks are looked at more closely.
const REFINEMENTS: usize = 7;

/// Shifts of the exemplar that lay it well upon itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct Repetition<const D: usize> {
    /// Length of the shortest of them; `None` where there is none.
    pub(crate) length: Option<f64>,
    /// How far the best of them is from any shift, towards one that changes nothing: 0 to 1.
    pub(crate) strength: f64,
    /// The best of them, each with its opposite, best first.
    pub(crate) shifts: Vec<Vector<D>>,
}

/// The exemplar and a copy of it that is shifted.
struct Overlay<'a, const D: usize> {
    pattern: &'a Pattern<D>,
    field: &'a Field<D>,
    /// Nearer to the border than this the field lacks what is beyond.
    rim: f64,
    /// The field at each point, from itself.
    own: Vec<f32>,
    stride: usize,
}

impl<'a, const D: usize> Overlay<'a, D> {
    fn new(pattern: &'a Pattern<D>, field: &'a Field<D>, rim: f64) -> Self {
        let places = pattern.points.positions.iter().zip(&pattern.weights);
        let own = places.map(|(p, w)| field.project(&p.0.map(|x| x as f32), w)).collect();
        Self { pattern, field, rim, own, stride: (pattern.points.len() / POINTS).max(1) }
    }

    /// How well the copy lies upon the exemplar where both are known: 1 for the same.
    fn likeness(&self, shift: Vector<D>) -> f64 {
        let (pattern, rim) = (self.pattern, self.rim);
        let inside = |p: &Vector<D>| {
            (0..D)
                .all(|k| !pattern.base[k] || p[k] >= pattern.bounds.min[k] + rim && p[k] <= pattern.bounds.max[k] - rim)
        };
        let (mut same, mut all) = (0.0, 1e-12);
        for i in (0..pattern.points.len()).step_by(self.stride) {
            let (from, to) = (pattern.points.positions[i], pattern.points.positions[i] + shift);
            if inside(&from) && inside(&to) {
                same += f64::from(self.field.project(&to.0.map(|x| x as f32), &pattern.weights[i]));
                all += f64::from(self.own[i]);
            }
        }
        same / all
    }

    /// The best shift near one, looked for along each coordinate of the base, closer and closer.
    fn refined(&self, mut shift: Vector<D>, mut step: f64) -> (f64, Vector<D>) {
        let mut best = self.likeness(shift);
        for _ in 0..REFINEMENTS {
            for k in (0..D).filter(|&k| self.pattern.base[k]) {
                for sign in [-1.0, 1.0] {
                    let mut to = shift;
                    to[k] += sign * step;
                    let likeness = self.likeness(to);
                    if likeness > best {
                        (best, shift) = (likeness, to);
                    }
                }
            }
            step *= 0.6;
        }
        (best, shift)
    }
}

/// Shifts along the base on a grid.
struct Lags<const D: usize> {
    half: [usize; D],
    wide: [usize; D],
    base: [bool; D],
}

impl<const D: usize> Lags<D> {
    fn new(pattern: &Pattern<D>, step: f64) -> Self {
        let size = pattern.bounds.size();
        let half = std::array::from_fn(|k| if pattern.base[k] { (FARTHEST * size[k] / step) as usize } else { 0 });
        Self { half, wide: half.map(|h: usize| 2 * h + 1), base: pattern.base }
    }

    fn count(&self) -> usize {
        self.wide.iter().product()
    }

    /// Lag `index` in steps.
    fn at(&self, index: usize) -> [isize; D] {
        let mut rest = index;
        std::array::from_fn(|k| {
            let at = rest % self.wide[k];
            rest /= self.wide[k];
            at as isize - self.half[k] as isize
        })
    }

    /// Whether no lag around it is more alike. `alike` has the first half, the other one is the same mirrored.
    fn is_peak(&self, index: usize, alike: &[f64]) -> bool {
        let here = self.at(index);
        if (0..D).any(|k| self.base[k] && here[k].unsigned_abs() >= self.half[k]) {
            return false;
        }
        let value = |index: usize| alike[index.min(self.count() - 1 - index)];
        (0..3_usize.pow(D as u32)).all(|n| {
            let (mut rest, mut to, mut stride) = (n, index as isize, 1);
            for k in 0..D {
                let off = (rest % 3) as isize - 1;
                rest /= 3;
                if !self.base[k] && off != 0 {
                    return true;
                }
                to += off * stride;
                stride *= self.wide[k] as isize;
            }
            value(to as usize) <= alike[index]
        })
    }
}

/// Looks for shifts that lay the exemplar well upon itself.
///
/// What overlaps is compared for shifts on a grid along the base. Peaks are higher than all shifts around them, and are looked at more closely.
pub(crate) fn repetition<const D: usize>(
    pattern: &Pattern<D>,
    field: &Field<D>,
    step: f64,
    budget: &Budget,
) -> Result<Repetition<D>> {
    let shortest = pattern.sides().fold(f64::INFINITY, f64::min);
    let lags = Lags::new(pattern, step);
    let overlay = Overlay::new(pattern, field, (RIM * step).min(0.1 * shortest));
    let shift = |index: usize| Vector(lags.at(index).map(|n| n as f64 * step));
    let cost = (pattern.points.len() / overlay.stride * 80) as u64;
    let alike = each(lags.count() / 2 + 1, budget, |_| cost, |index| overlay.likeness(shift(index)))?;
    let far = |index: &usize| shift(*index).norm() > 2.5 * pattern.spacing;
    let mut peaks: Vec<usize> =
        (0..lags.count() / 2).filter(far).filter(|&index| lags.is_peak(index, &alike)).collect();
    let best = peaks.iter().map(|&p| alike[p]).fold(0.0, f64::max);
    let mean = alike.iter().sum::<f64>() / alike.len() as f64;
    peaks.retain(|&p| alike[p] >= mean + RISE * (best - mean));
    let near = peaks.iter().copied().min_by(|&a, &b| shift(a).norm().total_cmp(&shift(b).norm()));
    let length = near.map(|p| overlay.refined(shift(p), 0.5 * step).1.norm());
    peaks.sort_by(|&a, &b| alike[b].total_cmp(&alike[a]).then(shift(a).norm().total_cmp(&shift(b).norm())));
    peaks.truncate(SHIFTS);
    let shifts = peaks.into_iter().map(|p| overlay.refined(shift(p), 0.5 * step).1).flat_map(|s| [s, -s]).collect();
    let strength = if best > 0.0 { ((best - mean) / (1.0 - mean).max(0.05)).clamp(0.0, 1.0) } else { 0.0 };
    Ok(Repetition { length, strength, shifts })
}
