//! Sampling control [Roveri 2015 §5.1, eq. 7]: points are added where the output has less than the exemplar, and removed where it has more.
//!
//! Adding a point with weights `b` at `x` changes `T` by `P(x) |b|^2 - 2 b.r(x)`, where `r` is what the matches want there beyond what all
//! points give; removing one of weights `a` changes it by `2 a.r' - P |a|^2` with `r'` the same without the point. So a point is worth its place
//! when it makes up at least half of itself, and every change is kept only if `T` falls by it.
//!
//! Where matches do not agree yet, what they want is blurred, and no point makes up half of itself; that is no reason to remove it as long as
//! there are not more points than the matches have: `P` of the paper decides then.

use arabesque_core::{Budget, GridIndex, Result, Similarity, Vector};
use rayon::prelude::*;

use crate::{
    each::each,
    energy::level::{Level, Matches, Near, Pull},
    exemplar::{
        bodies::LOOSE,
        channels::{LANES, Weights, inner},
    },
    output::state::Output,
};

/// A change must lower the energy by this share of what one point weighs.
const WORTH: f64 = 0.04;
/// A point goes, however many there are, when it makes up less of itself than this leaves over, halved.
const STRAY: f64 = 0.97;
/// Nothing but strays is removed where there are fewer points than in the exemplar in the mean, by this share.
const EMPTIEST: f64 = -0.04;
/// The same for rigid elements, of which each is many points.
const FULLEST: f64 = 0.04;
/// What is added is no nearer to a point like it than this, in units of the spacing.
const APART: f64 = 0.45;

/// Work for each point that is seen by a site, and for each pair of points.
const SEEN: u64 = 12;
const PAIR: u64 = 20;

/// Places at which points were added, and at which some were removed.
pub(crate) struct Changed<const D: usize> {
    pub(crate) added: Vec<Vector<D>>,
    pub(crate) removed: Vec<Vector<D>>,
}

/// Adds and removes points.
pub(crate) fn control<const D: usize>(
    level: &Level<'_, D>,
    output: &mut Output<D>,
    near: &Near,
    matches: &Matches<D>,
    pulls: &[Pull<D>],
    budget: &Budget,
) -> Result<Changed<D>> {
    let surplus = surplus(level, output, near, matches, budget)?;
    let goes = remove(level, output, near, (pulls, &surplus), budget)?;
    let removed: Vec<_> = output.places.iter().zip(&goes).filter(|(_, goes)| **goes).map(|(p, _)| *p).collect();
    if !removed.is_empty() {
        *output = output.filtered(level.pattern, |i| !goes[i]);
    }
    let before = output.places.len();
    add(level, output, matches, budget)?;
    Ok(Changed { added: output.places[before..].to_vec(), removed })
}

/// By how many points windows have more than something, for each point in the mean over those it is in.
struct Surplus {
    /// More than their matches [Roveri 2015 eq. 7].
    matched: Vec<f64>,
    /// More than windows of the exemplar have in the mean, as a share of that.
    usual: Vec<f64>,
}

fn surplus<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    matches: &Matches<D>,
    budget: &Budget,
) -> Result<Surplus> {
    let points = near.windows.turned_round(level.sites.len());
    let seen = |q: usize, i: usize| {
        let site = &level.sites[q];
        let u = site.seen(level.domain.offset(site.place, output.places[i]));
        let known = level.tables.known.at(&std::array::from_fn(|k| (matches.places[q][k] + u[k]) as f32));
        (level.tables.kernel.weight(&u), f64::from(known))
    };
    let of_sites = each(
        level.open,
        budget,
        |q| points.of(q).len() as u64 * SEEN,
        |q| {
            let sums =
                points.of(q).iter().map(|&i| seen(q, i as usize)).fold((0.0, 0.0), |s, (w, k)| (s.0 + w * k, s.1 + w));
            (sums.0 - level.tables.back.mass(&matches.places[q].0), sums.1 / level.usual - 1.0)
        },
    )?;
    let means = each(
        output.places.len(),
        budget,
        |i| near.windows.of(i).len() as u64 * SEEN,
        |i| {
            let (mut matched, mut usual, mut weight) = (0.0, 0.0, 1e-12);
            // What the windows of the other sites hold is not all here.
            for &q in near.windows.of(i).iter().filter(|q| (**q as usize) < level.open) {
                let (w, _) = seen(q as usize, i);
                matched += w * of_sites[q as usize].0;
                usual += w * of_sites[q as usize].1;
                weight += w;
            }
            (matched / weight, usual / weight)
        },
    )?;
    let (matched, usual) = means.into_iter().unzip();
    Ok(Surplus { matched, usual })
}

/// Which points go, the most superfluous first, each with the ones before it gone.
fn remove<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    near: &Near,
    (pulls, surplus): (&[Pull<D>], &Surplus),
    budget: &Budget,
) -> Result<Vec<bool>> {
    let n = output.places.len();
    let pair = |i: usize, j: usize| {
        let r2 = level.domain.offset(output.places[i], output.places[j]).norm2();
        level.pair(r2, pulls[i].scale, pulls[j].scale)
            * 0.5
            * (pulls[i].cover + pulls[j].cover)
            * f64::from(inner(&output.weights[i], &output.weights[j]))
    };
    // T without a point, less T with it, per point; elements sum over theirs.
    let mut change = each(
        n,
        budget,
        |i| near.pairs.of(i).len() as u64 * PAIR,
        |i| {
            let own = f64::from(inner(&output.weights[i], &output.weights[i])) * pulls[i].cover;
            2.0 * pulls[i].wanted - 2.0 * near.pairs.of(i).iter().map(|&j| pair(i, j as usize)).sum::<f64>() - own
        },
    )?;
    let members = |i: usize| output.members(i);
    let worth = |change: &[f64], i: usize| {
        let all = members(i);
        let mut sum: f64 = all.clone().map(|k| change[k]).sum();
        // Pairs within an element go once, not twice.
        for a in all.clone().filter(|_| all.len() > 1) {
            sum += near
                .pairs
                .of(a)
                .iter()
                .filter(|j| all.contains(&(**j as usize)))
                .map(|&j| pair(a, j as usize))
                .sum::<f64>();
        }
        let weight: f64 = all.map(|k| f64::from(inner(&output.weights[k], &output.weights[k])) * pulls[k].cover).sum();
        sum / weight.max(1e-30)
    };
    let mut removed = cutting(level, output, |i| worth(&change, i), budget)?;
    let heads: Vec<usize> = (output.kept..n).filter(|&i| members(i).start == i).collect();
    let mut order: Vec<(f64, usize)> =
        heads.into_iter().map(|i| (worth(&change, i), i)).filter(|c| c.0 < -WORTH).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut gone = vec![0.0; n];
    let own = own_share(level);
    for (_, i) in order {
        if removed[i] {
            continue;
        }
        // Fewer points in the windows of this one by those that went.
        let rigid = output.body_of[i] != LOOSE;
        let least = if rigid { FULLEST } else { EMPTIEST };
        let own = if rigid { own * members(i).len() as f64 } else { 0.0 };
        let enough = surplus.usual[i] - gone[i] / level.usual > least + own;
        let least = match (enough, surplus.matched[i] - gone[i] > 0.5) {
            (true, true) => -WORTH,
            // There is a place for a whole element, if not this one.
            (false, _) if rigid => continue,
            _ => -STRAY,
        };
        if worth(&change, i) >= least {
            continue;
        }
        for a in members(i) {
            removed[a] = true;
            for &j in near.pairs.of(a) {
                if !removed[j as usize] {
                    gone[j as usize] += 1.0;
                    change[j as usize] += 2.0 * pair(a, j as usize);
                }
            }
        }
    }
    Ok(removed)
}

/// What one of the points of an element adds to the windows that hold it, in the mean as far as they do, as a share of what windows hold. An
/// element sees itself: where there are as many as usual, there are more by that around each of them. Of mixtures, the continuous part says how many
/// there are.
fn own_share<const D: usize>(level: &Level<'_, D>) -> f64 {
    let gaps = &level.pattern.gaps;
    if gaps.usual().is_none() || gaps.is_mixed() {
        return 0.0;
    }
    0.5_f64.powf(0.5 * level.pattern.repeats() as f64) / level.usual.max(1e-12)
}

/// Of elements that cut into each other those that are worth less. They go in any case.
fn cutting<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    worth: impl Fn(usize) -> f64,
    budget: &Budget,
) -> Result<Vec<bool>> {
    let mut removed = vec![false; output.places.len()];
    let clear = level.pattern.gaps.cutting();
    if clear <= 0.0 || output.bodies.len() < 2 {
        return Ok(removed);
    }
    let index =
        GridIndex::new(&output.places, clear * level.sites.iter().map(|s| s.scale).fold(0.0, f64::max), level.domain);
    let mut meter = budget.meter();
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for body in &output.bodies {
        let mut others = std::collections::BTreeSet::new();
        for i in body.first..body.first + body.count {
            let looked = index.within(output.places[i], clear * body.pose.scale, |j, _| {
                if output.body_of[j] != LOOSE && output.body_of[j] != output.body_of[i] {
                    others.insert(output.members(j).start);
                }
            });
            meter.spend(20 + 6 * looked)?;
        }
        let own = worth(body.first);
        for other in others {
            let theirs = worth(other);
            // Each pair once, by the one that goes.
            if (own, body.first) < (theirs, other) {
                pairs.push((own, body.first, other));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, goes, stays) in pairs {
        if !removed[goes] && !removed[stays] && !output.is_kept(goes) {
            removed[output.members(goes)].fill(true);
        }
    }
    Ok(removed)
}

/// Something of the exemplar that could be added.
struct Offer<const D: usize> {
    place: Vector<D>,
    weights: Weights,
    /// The element it stands for, where it is one, with its pose.
    body: Option<(usize, Similarity<D>)>,
    worth: f64,
}

/// Adds what is missing, the most wanted first, each with the ones before it there.
fn add<const D: usize>(
    level: &Level<'_, D>,
    output: &mut Output<D>,
    matches: &Matches<D>,
    budget: &Budget,
) -> Result<()> {
    let clear = level.pattern.gaps.least(level.pattern.spacing);
    let radius = level.tables.kernel.pairs().max(clear) * level.sites.iter().map(|s| s.scale).fold(0.0, f64::max);
    let index = GridIndex::new(&output.places, radius, level.domain);
    let offers: Result<Vec<Vec<Offer<D>>>> = (0..level.open)
        .into_par_iter()
        .with_min_len(8)
        .map(|q| {
            let offers = offers(level, output, matches, &index, q);
            budget.spend(500)?;
            Ok(offers)
        })
        .collect();
    let mut offers: Vec<Offer<D>> = offers?.into_iter().flatten().collect();
    offers.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    // What was added, in cells, for those that come after.
    let mut fresh: Vec<(Vector<D>, Weights, bool)> = Vec::new();
    let mut cells: std::collections::HashMap<[i64; D], Vec<u32>> = std::collections::HashMap::new();
    let cell = |p: Vector<D>| -> [i64; D] { std::array::from_fn(|k| (p[k] / radius).floor() as i64) };
    for offer in offers {
        let members = members(level, &offer);
        let mut sum = 0.0;
        let mut weight = 0.0;
        let mut crowded = false;
        for (place, weights) in &members {
            let place = level.domain.wrap(*place);
            let mut given = 0.0;
            let home = cell(place);
            for n in 0..3_usize.pow(D as u32) {
                let mut rest = n;
                let at: [i64; D] = std::array::from_fn(|k| {
                    let off = (rest % 3) as i64 - 1;
                    rest /= 3;
                    home[k] + off
                });
                for &f in cells.get(&at).into_iter().flatten() {
                    let (p, w, rigid) = &fresh[f as usize];
                    let r2 = level.domain.offset(place, *p).norm2();
                    given += level.pair(r2, 1.0, 1.0) * f64::from(inner(weights, w));
                    crowded |= match &offer.body {
                        Some((_, pose)) => *rigid && r2.sqrt() < clear * pose.scale,
                        None => r2.sqrt() < APART * level.pattern.spacing,
                    };
                }
            }
            let own = f64::from(inner(weights, weights));
            sum += given;
            weight += own;
        }
        if crowded || offer.worth - 2.0 * sum / weight.max(1e-30) < WORTH {
            continue;
        }
        for (place, weights) in &members {
            let place = level.domain.wrap(*place);
            cells.entry(cell(place)).or_default().push(fresh.len() as u32);
            fresh.push((place, *weights, offer.body.is_some()));
        }
        match offer.body {
            Some((source, pose)) => output.add_body(level.pattern, source, pose),
            None => output.add(offer.place, offer.weights),
        }
    }
    Ok(())
}

/// The points that an offer consists of.
fn members<const D: usize>(level: &Level<'_, D>, offer: &Offer<D>) -> Vec<(Vector<D>, Weights)> {
    match &offer.body {
        None => vec![(offer.place, offer.weights)],
        Some((source, pose)) => level.pattern.bodies[*source]
            .members
            .iter()
            .map(|&i| {
                let weights = level.pattern.channels.turned(&level.pattern.weights[i], &pose.rotation);
                (pose.apply(level.pattern.points.positions[i]), weights)
            })
            .collect(),
    }
}

/// What site `q` would add near itself: points of the exemplar under its match that the output does not make up for.
fn offers<const D: usize>(
    level: &Level<'_, D>,
    output: &Output<D>,
    matches: &Matches<D>,
    index: &GridIndex<D>,
    q: usize,
) -> Vec<Offer<D>> {
    let (pattern, site, m) = (level.pattern, &level.sites[q], matches.places[q]);
    let own = 0.75 * level.tables.kernel.delta;
    let mut offers = Vec::new();
    let reach = (own * own * pattern.repeats() as f64 + 1.7 * pattern.thickness * pattern.thickness).sqrt();
    pattern.index.within(m, reach, |j, offset| {
        let near = (0..D).all(|k| !pattern.base[k] || offset[k].abs() <= own);
        if !near {
            return;
        }
        let body = pattern.body_of[j];
        if body != LOOSE {
            let body = body as usize;
            if pattern.bodies[body].members[0] != j {
                return;
            }
            let pose = Similarity::about(m, site.place, site.rotation, site.scale);
            offers.push(Offer { place: Vector::ZERO, weights: [0.0; LANES], body: Some((body, pose)), worth: 0.0 });
        } else {
            let place = site.place + site.shown(offset);
            let weights = pattern.channels.turned(&pattern.weights[j], &site.rotation);
            offers.push(Offer { place, weights, body: None, worth: 0.0 });
        }
    });
    offers.retain_mut(|offer| {
        let members = members(level, offer);
        let apart = APART * pattern.spacing * site.scale;
        let clear = pattern.gaps.least(pattern.spacing) * site.scale;
        let mut crowded = false;
        for (place, weights) in &members {
            match offer.body {
                Some(_) => index.within(*place, clear, |i, _| crowded |= output.body_of[i] != LOOSE),
                None => index.within(*place, apart, |i, _| crowded |= inner(weights, &output.weights[i]) > 0.0),
            };
        }
        if crowded {
            return false;
        }
        let (mut wanted, mut weight) = (0.0, 0.0);
        for (n, (place, weights)) in members.iter().enumerate() {
            let mut windows = Vec::new();
            level.index.windows(level.sites, *place, &level.tables.reach, |q, _| windows.push(q as u32));
            let (field, cover) = level.wanted(*place, &windows, matches);
            let mut rest = f64::from(inner(weights, &field));
            index.within(*place, level.tables.kernel.pairs() * site.scale, |i, r| {
                let h = level.pair(r.norm2(), site.scale, site.scale) * cover;
                rest -= h * f64::from(inner(weights, &output.weights[i]));
            });
            // Pairs within an element.
            for (other, w) in &members[..n] {
                let r2 = level.domain.offset(*place, *other).norm2();
                rest -= level.pair(r2, site.scale, site.scale) * cover * f64::from(inner(weights, w));
            }
            let own = f64::from(inner(weights, weights)) * cover;
            wanted += 2.0 * rest - own;
            weight += own;
        }
        offer.worth = wanted / weight.max(1e-30);
        weight > 0.0 && offer.worth > WORTH
    });
    offers
}
