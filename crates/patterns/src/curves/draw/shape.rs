//! The shape of a stroke: the exemplar's own lines, bent to the samples.
//!
//! Where the exemplar runs smoothly through a sample, so does the output: the handles on both sides are turned to their
//! mean direction. Where it has a corner, the corner stays.

use arabesque_core::{
    Budget, Cubic, Drawn, NormalEquations, Numbered, Path, Prediction, Pull, Result, Vector, segment, straight,
};
use rayon::prelude::*;

use crate::{
    curves::{
        border::{border_turn::BorderTurn, trim::at_border},
        draw::chains::Chain,
    },
    dimension::Dimension,
    exemplar::graph::{
        net::{Net, Piece},
        skeleton::Knot,
    },
    output::state::State,
};

/// Weight of the place of a sample against the shapes of the edges around it.
const STAY: f64 = 0.08;

/// A turn with a larger angle than this is a corner whatever the exemplar says: cosine of 65 degrees.
const SHARP: f64 = 0.42;

/// Nanoseconds for an edge whose shape is looked up, and for one that is drawn.
const PRICE: (u64, u64) = (300, 1500);

/// Places of the samples at which the edges come as close to the exemplar's as they can, near where they are.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn polish<const D: usize>(state: &State<'_, D>, chains: &[Chain]) -> Result<Numbered<Vector<D>>> {
    let budget = state.budget.stage("fitting strokes");
    let mut meter = budget.meter();
    let mut position: Numbered<_> = state.samples().iter().map(|s| s.position).collect();
    let Some(net) = &state.level.net else { return Ok(position) };
    let mut predictions = Vec::new();
    for chain in chains {
        meter.spend(PRICE.0 * chain.pieces.len() as u64)?;
        for (k, piece) in chain.pieces.iter().enumerate() {
            let (a, b) = (chain.samples[k], chain.samples[(k + 1) % chain.samples.len()]);
            let Some(piece) = piece else { continue };
            let frame = state.request.fields.frame(position[a]);
            let offset = frame.to_output(net.span(*piece)) - state.offset(a, b);
            predictions.push(Prediction { from: a, to: b, offset, weight: 1.0 });
        }
    }
    let pulls: Vec<_> = position.iter().map(|_| Pull { target: Vector::ZERO, weight: STAY }).collect();
    let fixed = (0..position.len() as u32).map(|s| state.is_frozen(s)).collect();
    let moves = NormalEquations::new(&predictions, &pulls, fixed).solve(1e-4, 200, &budget)?;
    position.iter_mut().zip(moves).for_each(|(p, step)| *p += step);
    Ok(position)
}

/// The strokes of all chains, frozen ones first.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn strokes<const D: usize>(state: &State<'_, D>, chains: &[Chain]) -> Result<Vec<Drawn<D>>>
where
    Vector<D>: Dimension<D>,
{
    let frozen = state.request.frozen_curves.iter().enumerate().map(|(n, d)| Drawn { frozen: Some(n), ..d.clone() });
    let Some(net) = &state.level.net else { return Ok(frozen.collect()) };
    let budget = state.budget.stage("drawing strokes");
    let one = |chain: &Chain| -> Result<Drawn<D>> {
        budget.spend(PRICE.1 * chain.pieces.len() as u64)?;
        let (path, curve) = draw(state, net, chain);
        let scale = state.request.fields.frame(path.start().unwrap_or(Vector::ZERO)).element_scale;
        Ok(Drawn { path, source: curve as usize, scale, frozen: None })
    };
    let free: Vec<_> = chains.par_iter().map(one).collect::<Result<_>>()?;
    if let Some(turn) = BorderTurn::of(state, net)? {
        return Ok(frozen.chain(turn.finish(free)?).collect());
    }
    let cut: Vec<Vec<Drawn<D>>> =
        free.into_par_iter().map(|d| cut_at_border(d, state, net, &budget)).collect::<Result<_>>()?;
    budget.spend(0)?;
    Ok(frozen.chain(cut.into_iter().flatten()).collect())
}

/// What the border leaves of a stroke.
fn cut_at_border<const D: usize>(
    drawn: Drawn<D>,
    state: &State<'_, D>,
    net: &Net<D>,
    budget: &Budget,
) -> Result<Vec<Drawn<D>>> {
    let (width, unit) = (state.width(drawn.source as u32), net.spacing * drawn.scale);
    budget.spend(PRICE.1 * drawn.path.cubics.len() as u64 + net.skeleton.lines.len() as u64)?;
    Ok(at_border(drawn, state.extent, width, unit))
}

/// The path of a chain, and the exemplar curve whose style it carries. On a torus the path is unrolled.
fn draw<const D: usize>(state: &State<'_, D>, net: &Net<D>, chain: &Chain) -> (Path<D>, u32) {
    let position = |s: u32| state.sample(s).position;
    let mut here = position(chain.samples[0]);
    let mut stretches: Vec<Vec<Cubic<D>>> = Vec::with_capacity(chain.pieces.len());
    let origin = here;
    for (k, piece) in chain.pieces.iter().enumerate() {
        let (a, b) = (chain.samples[k], chain.samples[(k + 1) % chain.samples.len()]);
        let step = state.offset(a, b);
        let there = if chain.is_closed && k + 1 == chain.pieces.len() && (here + step - origin).norm() < 1e-6 {
            origin
        } else {
            here + step
        };
        // Inside the stroke the pieces meet; its ends keep the distance that the exemplar's keep to what they touch.
        let snapped = [chain.is_closed || k > 0, chain.is_closed || k + 1 < chain.pieces.len()];
        stretches.push(match piece {
            Some(piece) => bent(state, net, *piece, snapped, [here, there]),
            None => vec![straight(here, there)],
        });
        here = there;
    }
    // A stroke that runs around a torus comes back as itself, one period on: it is drawn open.
    let closes = chain.is_closed && here == origin;
    smooth(net, chain, &mut stretches);
    let path = Path { cubics: stretches.concat(), closed: closes };
    (path, style(net, chain))
}

/// An exemplar piece moved, turned into the local frame and bent so that its nodes come to lie at `a` and `b`. Its
/// start and its end are put exactly there where they are to be `snapped`.
pub(crate) fn bent<const D: usize>(
    state: &State<'_, D>,
    net: &Net<D>,
    piece: Piece,
    snapped: [bool; 2],
    [a, b]: [Vector<D>; 2],
) -> Vec<Cubic<D>> {
    let path = net.skeleton.lines[piece.line].measured.part(piece.from, piece.to);
    if path.is_empty() {
        return vec![straight(a, b)];
    }
    let (start, end) = (net.anchor(piece.line, piece.from), net.anchor(piece.line, piece.to));
    let frame = state.request.fields.frame(a);
    let chord = end - start;
    let rest = b - a - frame.to_output(chord);
    let place = |p: Vector<D>| a + frame.to_output(p - start) + rest * segment::nearest_share((start, end), p);
    let mut cubics = path.map(place).cubics;
    if let Some(first) = cubics.first_mut().filter(|_| snapped[0]) {
        first[0] = a;
    }
    if let Some(last) = cubics.last_mut().filter(|_| snapped[1]) {
        last[3] = b;
    }
    cubics
}

/// Turns the handles at the joints to one direction where the exemplar is smooth.
fn smooth<const D: usize>(net: &Net<D>, chain: &Chain, stretches: &mut [Vec<Cubic<D>>]) {
    let n = stretches.len();
    let joints = if chain.is_closed { 0..n } else { 1..n };
    for k in joints {
        let before = (k + n - 1) % n;
        if is_corner(net, chain.pieces[before], chain.pieces[k]) {
            continue;
        }
        let (Some(last), Some(first)) = (stretches[before].last().copied(), stretches[k].first().copied()) else {
            continue;
        };
        let (come, go) = (leaving(&[last[3], last[2], last[1], last[0]]) * -1.0, leaving(&first));
        let (lc, lg) = (come.norm(), go.norm());
        if lc < 1e-12 || lg < 1e-12 || come.dot(go) < SHARP * lc * lg {
            continue;
        }
        let mean = come * (1.0 / lc) + go * (1.0 / lg);
        let mean = mean.unit();
        if let Some(c) = stretches[before].last_mut() {
            c[2] = c[3] - mean * (c[3] - c[2]).norm();
        }
        if let Some(c) = stretches[k].first_mut() {
            c[1] = c[0] + mean * (c[1] - c[0]).norm();
        }
    }
}

/// First control vector of a cubic that is not zero.
fn leaving<const D: usize>(c: &Cubic<D>) -> Vector<D> {
    c[1..].iter().map(|p| *p - c[0]).find(|v| v.norm() > 1e-12).unwrap_or(Vector::ZERO)
}

/// Whether the exemplar has a corner where one piece ends and the next begins.
fn is_corner<const D: usize>(net: &Net<D>, before: Option<Piece>, after: Option<Piece>) -> bool {
    let corner = |line: u32, arc: f64| {
        let line = &net.skeleton.lines[line];
        let arc = line.measured.wrap(arc);
        let near = 1e-6 * line.measured.length();
        let hit = |a: f64| (a - arc).abs() < near || (line.measured.length() - (a - arc).abs()) < near;
        line.stops.iter().any(|&(a, knot)| hit(a) && net.skeleton.knots[knot].1 == Knot::Corner)
    };
    before.is_some_and(|p| corner(p.line, p.to)) || after.is_some_and(|p| corner(p.line, p.from))
}

/// The curve that most of the length was taken from.
fn style<const D: usize>(net: &Net<D>, chain: &Chain) -> u32 {
    let mut lengths: Vec<(u32, f64)> = Vec::new();
    for piece in chain.pieces.iter().flatten() {
        let curve = net.skeleton.lines[piece.line].curve;
        let length = (piece.to - piece.from).abs();
        match lengths.iter_mut().find(|(c, _)| *c == curve) {
            Some(entry) => entry.1 += length,
            None => lengths.push((curve, length)),
        }
    }
    lengths.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map_or(0, |(c, _)| c)
}
