//! Rigid elements in the gaps between those that are laid out: where pieces of the exemplar meet, elements that would cut others are left out,
//! and what replaces them is found here, so that there are about as many as in the exemplar.

use arabesque_core::{Budget, Matrix, Result, Similarity, Stage, Stream, Vector};

use super::cells::Cells;
use crate::{
    energy::level::Level,
    exemplar::{bodies::LOOSE, pattern::Pattern},
    output::state::Output,
    territory::site::Site,
};

/// Elements and places that are tried.
const TRIES: Stage = Stage::new(48);
/// How many at each site in each pass.
const EACH: usize = 10;
/// Passes over all sites.
const PASSES: u64 = 4;
/// Share of the usual number of elements below which there is a gap; and of mixtures, whose continuous part says more of where elements are.
const GAP: [f64; 2] = [0.97, 0.8];
/// How far around an element the continuous part shows how high it stands, in spacings.
const AROUND: f64 = 2.5;

/// Adds elements where there are fewer than usual and one fits without coming too near to others. Of mixtures they stand as high on the continuous
/// part as in the exemplar.
pub(crate) fn fill<const D: usize>(
    level: &Level<'_, D>,
    output: &mut Output<D>,
    step: f64,
    seed: u64,
    budget: &Budget,
) -> Result<()> {
    let pattern = level.pattern;
    let Some(gap) = pattern.gaps.usual() else { return Ok(()) };
    let least = GAP[usize::from(pattern.gaps.is_mixed())];
    let stands: Vec<Option<Vector<D>>> = (0..pattern.bodies.len()).map(|b| standing(pattern, b)).collect();
    let usual = pattern.bodies.len() as f64 / pattern.measure() * level.tables.kernel.volume(pattern.repeats());
    let mut points = Cells::new(gap.max(pattern.spacing), level.domain);
    let mut loose = Cells::new(AROUND * pattern.spacing, level.domain);
    for (&p, &body) in output.places.iter().zip(&output.body_of) {
        if body != LOOSE || !pattern.gaps.is_mixed() { &mut points } else { &mut loose }.add(p);
    }
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
            if there > least * usual {
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
                let stood = stands[source].map_or(Some(offset), |s| stood(level, site, &loose, offset, s));
                let Some(offset) = stood else { continue };
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

/// How far across the base the continuous part around an element of the exemplar lies from its middle, and zero along it; `None` where there is none.
fn standing<const D: usize>(pattern: &Pattern<D>, body: usize) -> Option<Vector<D>> {
    let (mut sum, mut count) = (Vector::ZERO, 0.0);
    pattern.index.within(pattern.bodies[body].centre, AROUND * pattern.spacing, |j, r| {
        if pattern.body_of[j] == LOOSE {
            (sum, count) = (sum + r, count + 1.0);
        }
    });
    let mean = sum * (1.0 / f64::max(count, 1.0));
    (count > 0.0).then(|| Vector(std::array::from_fn(|k| if pattern.base[k] { 0.0 } else { mean[k] })))
}

/// The offset from a site at which an element lies as far from the continuous part as in the exemplar, which `stands` says; `None` where there is
/// nothing to stand on.
fn stood<const D: usize>(
    level: &Level<'_, D>,
    site: &Site<D>,
    loose: &Cells<D>,
    offset: Vector<D>,
    stands: Vector<D>,
) -> Option<Vector<D>> {
    let (mut sum, mut count) = (Vector::<D>::ZERO, 0.0);
    let radius = AROUND * level.pattern.spacing * site.scale;
    loose.within(level.domain, site.place + site.shown(offset), radius, |_, r| {
        (sum, count) = (sum + Vector(site.seen(r)), count + 1.0);
    });
    let mean = sum * (1.0 / f64::max(count, 1.0));
    let raised = |k: usize| if level.pattern.base[k] { 0.0 } else { mean[k] - stands[k] };
    (count > 0.0).then(|| Vector(std::array::from_fn(|k| offset[k] + raised(k))))
}
