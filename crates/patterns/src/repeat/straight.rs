//! The repeat of parallel straight lines, which have no points of their own.

use arabesque_core::{Bounds, Budget, Result, Segment, Vector};

use crate::repeat::{
    description::{Explains, Extent, Repeat},
    lattice::Lattice,
    lines::{Feature, Lines},
    marks::Anchor,
    support::LineIndex,
};

/// Lines are parallel when the sine of their angle is below this.
const PARALLEL: f64 = 1e-3;

/// How far a line may lie off, as a share of the extent of the frame across the lines.
const TOLERANCE: f64 = 1e-3;

/// Most lines that are compared with one another.
const MOST: usize = 2000;

/// The repeat of straight lines that all run the same way, across it.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(super) fn stripes(lines: &Lines, index: &LineIndex<'_>, budget: &Budget) -> Result<Option<Repeat>> {
    // How areas end at the frame or beyond it says nothing.
    let seen = index.seen();
    let is_seen = |a: Vector<2>, b: Vector<2>| crosses((a, b), &seen);
    let stretches: Vec<_> = lines.stretches.iter().filter(|((a, b), _)| is_seen(*a, *b)).collect();
    let Some(((from, to), _)) = stretches.first() else { return Ok(None) };
    let along = (*to - *from).unit_or_zero();
    let normal = Vector::xy(-along[1], along[0]);
    let is_parallel = |way: Vector<2>| way.unit_or_zero().cross(along).abs() < PARALLEL;
    let all_parallel = lines
        .tracks
        .iter()
        .all(|t| t.points.windows(2).all(|w| !is_seen(w[0], w[1]) || w[0] == w[1] || is_parallel(w[1] - w[0])));
    // What ends inside the frame is not the same all along.
    let has_ends = lines.features.iter().any(|(_, feature)| matches!(feature, Feature::End(_)));
    if has_ends || !all_parallel || stretches.len() < 3 || stretches.len() > MOST {
        return Ok(None);
    }
    let mut places: Vec<(f64, usize)> = stretches.iter().map(|((a, _), style)| (a.dot(normal), *style)).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let across = places[places.len() - 1].0 - places[0].0;
    let tolerance = TOLERANCE * across;
    let mut offsets: Vec<f64> = Vec::new();
    budget.spend(20 * (places.len() as u64).pow(2))?;
    for (k, (a, style)) in places.iter().enumerate() {
        let others = places[k + 1..].iter().filter(|(_, other)| other == style);
        offsets.extend(others.map(|(b, _)| b - a).filter(|d| *d > 4.0 * tolerance && *d <= 0.55 * across));
    }
    offsets.sort_by(f64::total_cmp);
    offsets.dedup_by(|a, b| (*a - *b).abs() < 0.5 * tolerance);
    for step in offsets {
        let partner = |(at, style): &(f64, usize), by: f64| {
            let there = at + by;
            let first = places.partition_point(|(p, _)| *p < there - tolerance);
            let near = places[first..].iter().take_while(|(p, _)| *p <= there + tolerance);
            near.filter(|(_, other)| other == style).map(|(p, _)| p - at).next()
        };
        let (low, high) = (places[0].0 - tolerance, places[places.len() - 1].0 + tolerance);
        let seen: Vec<_> = places.iter().filter(|(at, _)| (low..=high).contains(&(at + step))).collect();
        let found: Vec<f64> = seen.iter().filter_map(|place| partner(place, step)).collect();
        budget.spend(50 * places.len() as u64)?;
        if found.len() < seen.len() || !index.supports(normal * step, 2.0 * tolerance, budget)? {
            continue;
        }
        // The longest chain of steps says best how long one is.
        let mut count = 1.0;
        let mut total = found.iter().sum::<f64>() / found.len() as f64;
        while let Some(longer) = places.iter().find_map(|place| partner(place, total / count * (count + 1.0))) {
            (total, count) = (longer, count + 1.0);
        }
        let step = total / count;
        let Some(lattice) = Lattice::new(normal * step, along * step) else { continue };
        let (explains, extent, anchor) = (Explains::Everything, Extent::Stripes(along), Anchor::Centre);

        return Ok(Some(Repeat { lattice, explains, extent, anchor, jitter: 0.0, share: 1.0 }));
    }
    Ok(None)
}

/// Whether a part of a segment lies in a box.
fn crosses((a, b): Segment<2>, within: &Bounds<2>) -> bool {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let way = b[k] - a[k];
        if way == 0.0 {
            if !(within.min[k]..=within.max[k]).contains(&a[k]) {
                return false;
            }
            continue;
        }
        let (s, t) = ((within.min[k] - a[k]) / way, (within.max[k] - a[k]) / way);
        (from, to) = (from.max(s.min(t)), to.min(s.max(t)));
    }
    from <= to
}
