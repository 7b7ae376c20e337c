//! Local step: the best match of each site [Roveri 2015 §5.1].
//!
//! A site tries its match of before, those of its neighbours carried over to where it is, and some at random; the best of them go
//! downhill. Sites do not see what the others find in the same round, so that they are independent.

use arabesque_core::{Bounds, Budget, Result, Stage, Stream, Vector};
use rayon::prelude::*;

use crate::{
    energy::{
        level::{Level, Match, Matches, Near},
        links::Lists,
    },
    exemplar::channels::Weights,
    output::state::Output,
};

/// Random matches.
const TRIES: Stage = Stage::new(41);
/// Steps downhill.
const STEPS: usize = 3;
/// How many of the candidates that look best are compared in full; the best of them goes downhill.
const BEST: usize = 3;
/// Points that candidates are compared by at first.
const FEW: usize = 90;
/// Least share of a window along each direction that the exemplar must show.
const SEEN: f64 = 0.72;
/// A match has to be better by this share to replace the one before.
const BETTER: f64 = 1e-9;

/// A match has as many points in its window as the output has in that of the site, or misses that by this share: what fits nowhere would
/// fit nothing best.
const FULL: f64 = 0.08;

/// Share of the points of a match that another one has at least, or of those that windows of the exemplar have in the mean: otherwise matches
/// and output become emptier by turns.
const EMPTIER: f64 = 0.98;

/// A window of the output as its site sees it.
pub(crate) struct View<const D: usize> {
    points: Vec<Seen<D>>,
}

struct Seen<const D: usize> {
    u: [f64; D],
    weights: Weights,
    /// How far it is in the window.
    weight: f32,
    /// The sum over its pairs.
    own: f32,
}

impl<const D: usize> View<D> {
    /// What site `q` sees of the points, of which `own` are the sums over their pairs.
    pub(crate) fn new(level: &Level<'_, D>, q: usize, output: &Output<D>, own: &[f64], points: &[u32]) -> Self {
        let site = &level.sites[q];
        let seen = points.iter().filter_map(|&i| {
            let i = i as usize;
            let u = site.seen(level.domain.offset(site.place, output.places[i]));
            let weight = level.tables.kernel.weight(&u);
            (weight > 0.0).then(|| Seen {
                u,
                weights: level.pattern.channels.turned_back(&output.weights[i], &site.rotation),
                weight: weight as f32,
                own: own[i] as f32,
            })
        });
        Self { points: seen.collect() }
    }

    /// How many points there are in the window, each as far as it is in it.
    fn mass(&self) -> f64 {
        self.points.iter().map(|p| f64::from(p.weight)).sum()
    }

    /// Number of points in the window.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// The error density for a match, divided by the known share.
    pub(crate) fn error(&self, level: &Level<'_, D>, m: &Vector<D>) -> f64 {
        self.sum(level, m, 1, |y, weights| level.tables.field.project(y, weights))
    }

    /// About the same, from one in `stride` of the points.
    fn rough(&self, level: &Level<'_, D>, m: &Vector<D>, stride: usize) -> f64 {
        self.sum(level, m, stride, |y, weights| level.tables.field.glimpse(y, weights))
    }

    #[inline]
    fn sum(
        &self,
        level: &Level<'_, D>,
        m: &Vector<D>,
        stride: usize,
        field: impl Fn(&[f32; D], &Weights) -> f32,
    ) -> f64 {
        let tables = level.tables;
        let mut sum = 0.0_f32;
        for p in self.points.iter().step_by(stride) {
            let y = std::array::from_fn(|k| (m[k] + p.u[k]) as f32);
            let known = tables.known.at(&y);
            if known > 0.0 {
                sum += known * p.weight * (p.own - 2.0 * field(&y, &p.weights));
            }
        }
        (f64::from(sum) * stride as f64 + tables.back.at(&m.0).0) / tables.known.share(&m.0).max(0.05)
    }

    /// Goes downhill from `m`, along the base alone.
    pub(crate) fn refined(&self, level: &Level<'_, D>, room: &Bounds<D>, mut best: Match<D>) -> Match<D> {
        let tables = level.tables;
        let sigma = tables.kernel.sigma;
        let mut length = 1.0;
        for _ in 0..STEPS {
            let m = best.m;
            let (back, back_slope) = tables.back.at(&m.0);
            let mut slope = back_slope;
            for p in &self.points {
                let y = std::array::from_fn(|k| (m[k] + p.u[k]) as f32);
                let known = tables.known.at(&y);
                if known > 0.0 {
                    let (_, along) = tables.field.project_slope(&y, &p.weights);
                    for k in 0..D {
                        slope[k] -= f64::from(2.0 * known * p.weight * along[k]);
                    }
                }
            }
            let curve = back.max(1e-12) / (sigma * sigma);
            let step = Vector(std::array::from_fn(|k| {
                let s = if level.pattern.base[k] { -slope[k] / curve } else { 0.0 };
                (s * length).clamp(-0.6 * sigma, 0.6 * sigma)
            }));
            if step.norm() < 5e-3 * sigma {
                break;
            }
            let to = room.clamp(m + step);
            let error = self.error(level, &to);
            if error < best.error {
                best = Match { m: to, error };
            } else {
                length *= 0.35;
            }
        }
        best
    }
}

/// The places in the exemplar whose windows it shows well enough.
pub(crate) fn room<const D: usize>(level: &Level<'_, D>) -> Bounds<D> {
    let pattern = level.pattern;
    let mut room = pattern.bounds;
    for k in 0..D {
        if !pattern.base[k] {
            (room.min[k], room.max[k]) = (pattern.axis[k], pattern.axis[k]);
            continue;
        }
        let size = room.max[k] - room.min[k];
        // The middle is always allowed.
        let mut inset = 0.0;
        while inset < 0.45 * size {
            let mut m = pattern.bounds.centre();
            m[k] = room.min[k] + inset;
            let alone = level.tables.known.share(&m.0) / level.tables.known.share(&pattern.bounds.centre().0).max(1e-9);
            if alone >= SEEN {
                break;
            }
            inset += 0.01 * size;
        }
        (room.min[k], room.max[k]) = (room.min[k] + inset, room.max[k] - inset);
    }
    room
}

/// A random place in `room`.
pub(crate) fn anywhere<const D: usize>(room: &Bounds<D>, stream: &mut Stream) -> Vector<D> {
    Vector(std::array::from_fn(|k| {
        if room.max[k] > room.min[k] { stream.range(room.min[k], room.max[k]) } else { room.min[k] }
    }))
}

/// What is drawn for one round of the local step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    pub(crate) seed: u64,
    pub(crate) number: u64,
    pub(crate) tries: usize,
}

/// What one round of the local step found.
pub(crate) struct Matched<const D: usize> {
    pub(crate) matches: Matches<D>,
    /// `T` before and after.
    pub(crate) energy: (f64, f64),
}

/// The best matches that one round finds; none is worse than before.
pub(crate) fn matching<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    before: &Matches<D>,
    around: &Lists,
    round: (Round, &Budget),
) -> Result<Matched<D>> {
    let (round, budget) = round;
    let own = own(level, output, near);
    let points = near.windows.turned_round(level.sites.len());
    let room = room(level);
    let found: Result<Vec<(f64, Match<D>)>> = (0..level.open)
        .into_par_iter()
        .with_min_len(4)
        .map(|q| {
            let view = View::new(level, q, output, &own, points.of(q));
            let now = Match { m: before.places[q], error: view.error(level, &before.places[q]) };
            let stride = (view.len() / FEW).max(1);
            let mut candidates = Vec::new();
            let mass = view.mass();
            let held = |m: &Vector<D>| level.tables.back.mass(&m.0) / level.tables.known.share(&m.0).max(0.05);
            let off = |m: &Vector<D>| (held(m) - mass).abs();
            let least = off(&now.m).max(FULL * mass);
            let emptiest = EMPTIER * held(&now.m).min(level.usual);
            let mut consider = |m: Vector<D>| {
                if off(&m) <= least && held(&m) >= emptiest {
                    candidates.push(Match { m, error: view.rough(level, &m, stride) })
                }
            };
            for &other in around.of(q) {
                let other = other as usize;
                let step = level.sites[other].seen(level.domain.offset(level.sites[other].place, level.sites[q].place));
                let m = Vector(std::array::from_fn(|k| {
                    before.places[other][k] + if level.pattern.base[k] { step[k] } else { 0.0 }
                }));
                if room.contains(m) && (m - now.m).norm() > 0.3 * level.tables.kernel.sigma {
                    consider(m);
                }
            }
            let mut stream = Stream::new(round.seed, TRIES, round.number << 32 | q as u64);
            (0..round.tries).for_each(|_| consider(anywhere(&room, &mut stream)));
            if !level.shifts.is_empty() {
                let m = now.m + level.shifts[stream.below(level.shifts.len())];
                if room.contains(m) {
                    consider(m);
                }
            }
            budget.spend(((candidates.len() + 3 * STEPS * BEST) * view.len()) as u64 * 30 + 200)?;
            candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
            candidates.truncate(BEST);
            let exact = |c: Match<D>| Match { error: view.error(level, &c.m), ..c };
            let start =
                candidates.into_iter().map(exact).fold(now.clone(), |a, b| if b.error < a.error { b } else { a });
            let best = view.refined(level, &room, start);
            let best = if best.error < now.error - BETTER * now.error.abs() { best } else { now.clone() };
            Ok((now.error, best))
        })
        .collect();
    let found = found?;
    let total = |error: &dyn Fn(&(f64, Match<D>)) -> f64| -> f64 {
        found.iter().zip(level.sites).map(|(f, s)| s.weight * error(f)).sum()
    };
    let energy = (total(&|f| f.0), total(&|f| f.1.error));
    let mut places = before.places.clone();
    places.iter_mut().zip(found).for_each(|(place, f)| *place = f.1.m);
    Ok(Matched { matches: Matches::new(level, places), energy })
}

/// For each point the sum over its pairs, itself among them.
pub(crate) fn own<const D: usize>(level: &Level<'_, D>, output: &Output<D>, near: &Near) -> Vec<f64> {
    (0..output.places.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|i| {
            let scale = near.windows.of(i).iter().map(|&q| level.sites[q as usize].scale).sum::<f64>()
                / near.windows.of(i).len().max(1) as f64;
            let (x, a) = (output.places[i], &output.weights[i]);
            let mut sum = f64::from(crate::exemplar::channels::inner(a, a));
            for k in near.pairs.span(i) {
                let r2 = level.domain.offset(x, output.places[near.pairs.items()[k] as usize]).norm2();
                sum += level.pair(r2, scale, scale) * near.alike(output, i, k);
            }
            sum
        })
        .collect()
}
