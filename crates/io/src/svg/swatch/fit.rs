//! Whether what the edges of a cell cut goes on at the opposite edges.

use kurbo::{PathSeg, Point, Shape};

use crate::svg::swatch::{
    cell::{Cell, along, beyond, opposite},
    links::Links,
    pieces::{Gap, Piece},
    units::Unit,
};

/// Something that an edge cuts and that does not go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Misfit {
    pub(crate) side: usize,
    /// Where along the edge, from its upper or left end.
    pub(crate) along: f64,
    pub(crate) unit: usize,
}

/// How much may end at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Nothing: whatever an edge cuts goes on.
    Nothing,
    /// What is not drawn beyond the edge: shapes that end there, next to something else or to nothing.
    Whole,
}

/// The first place where an edge cuts something that does not go on at the opposite edge.
pub(crate) fn misfit(
    pieces: &[Piece],
    units: &[Unit],
    links: &Links,
    (cell, ending): (&Cell, Ending),
) -> Option<Misfit> {
    let found = |side: usize, at: f64, unit: usize| Misfit { side, along: at - cell.range(side)[0], unit };
    for (p, piece) in pieces.iter().enumerate() {
        for (gap, link) in piece.gaps.iter().zip(&links.gaps[p]) {
            let there = opposite(gap.side);
            let is_met = |look| is_covered(pieces, units, cell, (look, there, gap.range));
            let may_end = || {
                ending == Ending::Whole && (is_met(None) || ends_there(pieces, units, piece, (there, gap.range, cell)))
            };
            if link.is_none() && !is_met(Some(units[piece.unit].look)) && !may_end() {
                return Some(found(gap.side, 0.5 * (gap.range[0] + gap.range[1]), piece.unit));
            }
        }
    }
    links.loose.iter().find_map(|&[p, chain, which]| {
        let at = pieces[p].chains[chain].end(which);
        let side = (0..4).find(|side| cell.is_on(*side, at))?;
        let there = at - cell.shift(beyond(side));
        let is_met = is_on_line(pieces, units, cell, (units[pieces[p].unit].look, there));
        (!is_met).then(|| found(side, along(side, at), pieces[p].unit))
    })
}

/// Stretches whose ends differ by less, as a share of the shorter one, were meant to meet.
const NEARLY: f64 = 0.25;

/// Whether a shape ends at an edge: nothing of it is drawn beyond, and nothing like it lies nearly at the same stretch of the opposite edge.
fn ends_there(pieces: &[Piece], units: &[Unit], piece: &Piece, (side, range, cell): (usize, [f64; 2], &Cell)) -> bool {
    let look = units[piece.unit].look;
    let frame = cell.frame.inflate(cell.near(), cell.near());
    let alike = pieces.iter().filter(|other| units[other.unit].look == look).flat_map(|other| &other.gaps);
    let is_missed = |gap: &Gap| {
        let least = NEARLY * (gap.range[1] - gap.range[0]).min(range[1] - range[0]);
        gap.side == side && (0..2).all(|k| (gap.range[k] - range[k]).abs() <= least)
    };
    frame.union(piece.extent) == frame && (is_upright(piece) || !{ alike }.any(is_missed))
}

/// Whether a piece has sides along the edges alone: it ends wherever it likes.
pub(crate) fn is_upright(piece: &Piece) -> bool {
    let is_along = |segment: &PathSeg| match segment {
        PathSeg::Line(line) => (line.p1.x - line.p0.x).abs().min((line.p1.y - line.p0.y).abs()) <= 1e-6 * line.length(),
        _ => false,
    };
    piece.chains.iter().flat_map(|chain| &chain.segments).all(is_along)
}

/// Whether gaps of a look, or any, cover a stretch of an edge together.
fn is_covered(
    pieces: &[Piece],
    units: &[Unit],
    cell: &Cell,
    (look, side, range): (Option<usize>, usize, [f64; 2]),
) -> bool {
    // Something behind it all meets everything, and says nothing.
    let alike = pieces.iter().filter(|other| look.map_or(!other.covers, |look| units[other.unit].look == look));
    let mut there: Vec<[f64; 2]> =
        alike.flat_map(|other| &other.gaps).filter(|gap| gap.side == side).map(|gap| gap.range).collect();
    there.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut reached = range[0];
    for [from, to] in there {
        if from <= reached + cell.apart() {
            reached = f64::max(reached, to);
        }
    }
    reached >= range[1] - cell.apart()
}

/// Whether a place lies on a stroke of some look.
fn is_on_line(pieces: &[Piece], units: &[Unit], cell: &Cell, (look, at): (usize, Point)) -> bool {
    let alike = pieces.iter().filter(|piece| units[piece.unit].look == look);
    let near = |segment: &PathSeg| {
        segment.bounding_box().inflate(cell.apart(), cell.apart()).contains(at)
            && kurbo::ParamCurveNearest::nearest(segment, at, 0.1 * cell.near()).distance_sq <= cell.apart().powi(2)
    };
    alike.flat_map(|piece| &piece.chains).flat_map(|chain| &chain.segments).any(near)
}
