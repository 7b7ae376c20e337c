//! Deciding node by node what is drawn, by what is drawn around such nodes of the exemplar [Efros 1999], then mending what
//! stands nowhere in it.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Budget, DisjointSets, Result, Stage, Stream};

use crate::{
    orderly::ruled::{
        net::{Near, Net},
        star::{Look, Star, beside},
    },
    repeat::lattice::Node,
};

/// Draws of this module.
const GROW: Stage = Stage::new(11);
const MEND: Stage = Stage::new(12);

/// How fast what lies farther off counts less, in steps.
const FALL: f64 = 1.6;
/// What a node that the exemplar does not tell costs, in steps that differ.
const UNTOLD: f64 = 0.4;
/// A step that is drawn already and is not there in what is copied; a ring where the exemplar has none.
const BROKEN: f64 = 100.0;
const RING: f64 = 40.0;
/// Costs within this share, and so many steps, of the least are as good.
const AS_GOOD: (f64, f64) = (0.15, 0.2);
/// What it costs to draw a node as more are drawn than in the exemplar, for each time as many as there should be, and how many are drawn before
/// that is known.
const BALANCE: (f64, f64) = (0.5, 30.0);
/// What it costs to go on copying where a neighbour stopped: patches of the exemplar are not to come again whole.
const COPY: f64 = 0.03;
/// Rounds of mending.
const ROUNDS: usize = 6;
/// Work for each comparison of two nodes.
const COMPARE: u64 = 6;

/// What is compared around nodes, nearest first, with its weight.
struct Context {
    near: Vec<(Near, f64)>,
}

impl Context {
    fn of(net: &Net<'_>, k: usize) -> Self {
        let weight = |o: Node| (-((o[0] * o[0] + o[1] * o[1]) as f64) / (2.0 * FALL * FALL)).exp();
        let mut near: Vec<_> = net.near(k).into_iter().map(|n| (n, weight(n.offset))).collect();
        near.sort_by(|a, b| b.1.total_cmp(&a.1));
        Self { near }
    }

    /// How much what lies around a node of the exemplar differs; may end early beyond `most`.
    fn cost(&self, net: &Net<'_>, at: Node, most: f64) -> f64 {
        let mut cost = 0.0;
        for (near, weight) in &self.near {
            let there = net.sheet.number([at[0] + near.offset[0], at[1] + near.offset[1]]).map(|n| net.sheet.looks[n]);
            cost += weight
                * match there {
                    Some(look) if !look.is_open() => f64::from(near.look.differs(&look)),
                    _ => UNTOLD,
                };
            if cost > most {
                break;
            }
        }
        cost
    }
}

/// Decides everything about all nodes.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn grow(net: &mut Net<'_>, seed: u64, budget: &Budget) -> Result<()> {
    let mut sets = DisjointSets::new(net.nodes.len());
    let mut used: BTreeMap<Look, usize> = BTreeMap::new();
    let mut sources: Vec<Option<u32>> = vec![None; net.nodes.len()];
    for k in 0..net.nodes.len() {
        let context = Context::of(net, k);
        let looked = net.sheet.told.len() * (8 + context.near.len()) + 8 * net.sheet.kinds.len().pow(2);
        budget.spend(COMPARE * looked as u64)?;
        let mut costs: Vec<(f64, u32)> = Vec::new();
        let mut best = f64::INFINITY;
        let copied: Vec<Option<u32>> = (4..8)
            .map(|way| {
                let there = net.number(beside(net.nodes[k], way))?;
                let source = net.sheet.node(sources[there]? as usize);
                net.sheet.number(beside(source, (way + 4) % 8)).map(|n| n as u32)
            })
            .collect();
        let mut known: BTreeMap<Look, f64> = BTreeMap::new();
        for &n in &net.sheet.told {
            let (star, look) = (net.sheet.star(n as usize), net.sheet.looks[n as usize]);
            let misfit = *known.entry(look).or_insert_with(|| misfit(net, k, (star, look), &mut sets));
            let mut cost = misfit + if breaks_crossing(net, k, n as usize) { BROKEN } else { 0.0 };
            let expected = net.sheet.share[n as usize] * (k as f64 + BALANCE.1);
            let drawn = used.get(&look).copied().unwrap_or(0) as f64;
            cost += BALANCE.0 * ((drawn + 1.0) / (expected + 1.0) - 1.0).clamp(-1.0, 2.0);
            if copied.contains(&Some(n)) {
                cost += COPY;
            }
            let most = as_good(best);
            if cost > most {
                continue;
            }
            cost += context.cost(net, net.sheet.node(n as usize), most - cost);
            best = best.min(cost);
            costs.push((cost, n));
        }
        let good: Vec<u32> = costs.iter().filter(|c| c.0 <= as_good(best)).map(|c| c.1).collect();
        let mut stream = Stream::new(seed, GROW, k as u64);
        let Some(&chosen) = good.get(stream.below(good.len())) else { continue };
        let star = *net.sheet.star(chosen as usize);
        for end in net.new_ends(k, &star) {
            sets.join(k, end);
        }
        *used.entry(net.sheet.looks[chosen as usize]).or_default() += 1;
        net.copy(k, &star, false);
        sources[k] = Some(chosen);
    }
    mend(net, seed, budget)
}

/// What it costs that a star does not suit what is drawn at a node and around it.
fn misfit(net: &Net<'_>, k: usize, (star, look): (&Star, Look), sets: &mut DisjointSets) -> f64 {
    let mut cost = 0.0;
    if net.looks[k].steps_differ(&look) {
        cost += BROKEN * f64::from(net.looks[k].differs(&look));
    } else if !net.leaves_room(k, star) {
        cost += BROKEN;
    }
    if net.sheet.is_forest && net.would_close(k, &net.new_ends(k, star), sets) {
        cost += RING;
    }
    cost
}

/// Whether a slanted step would cross another, or cross none, other than it does at a node of the exemplar.
fn breaks_crossing(net: &Net<'_>, k: usize, n: usize) -> bool {
    (1..8).step_by(2).any(|way| {
        let (here, there) = (net.crossing(k, way), net.sheet.crossing(n, way));
        net.stars[k].steps[way].is_none() && here.is_some() && there.is_some() && here != there
    })
}

/// The cost up to which others are as good as the best.
fn as_good(best: f64) -> f64 {
    best + AS_GOOD.0 * best.abs() + AS_GOOD.1
}

/// Draws nodes anew that look like none of the exemplar, or lie beside such.
fn mend(net: &mut Net<'_>, seed: u64, budget: &Budget) -> Result<()> {
    let seen: BTreeSet<Look> = net.sheet.told.iter().map(|&n| net.sheet.looks[n as usize]).collect();
    for round in 0..ROUNDS {
        let odd: Vec<usize> = (0..net.nodes.len()).filter(|&k| is_odd(net, k, &seen)).collect();
        if odd.is_empty() {
            break;
        }
        let mut tried = BTreeSet::new();
        for &k in &odd {
            tried.insert(k);
            tried.extend((0..8).filter_map(|way| net.number(beside(net.nodes[k], way))));
        }
        for k in tried {
            redraw(net, k, &seen, (seed, round), budget)?;
        }
    }
    Ok(())
}

/// Whether a node looks like none of the exemplar, or lines cross beside it as they never do there.
fn is_odd(net: &Net<'_>, k: usize, seen: &BTreeSet<Look>) -> bool {
    !seen.contains(&net.looks[k]) || (!net.sheet.has_crossings && net.crosses(k))
}

/// Draws a node anew where fewer nodes around are odd for it.
fn redraw(
    net: &mut Net<'_>,
    k: usize,
    seen: &BTreeSet<Look>,
    (seed, round): (u64, usize),
    budget: &Budget,
) -> Result<()> {
    let mut around: Vec<usize> = (0..8).filter_map(|way| net.number(beside(net.nodes[k], way))).collect();
    around.push(k);
    around.sort_unstable();
    around.dedup();
    let odd = |net: &Net<'_>| around.iter().filter(|&&n| is_odd(net, n, seen)).count();
    let before = odd(net);
    if before == 0 {
        return Ok(());
    }
    let kept: Vec<(usize, Star)> = around.iter().map(|&n| (n, net.stars[n])).collect();
    let mut best: Option<(usize, f64, Star)> = None;
    let mut stream = Stream::new(seed, MEND, (k * ROUNDS + round) as u64);
    budget.spend(COMPARE * (net.sheet.told.len() * 40) as u64)?;
    let mut looks = BTreeSet::new();
    for &n in &net.sheet.told {
        if !looks.insert(net.sheet.looks[n as usize]) {
            continue;
        }
        let star = *net.sheet.star(n as usize);
        net.copy(k, &star, true);
        let is_sound = !net.sheet.is_forest || !is_on_ring(net, k, budget)?;
        let after = odd(net);
        let chance = stream.unit();
        if is_sound && after < before && best.as_ref().is_none_or(|b| (after, chance) < (b.0, b.1)) {
            best = Some((after, chance, star));
        }
        for (n, star) in &kept {
            net.stars[*n] = *star;
            net.look_again(*n);
        }
    }
    if let Some((_, _, star)) = best {
        net.copy(k, &star, true);
    }
    Ok(())
}

/// Whether a node lies on a ring of steps.
fn is_on_ring(net: &Net<'_>, k: usize, budget: &Budget) -> Result<bool> {
    let steps = |n: usize| {
        let drawn = (0..8).filter(move |&way| net.stars[n].steps[way].is_some_and(|c| c > 0));
        drawn.filter_map(move |way| net.number(beside(net.nodes[n], way)))
    };
    let mut reached: BTreeSet<usize> = BTreeSet::from([k]);
    for first in steps(k) {
        if !reached.insert(first) {
            return Ok(true);
        }
        let mut open = vec![(first, k)];
        while let Some((n, from)) = open.pop() {
            budget.spend(COMPARE)?;
            for next in steps(n).filter(|&next| next != from) {
                if !reached.insert(next) {
                    return Ok(true);
                }
                open.push((next, n));
            }
        }
    }
    Ok(false)
}
