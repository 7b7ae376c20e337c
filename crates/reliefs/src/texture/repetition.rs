//! How far the texture is from where it looks like itself again, by the autocorrelation of its field.

use arabesque_core::{Budget, Result};
use rayon::prelude::*;

use crate::search::field::Field;

/// Columns along the longer side that are compared at most.
const COLUMNS: usize = 48;
/// A shift at which the field differs by less than this share of what is usual is a repetition.
const ALIKE: f64 = 0.72;
/// Repetitions that are worse than the best by less than this factor are as good.
const AS_GOOD: f64 = 1.35;
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

/// The shortest of the shifts at which the field is most like itself.
pub(crate) fn repetition(field: &Field, budget: &Budget) -> Result<Repetition> {
    let skip = field.width.max(field.height).div_ceil(COLUMNS).max(1);
    let (width, height) = (field.width / skip, field.height / skip);
    let none = Repetition { length: None, strength: 0.0 };
    if width < 8 || height < 8 {
        return Ok(none);
    }
    let mean = |plane: &Vec<f32>, x: usize, y: usize| {
        let of = |dy: usize| (0..skip).map(move |dx| plane[(y * skip + dy) * field.width + x * skip + dx]);
        (0..skip).flat_map(of).sum::<f32>() / (skip * skip) as f32
    };
    let planes: Vec<Vec<f32>> = field
        .planes
        .par_iter()
        .map(|plane| (0..width * height).map(|k| mean(plane, k % width, k / width)).collect())
        .collect();
    // Shifts up to half of the texture; those to the other side are the same.
    let (most_x, most_y) = (width as i64 / 2, height as i64 / 2);
    let shifts: Vec<[i64; 2]> = (0..=most_y).flat_map(|y| (-most_x..=most_x).map(move |x| [x, y])).collect();
    budget.spend((shifts.len() * width * height * planes.len()) as u64 / 6)?;
    let differences: Vec<f64> = shifts.par_iter().map(|&shift| difference(&planes, (width, height), shift)).collect();
    let mut sorted = differences.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2].max(f64::MIN_POSITIVE);
    let row = 2 * most_x as usize + 1;
    let at = |x: i64, y: i64| -> f64 {
        // Below the first row the shifts are those above it, turned round.
        let (x, y) = if y < 0 { (-x, -y) } else { (x, y) };
        if x.abs() > most_x || y > most_y {
            f64::INFINITY
        } else {
            differences[y as usize * row + (x + most_x) as usize]
        }
    };
    // What looks alike all the way, as waves do along their crests, does not repeat there.
    let differs_between = |[x, y]: [i64; 2], own: f64| {
        let steps = 2 * x.abs().max(y);
        let part = |k: i64| {
            let [i, j] = [x, y].map(|v| (v as f64 * k as f64 / steps as f64).round() as i64);
            at(i, j)
        };
        (1..steps).any(|k| part(k) > own + BETWEEN * usual)
    };
    let minima: Vec<(f64, f64)> = shifts
        .iter()
        .filter(|[x, y]| {
            let own = at(*x, *y);
            let is_inner = x.abs() < most_x && *y < most_y;
            is_inner
                && differs_between([*x, *y], own)
                && (-1..=1).all(|dy| (-1..=1).all(|dx| at(x + dx, y + dy) >= own))
        })
        .map(|[x, y]| (((x * x + y * y) as f64).sqrt(), at(*x, *y) / usual))
        .filter(|(length, _)| *length >= SHORTEST)
        .collect();
    let best = minima.iter().map(|m| m.1).fold(f64::INFINITY, f64::min);
    if best > ALIKE {
        return Ok(Repetition { strength: (1.0 - best).clamp(0.0, 1.0), ..none });
    }
    let alike = minima.iter().filter(|m| m.1 <= (AS_GOOD * best).max(best + 0.1).min(ALIKE));
    let length = alike.map(|m| m.0).fold(f64::INFINITY, f64::min);
    Ok(Repetition { length: Some(length * skip as f64), strength: 1.0 - best })
}

/// Mean squared difference of the planes from themselves, shifted.
fn difference(planes: &[Vec<f32>], (width, height): (usize, usize), [x, y]: [i64; 2]) -> f64 {
    let y = y as usize;
    let (from, to) = ((-x).max(0) as usize, (width as i64 - x.max(0)) as usize);
    let mut sum = 0.0;
    for plane in planes {
        for row in 0..height - y {
            let a = &plane[row * width + from..row * width + to];
            let start = (row + y) * width + (from as i64 + x) as usize;
            let b = &plane[start..start + a.len()];
            sum += f64::from(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>());
        }
    }
    sum / ((to - from) * (height - y)) as f64
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
