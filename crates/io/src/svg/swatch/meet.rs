//! Cuts that meet in part: what goes on over an edge where a longer cut ends there is one thing with it all the same.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Result};
use kurbo::{Line, PathSeg};

use crate::svg::swatch::{
    cell::{Cell, opposite},
    links::Links,
    pieces::{Chain, Gap, GapEnd, Piece},
    units::Unit,
};

/// Work for comparing two gaps.
const COMPARE: u64 = 10;

/// A gap: its piece, and its number there.
type Place = [usize; 2];

/// A stretch of an edge that two gaps share, in part of one of them at least.
#[derive(Clone, Copy, Debug)]
struct Shared {
    range: [f64; 2],
    partner: Place,
}

/// Splits gaps that share a part of theirs with gaps of the same look at the opposite edge, and links the shared parts.
///
/// Where a gap is split there is a chain without length, so that a walk along the outline may turn there.
pub(crate) fn meet(
    pieces: &mut [Piece],
    links: &mut Links,
    units: &[Unit],
    cell: &Cell,
    budget: &Budget,
) -> Result<()> {
    let mut shared: BTreeMap<Place, Vec<Shared>> = BTreeMap::new();
    for side in [0, 2] {
        let (here, there) = (open(pieces, links, side), open(pieces, links, opposite(side)));
        for &a in &here {
            for &b in there.iter().filter(|&&b| look(pieces, units, a) == look(pieces, units, b)) {
                budget.spend(COMPARE)?;
                let (p, q) = (gap(pieces, a).range, gap(pieces, b).range);
                let range = [p[0].max(q[0]), p[1].min(q[1])];
                if range[1] - range[0] > cell.apart() {
                    shared.entry(a).or_default().push(Shared { range, partner: b });
                    shared.entry(b).or_default().push(Shared { range, partner: a });
                }
            }
        }
    }
    // Things drawn over one another share what they like: which of them goes on in which is not to be told.
    let apart = cell.apart();
    shared.retain(|_, all| {
        all.sort_by(|a, b| a.range[0].total_cmp(&b.range[0]));
        all.windows(2).all(|pair| pair[1].range[0] > pair[0].range[1] - apart)
    });
    let both: BTreeMap<Place, Vec<Shared>> = shared
        .iter()
        .map(|(&at, all)| (at, all.iter().copied().filter(|s| shared.contains_key(&s.partner)).collect()))
        .filter(|(_, all): &(Place, Vec<Shared>)| !all.is_empty())
        .collect();
    let mut parts: BTreeMap<(Place, Place), usize> = BTreeMap::new();
    for (&[p, g], all) in &both {
        split(&mut pieces[p], g, all, cell, &mut |partner, number| {
            parts.insert(([p, g], partner), number);
        });
        links.gaps[p].resize(pieces[p].gaps.len(), None);
    }
    for (&(from, to), &number) in &parts {
        links.gaps[from[0]][number] = parts.get(&(to, from)).map(|&there| [to[0], there]);
    }
    Ok(())
}

/// The gaps of a side that nothing goes on at as a whole.
fn open(pieces: &[Piece], links: &Links, side: usize) -> Vec<Place> {
    let all = pieces.iter().enumerate().flat_map(|(p, piece)| (0..piece.gaps.len()).map(move |g| [p, g]));
    all.filter(|&[p, g]| pieces[p].gaps[g].side == side && links.gaps[p][g].is_none()).collect()
}

fn gap(pieces: &[Piece], [p, g]: Place) -> &Gap {
    &pieces[p].gaps[g]
}

fn look(pieces: &[Piece], units: &[Unit], [p, _]: Place) -> usize {
    units[pieces[p].unit].look
}

/// Splits a gap at the ends of what it shares; `tell` hears which of the new gaps is shared with which other one.
fn split(piece: &mut Piece, number: usize, shared: &[Shared], cell: &Cell, tell: &mut dyn FnMut(Place, usize)) {
    let Gap { side, range: [from, to], ends } = piece.gaps[number].clone();
    let mut stops: Vec<f64> = shared.iter().flat_map(|s| s.range).collect();
    stops.retain(|at| at - from > cell.apart() && to - at > cell.apart());
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|b, a| *b - *a <= cell.apart());
    let mut start = (from, ends[0]);
    let mut next = number;
    for stop in stops.iter().copied().map(Some).chain([None]) {
        let (at, end, then) = match stop {
            Some(at) => {
                let point = cell.on(side, at);
                let turn = Chain { segments: vec![PathSeg::Line(Line::new(point, point))], is_closed: false };
                piece.chains.push(turn);
                let chain = piece.chains.len() - 1;
                (at, GapEnd::Chain(chain, 0), GapEnd::Chain(chain, 1))
            }
            None => (to, ends[1], ends[1]),
        };
        let part = Gap { side, range: [start.0, at], ends: [start.1, end] };
        let middle = 0.5 * (start.0 + at);
        if let Some(with) = shared.iter().find(|s| s.range[0] < middle && middle < s.range[1]) {
            tell(with.partner, next);
        }
        if next == number {
            piece.gaps[number] = part
        } else {
            piece.gaps.push(part)
        }
        next = piece.gaps.len();
        start = (at, then);
    }
}
