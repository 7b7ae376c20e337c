//! What goes on beyond the edges: each gap and each end at an edge with its partner at the opposite one.

use std::collections::BTreeMap;

use arabesque_core::{Budget, Result};
use kurbo::Vec2;

use crate::svg::swatch::{
    cell::{Cell, SIDES, beyond, opposite},
    pieces::Piece,
    units::Unit,
};

/// Work for comparing two ends.
const COMPARE: u64 = 10;

/// The end of a chain: piece, chain, start (0) or end (1).
pub(crate) type End = [usize; 3];

/// The partners of gaps and ends.
#[derive(Debug, Default)]
pub(crate) struct Links {
    /// For each gap of each piece, the piece and gap that it goes on in, beyond the edge.
    pub(crate) gaps: Vec<Vec<Option<[usize; 2]>>>,
    /// For ends of strokes at an edge, the end that the stroke goes on at, and in which cell from its own.
    pub(crate) ends: BTreeMap<End, (End, [i64; 2])>,
    /// Ends of strokes at an edge that nothing goes on at.
    pub(crate) loose: Vec<End>,
    /// How far ends that go on are apart, at most.
    pub(crate) off: f64,
}

/// Finds the partners.
pub(crate) fn links(pieces: &[Piece], units: &[Unit], cell: &Cell, budget: &Budget) -> Result<Links> {
    let mut links = Links { gaps: pieces.iter().map(|p| vec![None; p.gaps.len()]).collect(), ..Links::default() };
    for side in [0, 2] {
        link_gaps(&mut links, pieces, units, (side, cell.apart()), budget)?;
    }
    link_ends(&mut links, pieces, units, cell, budget)?;
    Ok(links)
}

/// Gaps of one side and what they are looked up by: the look and where they begin.
fn gaps_of(pieces: &[Piece], units: &[Unit], side: usize) -> Vec<(usize, f64, [usize; 2])> {
    let mut all = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        let found = piece.gaps.iter().enumerate().filter(|(_, gap)| gap.side == side);
        all.extend(found.map(|(k, gap)| (units[piece.unit].look, gap.range[0], [i, k])));
    }
    all.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    all
}

fn link_gaps(
    links: &mut Links,
    pieces: &[Piece],
    units: &[Unit],
    (side, apart): (usize, f64),
    budget: &Budget,
) -> Result<()> {
    let (here, there) = (gaps_of(pieces, units, side), gaps_of(pieces, units, opposite(side)));
    for (look, from, [i, k]) in here {
        let to = pieces[i].gaps[k].range[1];
        let first = there.partition_point(|g| (g.0, g.1 - from) < (look, -apart));
        let mut best: Option<(f64, [usize; 2])> = None;
        for &(_, start, [j, l]) in there[first..].iter().take_while(|g| g.0 == look && g.1 <= from + apart) {
            budget.spend(COMPARE)?;
            let off = (start - from).abs().max((pieces[j].gaps[l].range[1] - to).abs());
            if off <= apart && links.gaps[j][l].is_none() && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, [j, l]));
            }
        }
        if let Some((_, [j, l])) = best {
            links.gaps[i][k] = Some([j, l]);
            links.gaps[j][l] = Some([i, k]);
        }
    }
    Ok(())
}

/// Strokes go on straight: ends whose ways differ by more (the cosine of it) are not joined where others fit better.
const STRAIGHT: f64 = 0.8;

fn link_ends(links: &mut Links, pieces: &[Piece], units: &[Unit], cell: &Cell, budget: &Budget) -> Result<()> {
    let mut ends: Vec<(usize, kurbo::Point, Vec2, End)> = Vec::new();
    for (i, piece) in pieces.iter().enumerate().filter(|(_, piece)| !piece.is_filled) {
        for (k, chain) in piece.chains.iter().enumerate().filter(|(_, chain)| !chain.is_closed) {
            for which in 0..2 {
                let at = chain.end(which);
                if SIDES.into_iter().any(|side| cell.is_on(side, at)) {
                    ends.push((units[piece.unit].look, at, chain.way_out(which), [i, k, which]));
                }
            }
        }
    }
    ends.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.3.cmp(&b.3)));
    let mut pairs: Vec<(f64, f64, [End; 2], [i64; 2])> = Vec::new();
    for &(look, at, way, end) in &ends {
        let sides = SIDES.into_iter().filter(|side| cell.is_on(*side, at));
        let mut tiles: Vec<[i64; 2]> = sides.map(beyond).collect();
        if let [a, b] = tiles[..] {
            tiles.push([a[0] + b[0], a[1] + b[1]]);
        }
        for tile in tiles {
            let want = at - cell.shift(tile);
            let first = ends.partition_point(|e| (e.0, e.1.x - want.x) < (look, -cell.apart()));
            let near = ends[first..].iter().take_while(|e| e.0 == look && e.1.x <= want.x + cell.apart());
            for other in near {
                budget.spend(COMPARE)?;
                let (off, turn) = ((other.1 - want).hypot(), -way.dot(other.2));
                if other.3 != end && off <= cell.apart() {
                    let bend = if turn >= STRAIGHT { 1.0 - turn } else { 10.0 };
                    pairs.push((bend + off / cell.apart(), off, [end, other.3], tile));
                }
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.2, a.3).cmp(&(b.2, b.3))));
    for (_, off, [end, other], tile) in pairs {
        if !links.ends.contains_key(&end) && !links.ends.contains_key(&other) {
            links.off = links.off.max(off);
            links.ends.insert(end, (other, tile));
            links.ends.insert(other, (end, tile.map(|t| -t)));
        }
    }
    links.loose = ends.iter().map(|e| e.3).filter(|end| !links.ends.contains_key(end)).collect();
    Ok(())
}
