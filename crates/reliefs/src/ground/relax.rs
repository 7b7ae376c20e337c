//! Points along seams are spread evenly: those that lie too close go, the others keep apart along the surface [Duranleau 2008 §6].
//!
//! Departure: the rest of the points stays where it is, since it lies as in the texture.

use arabesque_core::{Budget, Result, Vector};
use arabesque_surface::OrientedPoints;
use rayon::prelude::*;

use crate::sample::Sample;

/// Points nearer than so many spacings are one.
const CLOSE: f64 = 0.38;
/// How far points keep others away, in spacings.
const APART: f64 = 0.7;
/// A point that would leave its tangent plane by more, in spacings, or turn by more, stays.
const OFF: f64 = 0.15;
/// The cosine of that turn.
const ALIKE: f64 = 0.93;
/// Longest step of a round, in spacings.
const STEP: f64 = 0.25;

/// How the plane repeats: by so much along x and y.
pub(crate) type Period = Option<[f64; 2]>;

/// Positions and normals with copies beyond the borders of a tile, as far as `margin`; and for each the number of the original.
fn with_ghosts(samples: &[Sample], period: Period, margin: f64) -> (Vec<Vector<3>>, Vec<Vector<3>>, Vec<u32>) {
    let mut positions: Vec<_> = samples.iter().map(|s| s.at).collect();
    let mut normals: Vec<_> = samples.iter().map(|s| s.normal).collect();
    let mut numbers: Vec<u32> = (0..samples.len() as u32).collect();
    let Some([width, depth]) = period else { return (positions, normals, numbers) };
    for (i, s) in samples.iter().enumerate() {
        for (dx, dy) in
            [(-1.0, -1.0), (-1.0, 0.0), (-1.0, 1.0), (0.0, -1.0), (0.0, 1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0)]
        {
            let at = s.at + Vector([dx * width, dy * depth, 0.0]);
            if at[0] > -margin && at[0] < width + margin && at[1] > -margin && at[1] < depth + margin {
                positions.push(at);
                normals.push(s.normal);
                numbers.push(i as u32);
            }
        }
    }
    (positions, normals, numbers)
}

/// Points that are near seams, by their numbers: all that lie within `reach` of one along a seam, and some more.
fn near_seams(samples: &[Sample], period: Period, reach: f64) -> Vec<u32> {
    // Cells share slots: what is in a slot by chance does no harm.
    let slots = samples.len().next_power_of_two().max(1 << 10);
    let cell = |at: Vector<3>| at.0.map(|v| (v / (2.0 * reach)).floor() as i64);
    let slot = |[x, y, z]: [i64; 3]| {
        let mixed = x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
        (mixed as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) as usize >> 8 & (slots - 1)
    };
    let mut is_near = vec![false; slots];
    let seams: Vec<Sample> = samples.iter().filter(|s| s.is_at_seam).copied().collect();
    let (positions, _, _) = with_ghosts(&seams, period, reach);
    for at in positions {
        let (low, high) = (cell(at - Vector::splat(reach)), cell(at + Vector::splat(reach)));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                (low[0]..=high[0]).for_each(|x| is_near[slot([x, y, z])] = true);
            }
        }
    }
    (0..samples.len() as u32).filter(|&i| is_near[slot(cell(samples[i as usize].at))]).collect()
}

/// Spreads the points along seams; answers how many went. When it cannot be done, they stay as they are. None leaves the `extent` in which
/// it lies: beyond the border nothing pushes back.
pub(crate) fn relax(
    samples: &mut Vec<Sample>,
    (spacing, radius): (f64, f64),
    rounds: usize,
    (period, extent): (Period, Option<[f64; 2]>),
    budget: &Budget,
) -> Result<usize> {
    budget.spend(samples.len() as u64 * 20)?;
    let near = near_seams(samples, period, 2.0 * radius);
    let mut some: Vec<Sample> = near.iter().map(|&i| samples[i as usize]).collect();
    let cloud = |some: &[Sample]| -> Result<(OrientedPoints, Vec<u32>)> {
        let (positions, normals, numbers) = with_ghosts(some, period, radius);
        Ok((OrientedPoints::new(positions, normals, radius, budget)?, numbers))
    };
    let (points, numbers) = cloud(&some)?;
    let mut is_gone = vec![false; some.len()];
    let mut meter = budget.meter();
    for i in 0..some.len() {
        if !some[i].is_at_seam {
            continue;
        }
        meter.spend(400)?;
        let mut is_close = false;
        points.around(some[i].at, CLOSE * spacing, |j, _| {
            let other = numbers[j] as usize;
            is_close |= other != i && !is_gone[other] && points.normals()[j].dot(some[i].normal) > 0.3;
        });
        is_gone[i] = is_close;
    }
    drop(points);
    let kept: Vec<usize> = (0..some.len()).filter(|&i| !is_gone[i]).collect();
    let merged = some.len() - kept.len();
    some = kept.iter().map(|&i| some[i]).collect();
    let (surface, _) = cloud(&some)?;
    let seams: Vec<usize> = (0..some.len()).filter(|&i| some[i].is_at_seam).collect();
    let lies_within = |at: &Vector<3>| extent.is_none_or(|size| (0..2).all(|k| (0.0..=size[k]).contains(&at[k])));
    for round in 0..rounds {
        let moved = if round == 0 { None } else { Some(cloud(&some)?.0) };
        let now = moved.as_ref().unwrap_or(&surface);
        budget.spend(seams.len() as u64 * 2500)?;
        let moved: Vec<(Vector<3>, Vector<3>)> =
            seams.par_iter().with_min_len(128).map(|&i| step(&some[i], now, &surface, spacing)).collect();
        for (&i, (at, normal)) in seams.iter().zip(moved) {
            if lies_within(&at) || !lies_within(&some[i].at) {
                (some[i].at, some[i].normal) = (at, normal);
            }
        }
    }
    for (&i, s) in kept.iter().zip(&some) {
        samples[near[i] as usize] = *s;
    }
    let mut gone = near.iter().zip(&is_gone).filter(|(_, gone)| **gone).map(|(i, _)| *i).peekable();
    let mut k = 0;
    samples.retain(|_| {
        k += 1;
        gone.next_if_eq(&(k - 1)).is_none()
    });
    Ok(merged)
}

/// Where one point goes: away from those around it, and back onto the surface.
fn step(sample: &Sample, now: &OrientedPoints, surface: &OrientedPoints, spacing: f64) -> (Vector<3>, Vector<3>) {
    let reach = APART * spacing;
    let mut away = Vector::ZERO;
    now.around(sample.at, reach, |j, d2| {
        let d = d2.sqrt();
        if d > 1e-9 * spacing && now.normals()[j].dot(sample.normal) > 0.0 {
            away += (sample.at - now.positions()[j]) * ((1.0 - d / reach) / d);
        }
    });
    let along = away - sample.normal * away.dot(sample.normal);
    let length = (0.4 * along.norm() * spacing).min(STEP * spacing);
    if length < 1e-3 * spacing {
        return (sample.at, sample.normal);
    }
    let to = sample.at + along.unit_or_zero() * length;
    let onto = |x: Vector<3>| surface.project(x, spacing, Some(sample.normal));
    let (Some(from), Some(foot)) = (onto(sample.at), onto(to)) else { return (sample.at, sample.normal) };
    // Near an edge the surface is smoother than the points: they keep off it as far as they were.
    let step = foot.point - from.point;
    if (sample.at + step - to).norm() < OFF * spacing && foot.normal.dot(from.normal) > ALIKE {
        let normal = (sample.normal + foot.normal - from.normal).unit_if_longer(1e-9).unwrap_or(sample.normal);
        (sample.at + step, normal)
    } else {
        (sample.at, sample.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet() -> Vec<Sample> {
        let at = |k: usize| Vector([(k % 20) as f64, (k / 20) as f64, 0.0]);
        let normal = Vector([0.0, 0.0, 1.0]);
        (0..400).map(|k| Sample { at: at(k), normal, source: k as u32, ..Sample::default() }).collect()
    }

    #[test]
    fn close_points_are_merged_and_pushed_ones_stay_on_the_surface() {
        let mut samples = sheet();
        samples.push(Sample { at: Vector([5.1, 5.1, 0.0]), is_at_seam: true, ..samples[0] });
        samples.push(Sample { at: Vector([7.6, 7.2, 0.0]), is_at_seam: true, ..samples[0] });
        let merged = relax(&mut samples, (1.0, 2.5), 8, (None, None), &Budget::default()).unwrap();
        assert_eq!((merged, samples.len()), (1, 401));
        let moved = samples[400].at;
        assert!((moved - Vector([7.5, 7.5, 0.0])).norm() < 0.25 && moved[2].abs() < 1e-9, "{moved:?}");
        assert_eq!(samples[..400], sheet()[..]);
    }

    #[test]
    fn tiles_see_across_their_border() {
        let mut samples = sheet();
        samples.push(Sample { at: Vector([19.9, 5.0, 0.0]), is_at_seam: true, ..samples[0] });
        let merged = relax(&mut samples, (1.0, 2.5), 0, (Some([20.0, 20.0]), None), &Budget::default()).unwrap();
        assert_eq!(merged, 1, "the point at 0 is the one at 20");
    }

    #[test]
    fn points_do_not_leave_the_extent() {
        let beyond = |extent| {
            let mut samples = sheet();
            let first = samples[0];
            let at = |k: u32| Vector([f64::from(k) + 0.5, 18.2, 0.0]);
            samples.extend((0..19).map(|k| Sample { at: at(k), is_at_seam: true, ..first }));
            relax(&mut samples, (1.0, 2.5), 8, (None, extent), &Budget::default()).unwrap();
            samples[400..].iter().filter(|s| s.at[1] > 18.3).count()
        };
        assert!(beyond(None) > 10 && beyond(Some([20.0, 18.3])) == 0, "{}", beyond(None));
    }
}
