//! Rigid elements in the gaps between those that are laid out: where pieces of the exemplar meet, elements that would cut others are left out,
//! and what replaces them is found here, so that there are as many as in the exemplar.

use arabesque_core::{Budget, Matrix, Result, Similarity, Stage, Stream, Vector};

use super::cells::Cells;
use crate::{energy::level::Level, output::state::Output};

/// Elements and places that are tried.
const TRIES: Stage = Stage::new(48);
/// How many at each site in each pass.
const EACH: usize = 10;
/// Passes over all sites.
const PASSES: u64 = 4;
/// Share of the usual number of elements below which there is a gap.
const GAP: f64 = 0.97;

/// Adds elements where there are fewer than usual and one fits without coming too near to others. Of mixtures, the continuous part says where
/// elements are.
pub(crate) fn fill<const D: usize>(
    level: &Level<'_, D>,
    output: &mut Output<D>,
    step: f64,
    seed: u64,
    budget: &Budget,
) -> Result<()> {
    let pattern = level.pattern;
    let Some(gap) = pattern.gaps.usual() else { return Ok(()) };
    let usual = pattern.bodies.len() as f64 / pattern.measure() * level.tables.kernel.volume(pattern.repeats());
    let mut points = Cells::new(gap.max(pattern.spacing), level.domain);
    output.places.iter().for_each(|&p| points.add(p));
    let mut middles = Cells::new(level.tables.kernel.reach(), level.domain);
    let middle = |s: &Similarity<D>, source: usize| s.apply(pattern.bodies[source].centre);
    output.bodies.iter().for_each(|b| middles.add(middle(&b.pose, b.source)));
    let mut meter = budget.meter();
    for pass in 0..PASSES {
        for (q, site) in level.sites.iter().enumerate() {
            let mut there = 0.0;
            middles.within(level.domain, site.place, level.tables.kernel.reach() * site.scale, |_, r| {
                there += level.tables.kernel.weight(&site.seen(r));
            });
            meter.spend(2_000)?;
            if there > GAP * usual {
                continue;
            }
            let mut stream = Stream::new(seed, TRIES, pass << 32 | q as u64);
            for _ in 0..EACH {
                let source = stream.below(pattern.bodies.len());
                let offset = Vector(std::array::from_fn(|k| {
                    if pattern.base[k] {
                        stream.range(-0.5 * step, 0.5 * step)
                    } else {
                        pattern.bodies[source].centre[k] - pattern.axis[k]
                    }
                }));
                let rotation: Matrix<D> = site.rotation;
                let to = site.place + site.shown(offset);
                let pose = Similarity::about(pattern.bodies[source].centre, to, rotation, site.scale);
                let fits = pattern.bodies[source].members.iter().all(|&i| {
                    let mut free = true;
                    points.within(level.domain, pose.apply(pattern.points.positions[i]), gap * site.scale, |_, _| {
                        free = false
                    });
                    free
                });
                meter.spend(200 * pattern.bodies[source].members.len() as u64)?;
                if fits {
                    let first = output.places.len();
                    output.add_body(pattern, source, pose);
                    output.places[first..].iter().for_each(|&p| points.add(p));
                    middles.add(to);
                    break;
                }
            }
        }
    }
    Ok(())
}
