//! Global step for attributes: directions, radii and colours become what the matches want [Roveri 2015 §5.1].
//!
//! For fixed places `T` is a quadratic form in the weights. A direction has length 1: its best value, with all others as they are, is
//! what the matches want less what the others give already, at length 1. Points follow one another, so that each sees what became of
//! those before it (Gauss-Seidel).

use arabesque_core::{Budget, Result, Vector};

use crate::{
    each::each,
    energy::level::{Level, Matches, Near, Pull},
    exemplar::{
        bodies::LOOSE,
        channels::{LANES, Weights},
    },
    output::state::Output,
};

/// Share of the direction of before in the new one: keeps noise in the small differences of large sums down.
const INERTIA: f32 = 0.5;

/// Work for each site that wants something of a point, and for each point beside it.
const WANTED: u64 = 60;
const REST: u64 = 20;

/// Sets the attributes of all points of no rigid element that do not stay as they are.
pub(crate) fn attributes<const D: usize>(
    level: &Level<'_, D>,
    output: &mut Output<D>,
    near: &Near,
    matches: &Matches<D>,
    (pulls, budget): (&mut [Pull<D>], &Budget),
) -> Result<()> {
    let channels = &level.pattern.channels;
    if channels.normal().is_none() && channels.scalars().next().is_none() && !channels.has_classes() {
        return Ok(());
    }
    let stays = |i: usize| output.is_kept(i) || output.body_of[i] != LOOSE;
    let cost = |i: usize| if stays(i) { 1 } else { near.windows.of(i).len() as u64 * WANTED };
    let wanted: Vec<Weights> = each(output.places.len(), budget, cost, |i| {
        if stays(i) { [0.0; LANES] } else { level.wanted(output.places[i], near.windows.of(i), matches).0 }
    })?;
    let mut meter = budget.meter();
    for i in output.kept..output.places.len() {
        if output.body_of[i] != LOOSE {
            continue;
        }
        meter.spend(near.pairs.of(i).len() as u64 * REST)?;
        let rest = rest(level, output, near, pulls, i, &wanted[i]);
        let old = output.weights[i];
        let mut new = old;
        let own = pulls[i].cover as f32;
        if let Some(at) = level.pattern.channels.normal() {
            let target: Vector<D> =
                Vector(std::array::from_fn(|k| f64::from(rest[at + k] + INERTIA * own * old[at + k])));
            if let Some(direction) = target.unit_if_longer(1e-9) {
                new = level.pattern.channels.directed(new, direction);
            }
        }
        for c in level.pattern.channels.scalars() {
            // The minimum of the quadratic, damped in the same way.
            let (least, most) = level.pattern.ranges[c];
            let best = (rest[c] + INERTIA * own * old[c]) / ((1.0 + INERTIA) * own).max(1e-12);
            new[c] = best.clamp(least, most);
        }
        for c in channels.classes() {
            new[c] = rest[c] + INERTIA * own * old[c];
        }
        // Classes are discrete: the nearest one [Roveri 2015 §4.4].
        new = channels.classed(new);
        // Exactly how T changes.
        let change: f32 =
            (0..LANES).map(|c| own * (new[c] * new[c] - old[c] * old[c]) - 2.0 * rest[c] * (new[c] - old[c])).sum();
        if change < 0.0 {
            output.weights[i] = new;
            pulls[i].wanted = (0..LANES).map(|c| f64::from(new[c] * wanted[i][c])).sum();
        }
    }
    Ok(())
}

/// What the matches want of point `i` beyond what all other points give.
fn rest<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    pulls: &[Pull<D>],
    i: usize,
    wanted: &Weights,
) -> Weights {
    let mut rest = *wanted;
    for &j in near.pairs.of(i) {
        let j = j as usize;
        let r2 = level.domain.offset(output.places[i], output.places[j]).norm2();
        let h = level.pair(r2, pulls[i].scale, pulls[j].scale) * 0.5 * (pulls[i].cover + pulls[j].cover);
        for (s, w) in rest.iter_mut().zip(&output.weights[j]) {
            *s -= h as f32 * w;
        }
    }
    rest
}
