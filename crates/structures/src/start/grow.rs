//! Grown from a seed: one site after the other, outwards; each looks for the match that goes best with what is there already, and adds what
//! the match has nearest to it.

use std::collections::VecDeque;

use arabesque_core::{Bounds, Budget, Result, Similarity, Stage, Stream, Vector};
use rayon::prelude::*;

use super::cells::Cells;
use crate::{
    energy::{level::Level, links::Lists},
    exemplar::{
        bodies::LOOSE,
        channels::{Weights, inner},
    },
    output::state::Output,
    solve::matching::{anywhere, room},
};

/// Work for a point that is looked at, and for one that may be laid.
const SEEN: u64 = 6;
const LAY: u64 = 300;

/// Random matches of each site.
const TRIES: Stage = Stage::new(42);
/// How many of them.
const RANDOM: usize = 28;
/// What it costs to go on elsewhere in the exemplar, as a share of all that a window holds.
const JUMP: f64 = 0.1;
/// Points that matches are compared by.
const FEW: usize = 150;
/// Matches that are looked at more closely.
const BEST: usize = 4;
/// How far a site looks at what is there, in units of the window; less where there is much to look at.
const LOOK: [f64; 4] = [1.8, 1.8, 1.8, 1.3];
/// Cells of the map of what is there, in one step of the sites.
const CELLS: [f64; 4] = [2.5, 2.5, 2.5, 1.7];
/// Jumps cost more where the exemplar ends soon after them, as the next one comes sooner; down to this share of its length.
const SHORTEST: f64 = 0.2;
/// Share of what is there already of which the exemplar must show the counterpart around a match.
const SHOWN: f64 = 0.75;
/// A place belongs to the site nearest to it, within so many steps.
const NEAREST: f64 = 1.1;
/// A new point is no nearer to one like it than this, in spacings.
const APART: f64 = 0.5;

/// The output while it grows.
struct Growth<'a, 'b, const D: usize> {
    level: &'a Level<'b, D>,
    output: Output<D>,
    cells: Cells<D>,
    /// For each point the sum over its pairs.
    own: Vec<f64>,
    /// The same for the points of the exemplar.
    own_exemplar: Vec<f64>,
    done: Vec<bool>,
    matches: Vec<Vector<D>>,
    step: f64,
}

/// Grows on from an output, and from the matches of the sites that show it already. Gives the output and the match of each site.
pub(crate) fn grow<const D: usize>(
    level: &Level<'_, D>,
    (begun, done): (Output<D>, &[Option<Vector<D>>]),
    around: &Lists,
    step: f64,
    seed: u64,
    budget: &Budget,
) -> Result<(Output<D>, Vec<Vector<D>>)> {
    let radius = level.tables.kernel.pairs();
    let at = |q: usize| done.get(q).copied().flatten();
    let mut growth = Growth {
        level,
        output: begun,
        cells: Cells::new(radius, level.domain),
        own: Vec::new(),
        own_exemplar: own_exemplar(level),
        done: (0..level.sites.len()).map(|q| at(q).is_some()).collect(),
        matches: (0..level.sites.len()).map(|q| at(q).unwrap_or(Vector::ZERO)).collect(),
        step,
    };
    growth.enter_from(0);
    let room = room(level);
    let order = order(level, around, &growth.done, seed);
    for q in order {
        growth.site(q, around.of(q), &room, seed, budget)?;
    }
    Ok((growth.output, growth.matches))
}

/// The sites from those that are done outwards, or from any one.
fn order<const D: usize>(level: &Level<'_, D>, around: &Lists, done: &[bool], seed: u64) -> Vec<usize> {
    let n = level.sites.len();
    let first = Stream::new(seed, TRIES, u64::MAX).below(n);
    let mut seen = done.to_vec();
    let mut order = Vec::with_capacity(n);
    let mut outwards = |mut queue: VecDeque<usize>, seen: &mut Vec<bool>| {
        while let Some(q) = queue.pop_front() {
            if !done[q] {
                order.push(q);
            }
            for &next in around.of(q) {
                if !std::mem::replace(&mut seen[next as usize], true) {
                    queue.push_back(next as usize);
                }
            }
        }
    };
    outwards((0..n).filter(|&q| done[q]).collect(), &mut seen);
    for start in (first..n).chain(0..first) {
        if !std::mem::replace(&mut seen[start], true) {
            outwards(VecDeque::from([start]), &mut seen);
        }
    }
    order
}

/// For each point of the exemplar the sum over its pairs, as far as that is known.
fn own_exemplar<const D: usize>(level: &Level<'_, D>) -> Vec<f64> {
    let pattern = level.pattern;
    (0..pattern.points.len())
        .into_par_iter()
        .map(|i| {
            let mut sum = 0.0;
            pattern.index.within(pattern.points.positions[i], level.tables.kernel.pairs(), |j, r| {
                sum += level.pair(r.norm2(), 1.0, 1.0) * f64::from(inner(&pattern.weights[i], &pattern.weights[j]));
            });
            sum * f64::from(level.tables.known.at(&pattern.points.positions[i].0.map(|x| x as f32)))
        })
        .collect()
}

/// A point that is there already, as a site sees it.
struct There<const D: usize> {
    u: [f64; D],
    weights: Weights,
    weight: f32,
    /// The sum over its pairs.
    own: f32,
}

/// Which cells around a site belong to sites that are done.
struct Map<const D: usize> {
    half: i64,
    cell: f64,
    base: [bool; D],
    done: Vec<bool>,
}

impl<const D: usize> Map<D> {
    /// The map without cells next to one that is not done: what lies there has neighbours in the exemplar that are still to come.
    fn eroded(mut self) -> Self {
        let side = 2 * self.half + 1;
        let mut stride = 1;
        for _ in (0..D).filter(|&k| self.base[k]) {
            let before = self.done.clone();
            for (n, done) in self.done.iter_mut().enumerate() {
                let at = n as i64 / stride % side;
                *done &= at == 0 || before[(n as i64 - stride) as usize];
                *done &= at == side - 1 || before[(n as i64 + stride) as usize];
            }
            stride *= side;
        }
        self
    }

    fn at(&self, v: &[f64; D]) -> bool {
        let (mut index, mut stride) = (0_i64, 1);
        for k in 0..D {
            if self.base[k] {
                let c = (v[k] / self.cell).round() as i64;
                if c.abs() > self.half {
                    return false;
                }
                index += (c + self.half) * stride;
                stride *= 2 * self.half + 1;
            }
        }
        self.done[index as usize]
    }
}

impl<const D: usize> Growth<'_, '_, D> {
    fn add(&mut self, place: Vector<D>, weights: Weights) {
        self.enter(place, &weights);
        self.output.add(place, weights);
    }

    /// Takes note of all points of the output from this one on, one by one, so that they know of each other.
    fn enter_from(&mut self, first: usize) {
        for n in first..self.output.places.len() {
            let weights = self.output.weights[n];
            self.enter(self.output.places[n], &weights);
        }
    }

    /// Takes note of a point that comes next in the output.
    fn enter(&mut self, place: Vector<D>, weights: &Weights) {
        let level = self.level;
        let mut own = f64::from(inner(weights, weights));
        let (output, others) = (&self.output, &mut self.own);
        self.cells.within(level.domain, place, level.tables.kernel.pairs(), |i, r| {
            let h = level.pair(r.norm2(), 1.0, 1.0) * f64::from(inner(weights, &output.weights[i]));
            own += h;
            others[i] += h;
        });
        self.own.push(own);
        self.cells.add(place);
    }

    fn map(&self, q: usize) -> Map<D> {
        let level = self.level;
        let site = &level.sites[q];
        let cell = self.step / CELLS[level.pattern.repeats()];
        let half = (LOOK[level.pattern.repeats()] * level.tables.kernel.delta / cell).ceil() as i64;
        let base = level.pattern.base;
        let side = 2 * half + 1;
        let count = side.pow(base.iter().filter(|b| **b).count() as u32) as usize;
        let done = if level.domain.period().is_none() {
            self.claimed(q, (half, cell), count)
        } else {
            // A site may be nearest to several cells, each of them another way around.
            let asked = |n: usize| {
                let mut rest = n as i64;
                let offset = Vector(std::array::from_fn(|k| {
                    if !base[k] {
                        return 0.0;
                    }
                    let c = rest % side - half;
                    rest /= side;
                    c as f64 * cell
                }));
                let p = site.place + site.shown(offset);
                level.index.nearest(p, NEAREST * self.step * site.scale).is_some_and(|s| self.done[s])
            };
            (0..count).map(asked).collect()
        };
        Map { half, cell, base, done }.eroded()
    }

    /// For each cell around site `q` whether the site nearest to it is done. The sites are gone through once, and each claims the cells that
    /// none before it is nearer to.
    fn claimed(&self, q: usize, (half, cell): (i64, f64), count: usize) -> Vec<bool> {
        let level = self.level;
        let (site, base) = (&level.sites[q], level.pattern.base);
        let side = 2 * half + 1;
        let reach = NEAREST * self.step;
        let radius = (half as f64 + 0.5) * cell * (level.pattern.repeats() as f64).sqrt() + reach;
        let mut nearest = vec![(reach * reach, usize::MAX); count];
        level.index.around(site.place, radius * site.scale, |s, offset| {
            let at = site.seen(offset);
            let span = |k: usize| -> (i64, i64) {
                if !base[k] {
                    return (0, 1);
                }
                let low = (((at[k] - reach) / cell).ceil() as i64).max(-half);
                let high = (((at[k] + reach) / cell).floor() as i64).min(half);
                (low, (high - low + 1).max(0))
            };
            let spans: [(i64, i64); D] = std::array::from_fn(span);
            for n in 0..spans.iter().map(|s| s.1).product::<i64>() {
                let (mut rest, mut index, mut stride, mut far) = (n, 0, 1, 0.0);
                for k in 0..D {
                    let c = spans[k].0 + rest % spans[k].1;
                    rest /= spans[k].1;
                    let off = c as f64 * cell - at[k];
                    far += off * off;
                    if base[k] {
                        index += (c + half) * stride;
                        stride *= side;
                    }
                }
                let best = &mut nearest[index as usize];
                if (far, s) < *best {
                    *best = (far, s);
                }
            }
        });
        nearest.into_iter().map(|(_, s)| s != usize::MAX && self.done[s]).collect()
    }

    /// What is there around site `q`.
    fn there(&self, q: usize, map: &Map<D>) -> Vec<There<D>> {
        let (level, site) = (self.level, &self.level.sites[q]);
        let look = LOOK[level.pattern.repeats()] * level.tables.kernel.delta;
        let across = 1.3 * level.pattern.thickness + level.pattern.spacing;
        let radius = (look * look * level.pattern.repeats() as f64 + across * across).sqrt() * site.scale;
        let mut there = Vec::new();
        self.cells.within(level.domain, site.place, radius, |i, offset| {
            let u = site.seen(offset);
            let near = (0..D).all(|k| u[k].abs() <= if level.pattern.base[k] { look } else { across });
            let weight = level.tables.kernel.weight(&u);
            if near && weight > 0.0 && map.at(&u) {
                let weights = level.pattern.channels.turned_back(&self.output.weights[i], &site.rotation);
                there.push(There { u, weights, weight: weight as f32, own: self.own[i] as f32 });
            }
        });
        there
    }

    /// How badly a match goes with what is there; `roughly` where that is to tell good ones from bad ones alone.
    fn error(&self, there: &[There<D>], map: &Map<D>, m: &Vector<D>, roughly: bool) -> f64 {
        let stride = if roughly { (there.len() / FEW).max(1) } else { 1 };
        let (tables, pattern) = (self.level.tables, self.level.pattern);
        let (mut sum, mut shown, mut all) = (0.0_f64, 0.0_f64, 1e-12_f64);
        for p in there.iter().step_by(stride) {
            let y = std::array::from_fn(|k| (m[k] + p.u[k]) as f32);
            let known = tables.known.at(&y);
            shown += f64::from(known * p.weight);
            all += f64::from(p.weight);
            if known > 0.0 {
                let wanted =
                    if roughly { tables.field.glimpse(&y, &p.weights) } else { tables.field.project(&y, &p.weights) };
                sum += f64::from(known * p.weight * (p.own - 2.0 * wanted));
            }
        }
        let look = LOOK[pattern.repeats()] * tables.kernel.delta;
        let along = (look * look * pattern.repeats() as f64).min(tables.kernel.reach() * tables.kernel.reach());
        let radius = (along + pattern.thickness * pattern.thickness * 1.1).sqrt();
        pattern.index.within(*m, radius, |j, v| {
            if j % stride == 0 && map.at(&v.0) {
                sum += tables.kernel.weight(&v.0) * self.own_exemplar[j];
            }
        });
        // A match next to the border of the exemplar, beyond which nothing is known, would go with anything.
        let shown = shown / all;
        let blind = (SHOWN - shown).max(0.0) * tables.back.at(&pattern.bounds.centre().0).0;
        sum * stride as f64 / shown.max(0.1) + blind
    }

    /// How far growth can go on from `m` until the exemplar ends, as a share of all of it: from the sites around `q` that are done, past it.
    fn run(&self, q: usize, around: &[u32], room: &Bounds<D>) -> impl Fn(&Vector<D>) -> f64 + use<D> {
        let level = self.level;
        let from = around.iter().filter(|o| self.done[**o as usize]);
        let outwards = from.fold(Vector::ZERO, |sum, &o| {
            sum + level.domain.offset(level.sites[o as usize].place, level.sites[q].place)
        });
        let along = Vector(level.sites[q].seen(outwards));
        let (along, room, base) = (along.unit_or_zero(), *room, level.pattern.base);
        move |m| {
            let share = |k: usize| {
                let left = if along[k] > 0.0 { room.max[k] - m[k] } else { m[k] - room.min[k] };
                left / (room.max[k] - room.min[k]).max(1e-12) / along[k].abs()
            };
            (0..D).filter(|&k| base[k] && along[k].abs() > 0.1).map(share).fold(1.0, f64::min)
        }
    }

    fn site(&mut self, q: usize, around: &[u32], room: &Bounds<D>, seed: u64, budget: &Budget) -> Result<()> {
        let level = self.level;
        let map = self.map(q);
        let there = self.there(q, &map);
        let mut stream = Stream::new(seed, TRIES, q as u64);
        let mut best = anywhere(room, &mut stream);
        if around.iter().any(|&o| self.done[o as usize]) {
            let mut random: Vec<Vector<D>> = (0..RANDOM).map(|_| anywhere(room, &mut stream)).collect();
            let mut carried = Vec::new();
            for &other in around {
                let other = other as usize;
                if self.done[other] {
                    let step =
                        level.sites[other].seen(level.domain.offset(level.sites[other].place, level.sites[q].place));
                    let m = Vector(std::array::from_fn(|k| {
                        self.matches[other][k] + if level.pattern.base[k] { step[k] } else { 0.0 }
                    }));
                    if room.contains(m) {
                        carried.push(m);
                    }
                    random.extend(level.shifts.iter().map(|&t| m + t).filter(|m| room.contains(*m)));
                }
            }
            budget.spend(((RANDOM + 20) * (there.len() * 30 + 1000)) as u64)?;
            let rate = |m: &Vector<D>| self.error(&there, &map, m, false);
            let rough = |m: &Vector<D>| self.error(&there, &map, m, true);
            let jump = JUMP * level.tables.back.at(&level.pattern.bounds.centre().0).0;
            let carried: Vec<(f64, Vector<D>)> = carried.into_iter().map(|m| (rate(&m), m)).collect();
            if carried.iter().any(|c| c.0 < jump) {
                // No other match can make up for the jump.
                random.clear();
            }
            let run = self.run(q, around, room);
            let mut rated: Vec<(f64, Vector<D>)> =
                random.par_iter().map(|m| (rough(m) / run(m).max(SHORTEST), *m)).collect();
            rated.sort_by(|a, b| a.0.total_cmp(&b.0));
            rated.truncate(BEST);
            let refined = rated.into_iter().map(|(_, m)| {
                if level.pattern.repeats() > 2 {
                    // There is much to look at in a volume: from where a match is, any share of it tells which way to go.
                    let m = self.refined((rough(&m), m), room, &rough).1;
                    (rate(&m), m)
                } else {
                    self.refined((rate(&m), m), room, &rate)
                }
            });
            let refined = refined.map(|(e, m)| ((e + jump) / run(&m).max(SHORTEST), m));
            let first = carried.into_iter().chain(refined).min_by(|a, b| a.0.total_cmp(&b.0));
            best = first.map_or(best, |b| b.1);
        }
        self.matches[q] = best;
        self.done[q] = true;
        self.lay(q, best, budget)
    }

    /// Looks around a match along each direction of the base, closer and closer.
    fn refined(
        &self,
        start: (f64, Vector<D>),
        room: &Bounds<D>,
        rate: &impl Fn(&Vector<D>) -> f64,
    ) -> (f64, Vector<D>) {
        let mut best = start;
        let mut step = 0.7 * self.level.tables.kernel.sigma;
        for _ in 0..4 {
            for k in (0..D).filter(|&k| self.level.pattern.base[k]) {
                for sign in [-1.0, 1.0] {
                    let mut m = best.1;
                    m[k] += sign * step;
                    if room.contains(m) {
                        let error = rate(&m);
                        if error < best.0 {
                            best = (error, m);
                        }
                    }
                }
            }
            step *= 0.5;
        }
        best
    }

    /// Adds what the match of site `q` has nearest to it and nothing is there for yet.
    fn lay(&mut self, q: usize, m: Vector<D>, budget: &Budget) -> Result<()> {
        let (level, pattern) = (self.level, self.level.pattern);
        let site = &level.sites[q];
        let own = self.step;
        let radius = (own * own * pattern.repeats() as f64 + 1.1 * pattern.thickness * pattern.thickness).sqrt();
        let mut new: Vec<usize> = Vec::new();
        let looked = pattern.index.within(m, radius, |j, _| new.push(j));
        budget.spend(looked * SEEN + new.len() as u64 * LAY)?;
        // Of a domain that is thinner than a window, most of what is laid lies around it.
        let most = budget.limits().output_elements;
        budget.within("points in and around what is filled", self.output.places.len(), ("output-elements", most))?;
        for j in new {
            let body = pattern.body_of[j] as usize;
            let middle = pattern.bodies.get(body).map_or(pattern.points.positions[j], |b| b.centre);
            if pattern.body_of[j] != LOOSE && pattern.bodies[body].members[0] != j {
                continue;
            }
            let offset = middle - m;
            let along = Vector(std::array::from_fn(|k| if pattern.base[k] { offset[k] } else { 0.0 }));
            let foot = site.place + site.shown(along);
            if level.index.nearest(foot, 1.6 * self.step * site.scale) != Some(q) {
                continue;
            }
            if pattern.body_of[j] == LOOSE {
                let place = site.place + site.shown(offset);
                let weights = pattern.channels.turned(&pattern.weights[j], &site.rotation);
                if self.is_free(place, &weights, APART * pattern.spacing * site.scale) {
                    self.add(place, weights);
                }
            } else {
                self.lay_body(body, Similarity::about(m, site.place, site.rotation, site.scale));
            }
        }
        Ok(())
    }

    fn is_free(&self, place: Vector<D>, weights: &Weights, radius: f64) -> bool {
        let mut free = true;
        self.cells.within(self.level.domain, place, radius, |i, _| {
            free &= inner(weights, &self.output.weights[i]) <= 0.0;
        });
        free
    }

    fn lay_body(&mut self, source: usize, pose: Similarity<D>) {
        let pattern = self.level.pattern;
        let members = &pattern.bodies[source].members;
        let radius = pattern.gaps.laid(pattern.spacing) * pose.scale;
        let blocked = members.iter().any(|&i| {
            let mut blocked = false;
            self.cells.within(self.level.domain, pose.apply(pattern.points.positions[i]), radius, |n, _| {
                blocked |= self.output.body_of[n] != LOOSE;
            });
            blocked
        });
        if !blocked {
            let first = self.output.places.len();
            self.output.add_body(pattern, source, pose);
            self.enter_from(first);
        }
    }
}
