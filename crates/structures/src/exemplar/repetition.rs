//! How far the exemplar is from where it looks like itself again.

use arabesque_core::{Budget, Result, Vector};
use rayon::prelude::*;

use super::{field::Field, pattern::Pattern};

/// Points that are looked at.
const POINTS: usize = 500;
/// Share of the exemplar's length up to which lags are looked at.
const FARTHEST: f64 = 0.48;
/// Most shifts that are kept, not counting their opposites.
const SHIFTS: usize = 12;
/// A peak counts that rises at least so far towards the highest one.
const RISE: f64 = 0.7;

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

/// Looks for shifts that lay the exemplar well upon itself.
///
/// What overlaps is compared for shifts on a grid along the base. Peaks are higher than all shifts around them.
pub(crate) fn repetition<const D: usize>(
    pattern: &Pattern<D>,
    field: &Field<D>,
    step: f64,
    budget: &Budget,
) -> Result<Repetition<D>> {
    let size = pattern.bounds.size();
    let half: [usize; D] =
        std::array::from_fn(|k| if pattern.base[k] { (FARTHEST * size[k] / step) as usize } else { 0 });
    let wide: [usize; D] = half.map(|h| 2 * h + 1);
    let lags: usize = wide.iter().product();
    let stride = (pattern.points.len() / POINTS).max(1);
    budget.spend((lags * (pattern.points.len() / stride) * 40) as u64)?;
    let place = |index: usize| -> [isize; D] {
        let mut rest = index;
        std::array::from_fn(|k| {
            let at = rest % wide[k];
            rest /= wide[k];
            at as isize - half[k] as isize
        })
    };
    let own: Vec<f32> = pattern
        .points
        .positions
        .iter()
        .zip(&pattern.weights)
        .map(|(p, w)| field.project(&p.0.map(|x| x as f32), w))
        .collect();
    // The other half is the same mirrored.
    let alike: Vec<f64> = (0..lags / 2 + 1)
        .into_par_iter()
        .map(|index| {
            let shift = Vector(place(index).map(|n| n as f64 * step));
            let (mut same, mut all) = (0.0, 1e-12);
            for i in (0..pattern.points.len()).step_by(stride) {
                let to = pattern.points.positions[i] + shift;
                let inside = (0..D)
                    .all(|k| !pattern.base[k] || to[k] >= pattern.bounds.min[k] && to[k] <= pattern.bounds.max[k]);
                if inside {
                    same += f64::from(field.project(&to.0.map(|x| x as f32), &pattern.weights[i]));
                    all += f64::from(own[i]);
                }
            }
            same / all
        })
        .collect();
    let at = |index: usize| alike[index.min(lags - 1 - index)];
    let mut strides = [1; D];
    for k in 1..D {
        strides[k] = strides[k - 1] * wide[k - 1];
    }
    let mut peaks = Vec::new();
    for index in 0..lags / 2 {
        let here = place(index);
        if (0..D).any(|k| pattern.base[k] && here[k].unsigned_abs() >= half[k]) {
            continue;
        }
        let neighbours = 3_usize.pow(D as u32);
        let highest = (0..neighbours).all(|n| {
            let (mut rest, mut to) = (n, index as isize);
            for k in 0..D {
                let off = (rest % 3) as isize - 1;
                rest /= 3;
                if pattern.base[k] {
                    to += off * strides[k] as isize;
                } else if off != 0 {
                    return true;
                }
            }
            at(to as usize) <= alike[index]
        });
        let far = here.iter().map(|&n| (n as f64 * step).powi(2)).sum::<f64>().sqrt();
        if highest && far > 2.5 * pattern.spacing {
            peaks.push((far, alike[index], Vector(here.map(|n| n as f64 * step))));
        }
    }
    let best = peaks.iter().map(|p| p.1).fold(0.0, f64::max);
    let mean = alike.iter().sum::<f64>() / alike.len() as f64;
    let least = mean + RISE * (best - mean);
    peaks.retain(|p| p.1 >= least);
    let length = peaks.iter().map(|p| p.0).min_by(f64::total_cmp);
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    peaks.truncate(SHIFTS);
    let strength = if best > 0.0 { ((best - mean) / (1.0 - mean).max(0.05)).clamp(0.0, 1.0) } else { 0.0 };
    Ok(Repetition { length, strength, shifts: peaks.into_iter().flat_map(|p| [p.2, -p.2]).collect() })
}
