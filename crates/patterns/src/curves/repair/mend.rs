//! Clean-up: ends that the exemplar would not show are joined to what they just miss, or trimmed.

use arabesque_core::{GridIndex, Matrix, Vector};

use crate::{
    curves::{
        repair::{crossings::Tangle, dangles::Loose},
        votes::{
            edge_votes::Votes,
            edges::{OpenArm, open_arms},
        },
    },
    exemplar::graph::net::Net,
    output::{draft::Item, state::State},
    toolbox::numbered::Numbered,
};

/// How far an end looks for something to join, in sampling distances.
const REACH: f64 = 1.7;

/// An end is out of place when this many edges are expected at it.
const EXPECTED: f64 = 1.5;

/// Widest gap that two ends bridge when they face each other, in sampling distances.
const SPAN: f64 = 5.0;

/// They face each other when the line between them turns by less than this from either: cosine of 25 degrees.
const FACING: f64 = 0.9;

/// What a false end is taken on to lies ahead of it: cosine of 70 degrees.
const AHEAD: f64 = 0.34;

/// How far beyond the border of the domain a kept stroke may end that goes on inside, in sampling distances.
const AT_BORDER: f64 = 0.3;

/// Edges that end within this many sampling distances of one another want the same sample.
const SAME_PLACE: f64 = 0.5;

/// Cost of a joint that makes a new junction, in sampling distances.
const NEW_JUNCTION: f64 = 0.6;

/// Cost of a joint at a right angle to the end's direction, in sampling distances.
const ANGLE: f64 = 0.8;

/// Joins and trims. Returns how many samples changed.
pub(crate) fn mend<const D: usize>(state: &mut State<'_, D>, votes: &Votes) -> usize {
    let level = state.level;
    let Some(net) = &level.net else { return 0 };
    let (loose, tangle) = (Loose::of(net), Tangle::of(net));
    let mut changed = tangle.undo(state, votes) + restore(state, net);
    for _ in 0..3 {
        let ends = false_ends(state, net, votes, &loose);
        let joined = join(state, net, votes, (&loose, &tangle), &ends);
        changed += joined;
        if joined == 0 {
            break;
        }
    }
    changed += bridge(state, net, votes, (&loose, &tangle)) + reach_border(state, net);
    if net.branches() {
        changed += extend(state, net, votes, (&loose, &tangle));
    }
    changed += tangle.undo(state, votes);
    changed + trim(state, net, votes, &loose)
}

/// Takes false ends on to the nearest stroke ahead, where strokes branch anyway.
fn extend<const D: usize>(
    state: &mut State<'_, D>,
    net: &Net<D>,
    votes: &Votes,
    (loose, tangle): (&Loose, &Tangle),
) -> usize {
    let mut joined = 0;
    for s in false_ends(state, net, votes, loose) {
        // An earlier one may have been joined to this.
        if state.degree(s) != 1 {
            continue;
        }
        let position = state.sample(s).position;
        let unit = net.spacing * state.request.fields.frame(position).spacing_scale;
        let before = state.links_of(s)[0];
        let way = direction(state.offset(before, s));
        let mut ahead: Vec<(f64, u32)> = Vec::new();
        state.within(position, SPAN * unit, |o, offset| {
            let cosine = way.dot(direction(offset));
            let cost = offset.norm() * (2.0 - cosine);
            let is_own = o == s || o == before || state.are_linked(before, o);
            let degree = state.degree(o);
            let is_kept = state.is_frozen(s) && state.is_frozen(o);
            if !is_own && !is_kept && cosine > AHEAD && (1..=2).contains(&degree) && state.share_style(o, s) {
                ahead.push((cost, o));
            }
        });
        ahead.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some(&(_, o)) = ahead.iter().find(|(_, o)| tangle.allows(state, s, *o)) {
            state.link(s, o);
            joined += 1;
        }
    }
    joined
}

/// Takes strokes over the border where their sources go on beyond it.
fn reach_border<const D: usize>(state: &mut State<'_, D>, net: &Net<D>) -> usize {
    let inside: Vec<u32> = state
        .living()
        .iter()
        .copied()
        .filter(|&s| !state.is_frozen(s) && state.domain().contains(state.sample(s).position))
        .collect();
    let open: Vec<OpenArm<D>> = inside.iter().flat_map(|&s| open_arms(state, net, s)).collect();
    let beyond = |arm: &&OpenArm<D>| !state.domain().contains(arm.place) || state.extent.is_blocked(arm.place, 0.0);
    let base = state.level.base;
    let is_open = |arm: &&OpenArm<D>| !state.extent.is_known(arm.place);
    let new: Vec<OpenArm<D>> = open.iter().filter(beyond).filter(is_open).cloned().collect();
    for arm in &new {
        let item = Item { source: base + arm.node, position: arm.place, frozen: None };
        let sample = state.push(item, Matrix::identity());
        state.link(sample, arm.sample);
    }
    new.len()
}

/// Joins false ends that face each other across a gap.
fn bridge<const D: usize>(
    state: &mut State<'_, D>,
    net: &Net<D>,
    votes: &Votes,
    (loose, tangle): (&Loose, &Tangle),
) -> usize {
    let ends = false_ends(state, net, votes, loose);
    let places: Vec<_> = ends.iter().map(|&s| state.sample(s).position).collect();
    let ways: Vec<_> = ends.iter().map(|&s| direction(state.offset(state.links_of(s)[0], s))).collect();
    let unit = net.spacing * state.extent.largest_spacing_scale;
    let index = GridIndex::new(&places, SPAN * unit, state.domain());
    let mut wishes: Vec<(f64, usize, usize)> = Vec::new();
    for (i, &s) in ends.iter().enumerate() {
        index.within(places[i], SPAN * unit, |j, offset| {
            let across = direction(offset);
            let (out, back) = (ways[i].dot(across), -ways[j].dot(across));
            let is_new = !(state.is_frozen(s) && state.is_frozen(ends[j]));
            if j > i && is_new && out > FACING && back > FACING && state.share_style(s, ends[j]) {
                wishes.push((offset.norm() / unit + ANGLE * (2.0 - out - back), i, j));
            }
        });
    }
    wishes.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = vec![false; ends.len()];
    let mut joined = 0;
    for (_, i, j) in wishes {
        let is_bad = |a: u32, b: u32| !tangle.allows(state, a, b) || loose.forbids(state, a, b);
        if !taken[i] && !taken[j] && !is_bad(ends[i], ends[j]) {
            (taken[i], taken[j]) = (true, true);
            state.link(ends[i], ends[j]);
            joined += 1;
        }
    }
    joined
}

/// Puts back samples that several strokes reach for: where the missing edges of three or more samples end at one place, or
/// two run into each other, and nothing is there.
fn restore<const D: usize>(state: &mut State<'_, D>, net: &Net<D>) -> usize {
    let wanted = |arm: &OpenArm<D>| state.domain().contains(arm.place) && !state.extent.is_blocked(arm.place, 0.0);
    let open: Vec<OpenArm<D>> = state.living().iter().flat_map(|&s| open_arms(state, net, s)).filter(wanted).collect();
    let unit = net.spacing * state.extent.smallest_spacing_scale;
    let places: Vec<_> = open.iter().map(|arm| state.domain().wrap(arm.place)).collect();
    let index = GridIndex::new(&places, unit, state.domain());
    let mut used = vec![false; open.len()];
    let mut restored = 0;
    for i in 0..open.len() {
        let mut group: Vec<usize> = Vec::new();
        index.within(places[i], SAME_PLACE * unit, |j, _| {
            let is_new = group.iter().all(|&g: &usize| open[g].sample != open[j].sample);
            let alike = net.nodes[open[i].node as usize].shares_style(&net.nodes[open[j].node as usize]);
            if !used[j] && is_new && alike {
                group.push(j);
            }
        });
        group.sort_unstable();
        let shift = group.iter().fold(Vector::ZERO, |sum, &j| sum + state.domain().offset(places[i], places[j]));
        let place = state.domain().wrap(places[i] + shift * (1.0 / group.len().max(1) as f64));
        let asked = group.len() >= 3 || is_gap(state, &open, &group);
        if used[i] || !asked || is_taken(state, net, open[i].node, place) {
            continue;
        }
        // The node with as many edges as there are strokes reaching for it.
        let misfit = |j: usize| net.degree(open[j].node).abs_diff(group.len());
        let Some(node) = group.iter().copied().min_by_key(|&j| (misfit(j), j)).map(|j| open[j].node) else { continue };
        let item = Item { source: state.level.base + node, position: place, frozen: None };
        let sample = state.push(item, Matrix::identity());
        for j in group {
            used[j] = true;
            state.link(sample, open[j].sample);
        }
        restored += 1;
    }
    if restored > 0 {
        state.reindex();
    }
    restored
}

/// Whether two edges run into each other from opposite sides.
fn is_gap<const D: usize>(state: &State<'_, D>, open: &[OpenArm<D>], group: &[usize]) -> bool {
    let way = |j: usize| {
        let arm = &open[j];
        direction(state.domain().offset(state.sample(arm.sample).position, arm.place))
    };
    matches!(group, [i, j] if way(*i).dot(way(*j)) < -FACING)
}

/// Whether something that could be `node` lies at `place` already.
fn is_taken<const D: usize>(state: &State<'_, D>, net: &Net<D>, node: u32, place: Vector<D>) -> bool {
    let mut taken = false;
    let room = SAME_PLACE * net.spacing * state.request.fields.frame(place).spacing_scale;
    state.within(place, room, |s, _| {
        let other = state.node(s);
        taken |= other.is_some_and(|e| net.nodes[e].shares_style(&net.nodes[node]));
    });
    taken
}

/// Number of edges that a sample should have.
fn expected<const D: usize>(state: &State<'_, D>, net: &Net<D>, votes: &Votes, s: u32) -> f64 {
    // Of a kept sample its strokes tell more than its neighbours.
    let told = votes.degree.get(s as usize).copied().flatten().filter(|_| !state.is_frozen(s));
    told.unwrap_or_else(|| state.node(s).map_or(0.0, |e| net.degree(e) as f64))
}

/// Whether a stroke ends at `s` that should go on. Beyond the border of the domain anything may end.
fn is_false_end<const D: usize>(state: &State<'_, D>, net: &Net<D>, votes: &Votes, loose: &Loose, s: u32) -> bool {
    let p = state.sample(s).position;
    let room = if state.is_frozen(s) { -AT_BORDER * net.spacing } else { 0.0 };
    state.node(s).is_some()
        && state.degree(s) == 1
        && state.domain().signed_distance(p) > room
        && (expected(state, net, votes, s) > EXPECTED || (!state.is_frozen(s) && loose.is_too_long(state, s)))
}

/// The false ends of a state.
fn false_ends<const D: usize>(state: &State<'_, D>, net: &Net<D>, votes: &Votes, loose: &Loose) -> Vec<u32> {
    state.living().iter().copied().filter(|&s| is_false_end(state, net, votes, loose, s)).collect()
}

fn join<const D: usize>(
    state: &mut State<'_, D>,
    net: &Net<D>,
    votes: &Votes,
    (loose, tangle): (&Loose, &Tangle),
    ends: &[u32],
) -> usize {
    let mut wishes: Vec<(f64, u32, u32)> = ends.iter().flat_map(|&s| partners(state, net, votes, loose, s)).collect();
    wishes.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = Numbered::filled(false, state.samples().len());
    let mut joined = 0;
    for (_, a, b) in wishes {
        if taken[a] || taken[b] || !tangle.allows(state, a, b) || loose.forbids(state, a, b) {
            continue;
        }
        (taken[a], taken[b]) = (true, true);
        state.link(a, b);
        joined += 1;
    }
    joined
}

/// What the end `s` could be joined to, with the cost in sampling distances.
fn partners<const D: usize>(
    state: &State<'_, D>,
    net: &Net<D>,
    votes: &Votes,
    loose: &Loose,
    s: u32,
) -> Vec<(f64, u32, u32)> {
    let position = state.sample(s).position;
    let unit = net.spacing * state.request.fields.frame(position).spacing_scale;
    let Some(&before) = state.links_of(s).first() else { return Vec::new() };
    let way = direction(state.offset(before, s));
    let branches = net.branches();
    // What is too long would only grow with another end of a stroke.
    let takes_ends = expected(state, net, votes, s) > EXPECTED || !loose.has_single();
    let mut found = Vec::new();
    state.within(position, REACH * unit, |o, offset| {
        let is_near = o == s || o == before || state.are_linked(before, o);
        let is_kept = state.is_frozen(s) && state.is_frozen(o);
        if is_near || is_kept || !state.share_style(o, s) {
            return;
        }
        let degree = state.degree(o);
        if degree == 0 || (degree == 1 && !takes_ends) {
            return;
        }
        let wants = expected(state, net, votes, o) - degree as f64 > 0.4;
        let turn = 1.0 - way.dot(direction(offset));
        let cost = offset.norm() / unit + ANGLE * turn + if wants { 0.0 } else { NEW_JUNCTION };
        let is_crowded = degree >= 4 || (!wants && (degree >= 3 || (degree == 2 && !branches)));
        if cost <= REACH && !is_crowded {
            found.push((cost, s, o));
        }
    });
    found
}

fn direction<const D: usize>(v: Vector<D>) -> Vector<D> {
    v * (1.0 / v.norm().max(f64::MIN_POSITIVE))
}

/// Takes away false ends that are a single edge long, and samples without any edge.
fn trim<const D: usize>(state: &mut State<'_, D>, net: &Net<D>, votes: &Votes, loose: &Loose) -> usize {
    let is_stub = |s: u32| {
        let ended = is_false_end(state, net, votes, loose, s);
        ended && state.links_of(s).first().is_some_and(|&o| state.degree(o) != 2)
    };
    let alone = |s: u32| state.node(s).is_some() && state.links_of(s).is_empty();
    let gone: Vec<u32> =
        state.living().iter().copied().filter(|&s| !state.is_frozen(s) && (alone(s) || is_stub(s))).collect();
    for &s in &gone {
        state.kill(s);
    }
    gone.len()
}
