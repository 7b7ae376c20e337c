//! How far the texture is from where it looks like itself again, by the autocorrelation of its field.

use arabesque_core::{Budget, Result};

use crate::{
    search::field::Field,
    texture::{likeness::Likeness, repeat::Repeat},
};

/// Columns along the longer side that are compared at most: first few, of which what is small next to a repetition is no part, then more.
const COLUMNS: [usize; 2] = [48, 128];
/// A repetition of fewer columns is looked for among more of them.
const FINE: f64 = 8.0;
/// A shift at which the field differs by less than this share of what is usual is a repetition.
const ALIKE: f64 = 0.72;
/// Repetitions that are worse than the best by less than this factor are as good.
const AS_GOOD: f64 = 1.35;
/// Shifts that are worse than the best by no more may belong to its lattice.
const SPREAD: f64 = 0.2;
/// What repeats less strongly has no lattice that is worth a closer look.
const STRICT: f64 = 0.5;
/// On the way to a repetition the field differs by so much more, as a share of what is usual.
const BETWEEN: f64 = 0.25;
/// Shortest repetition, in columns that are compared.
const SHORTEST: f64 = 4.0;

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Repetition {
    /// In cells; `None` where the texture does not repeat.
    pub(crate) length: Option<f64>,
    /// How well the field agrees with itself there: 0 to 1.
    pub(crate) strength: f64,
    /// The two shifts that carry the whole texture into itself, if it repeats so strictly.
    pub(crate) repeat: Option<Repeat>,
}

/// Textures that repeat no more strongly than the first of these leave the usual choice of patches; those that repeat as strongly as the second leave
/// none but what fits best.
const LATITUDE: (f64, f64) = (0.7, 0.8);

impl Repetition {
    /// How much worse than the best a patch may be, from 0 for what repeats strictly to 1 for what does not.
    pub(crate) fn latitude(&self) -> f64 {
        ((LATITUDE.1 - self.strength) / (LATITUDE.1 - LATITUDE.0)).clamp(0.0, 1.0)
    }
}

/// A shift at which the field is more like itself than at those around.
#[derive(Clone, Copy, Debug)]
struct Minimum {
    shift: [i64; 2],
    /// Length of the shift in columns that are compared.
    length: f64,
    /// Difference as a share of what is usual.
    difference: f64,
}

/// The shortest of the shifts at which the field is most like itself, and those that carry it into itself.
pub(crate) fn repetition(field: &Field, budget: &Budget) -> Result<Repetition> {
    let mut found = Repetition { length: None, strength: 0.0, repeat: None };
    let smooth = field.smoothed(budget)?;
    for columns in COLUMNS {
        let Some(likeness) = Likeness::new(&smooth, columns, budget)? else { break };
        let smoothed = minima(&likeness);
        let all = if columns == COLUMNS[0] {
            Likeness::new(field, columns, budget)?.map_or_else(Vec::new, |likeness| minima(&likeness))
        } else {
            smoothed.clone()
        };
        let scale = likeness.skip as f64;
        let (best, shortest) = shortest(&all);
        let strength = (1.0 - best).clamp(0.0, 1.0);
        let repeats = best <= ALIKE;
        if found.length.is_none() && (repeats || strength > found.strength) {
            found = Repetition { length: repeats.then_some(shortest * scale), strength, ..found };
        }
        if found.repeat.is_none() {
            found.repeat = Repeat::find(&smooth, &surest(smoothed, scale), scale, budget)?;
        }
        let is_clear = shortest >= FINE && (found.repeat.is_some() || strength < STRICT);
        if likeness.skip == 1 || repeats && is_clear {
            break;
        }
    }
    Ok(found)
}

/// The least difference, and the length of the shortest shift at which it is about as small.
fn shortest(minima: &[Minimum]) -> (f64, f64) {
    let best = minima.iter().map(|m| m.difference).fold(f64::INFINITY, f64::min);
    let most = (AS_GOOD * best).max(best + 0.1).min(ALIKE);
    let as_good = minima.iter().filter(|m| m.difference <= most);
    (best, as_good.map(|m| m.length).fold(f64::INFINITY, f64::min))
}

/// Shifts that may belong to a lattice, in cells, the surest first.
fn surest(mut minima: Vec<Minimum>, scale: f64) -> Vec<[f64; 2]> {
    let best = minima.iter().map(|m| m.difference).fold(f64::INFINITY, f64::min);
    minima.retain(|m| m.difference <= (best + SPREAD).min(ALIKE));
    minima.sort_by(|a, b| a.difference.total_cmp(&b.difference));
    minima.iter().map(|m| m.shift.map(|v| v as f64 * scale)).collect()
}

/// Shifts that may be repetitions.
fn minima(likeness: &Likeness) -> Vec<Minimum> {
    let usual = likeness.usual();
    // What looks alike all the way, as waves do along their crests, does not repeat there.
    let differs_between = |[x, y]: [i64; 2], own: f64| {
        let steps = 2 * x.abs().max(y);
        let part = |k: i64| likeness.at([x, y].map(|v| (v as f64 * k as f64 / steps as f64).round() as i64));
        (1..steps).any(|k| part(k) > own + BETWEEN * usual)
    };
    let is_least = |[x, y]: [i64; 2]| {
        let own = likeness.at([x, y]);
        let is_inner = x.abs() < likeness.most[0] && y < likeness.most[1];
        is_inner
            && (-1..=1).all(|dy| (-1..=1).all(|dx| likeness.at([x + dx, y + dy]) >= own))
            && differs_between([x, y], own)
    };
    let minimum = |shift: [i64; 2]| {
        let length = shift.map(|v| v as f64).iter().fold(0.0_f64, |l, v| l.hypot(*v));
        Minimum { shift, length, difference: likeness.at(shift) / usual }
    };
    likeness.shifts().filter(|s| is_least(*s)).map(minimum).filter(|m| m.length >= SHORTEST).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use arabesque_core::{Stage, Stream, Vector};
    use arabesque_surface::OrientedPoints;

    use super::*;
    use crate::search::field::Lattice;

    fn of(height: impl Fn(f64, f64) -> f64) -> Repetition {
        let points: Vec<_> = (0..10_000)
            .map(|k| {
                let (x, y) = (0.1 * f64::from(k % 100), 0.1 * f64::from(k / 100));
                Vector([x, y, height(x, y)])
            })
            .collect();
        let budget = Budget::default();
        let points = OrientedPoints::new(points, vec![Vector([0.0, 0.0, 1.0]); 10_000], 0.25, &budget).unwrap();
        let lattice = Lattice { cell: 0.1, heights: vec![-0.4, -0.1, 0.1, 0.4], reach: 0.6 };
        repetition(&Field::new(&points, &lattice, [0.0, 0.0], (100, 100), &budget).unwrap(), &budget).unwrap()
    }

    #[test]
    fn a_lattice_of_bumps_repeats_after_its_period() {
        let found = of(|x, y| 0.5 * (TAU * x / 2.0).sin() * (TAU * y / 2.0).cos());
        // The nearest bump of the same kind is half a period away along both axes; the next ones lie a period away.
        let length = found.length.unwrap();
        assert!(((length - 14.1).abs() < 2.5 || (length - 20.0).abs() < 2.5) && found.strength > 0.7, "{found:?}");
    }

    #[test]
    fn waves_repeat_after_their_length() {
        let found = of(|x, _| 0.5 * (TAU * x / 1.6).sin());
        assert!((found.length.unwrap() - 16.0).abs() < 3.0, "{found:?}");
    }

    #[test]
    fn noise_does_not_repeat() {
        let mut random = Stream::new(4, Stage::TEST, 0);
        let waves: Vec<[f64; 3]> =
            (0..40).map(|_| [random.range(-2.0, 2.0), random.range(-2.0, 2.0), random.range(0.0, TAU)]).collect();
        let found = of(|x, y| waves.iter().map(|[a, b, c]| 0.08 * (a * x + b * y + c).cos()).sum());
        assert!(found.length.is_none() || found.strength < 0.6, "{found:?}");
    }
}
