//! How densely points lie, and along which coordinates a structure repeats.

use arabesque_core::{Bounds, Domain, GridIndex, Vector};

/// A structure that is wider across than this share of its length is no rope.
const ROPE: f64 = 0.6;
/// A structure that is thicker than this share of its width is no surface.
const SHEET: f64 = 0.5;

/// Distance of most points to the nearest other one; `None` where all lie in one place.
pub fn mean_spacing<const D: usize>(points: &[Vector<D>]) -> Option<f64> {
    spacing(points).map(|s| s.0)
}

/// Distance to the nearest other point, in the median over all points that do not lie on another one, and by how much of itself it
/// varies; `None` when all lie on one another.
pub(crate) fn spacing<const D: usize>(points: &[Vector<D>]) -> Option<(f64, f64)> {
    let bounds = Bounds::around(points.iter().copied());
    let size = bounds.size();
    let largest = size.0.iter().copied().fold(0.0, f64::max);
    let sides: Vec<f64> = size.0.iter().copied().filter(|&s| s > 1e-6 * largest).collect();
    let cell = (sides.iter().product::<f64>() / points.len().max(1) as f64).powf(1.0 / sides.len().max(1) as f64);
    if cell <= 0.0 || !cell.is_finite() {
        return None;
    }
    let index = GridIndex::new(points, cell, &Domain::Box(bounds));
    let mut nearest: Vec<f64> = Vec::with_capacity(points.len());
    for (i, &p) in points.iter().enumerate() {
        let mut radius = 0.5 * cell;
        let found = loop {
            let mut best = f64::INFINITY;
            index.within(p, radius, |j, offset| {
                let d = offset.norm();
                if j != i && d > 1e-9 * largest && d < best {
                    best = d;
                }
            });
            if best.is_finite() || radius > 2.0 * largest {
                break best;
            }
            radius *= 2.0;
        };
        if found.is_finite() {
            nearest.push(found);
        }
    }
    nearest.sort_by(f64::total_cmp);
    let at = |share: f64| nearest.get((share * nearest.len() as f64) as usize).copied();
    let median = at(0.5)?;
    // Nine in ten lie within 3.29 standard deviations of a normal distribution.
    let variation = (at(0.95)? - at(0.05)?) / 3.29 / median;
    Some((median, variation))
}

/// The coordinates along which a structure in `bounds` repeats: all that are long; `wanted` says how many.
pub(crate) fn base<const D: usize>(bounds: &Bounds<D>, wanted: Option<usize>) -> [bool; D] {
    let size = bounds.size();
    let mut order: [usize; D] = std::array::from_fn(|k| k);
    order.sort_by(|&a, &b| size[b].total_cmp(&size[a]).then(a.cmp(&b)));
    let count = wanted.map_or_else(
        || {
            if size[order[1]] < ROPE * size[order[0]] {
                1
            } else if D > 2 && size[order[2]] < SHEET * size[order[1]] {
                2
            } else {
                D
            }
        },
        |n| n.min(D),
    );
    let mut base = [false; D];
    order[..count].iter().for_each(|&k| base[k] = true);
    base
}
