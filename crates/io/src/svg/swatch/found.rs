//! Periods that the author does not speak of: pages whose opposite edges cut what fits together.

use kurbo::{PathSeg, Rect};

use crate::svg::swatch::{
    cell::{Cell, SIDES, opposite},
    fit::{Ending, misfit},
    links::Links,
    pieces::{Chain, Piece},
    units::{Unit, Units},
};

/// Things beyond which a page is not taken for a period: it shows enough as it is.
pub(crate) const MOST: usize = 40;
/// Boxes whose sides differ by less, as a share of their longer side, are those of things alike.
const ALIKE: f64 = 0.01;

/// Whether a page is one period beyond doubt: what its edges cut goes on at the opposite ones, to the right and down, and nothing else
/// explains that it does.
pub(crate) fn is_period(units: &Units, pieces: &[Piece], links: &Links, cell: &Cell) -> bool {
    if units.all.len().max(pieces.len()) > MOST || misfit(pieces, &units.all, links, (cell, Ending::Nothing)).is_some()
    {
        return false;
    }
    let clipped = units.all.iter().any(|unit| unit.node.viewport_clip.is_some());
    if clipped || pieces.iter().any(|piece| ends_as_a_whole(piece, &units.all, pieces, cell)) {
        return false;
    }
    (0..2).all(|axis| units.doubled[axis] > 0 || goes_on(pieces, links, cell, axis))
}

/// Whether something that an edge cuts tells of a period along an axis.
fn goes_on(pieces: &[Piece], links: &Links, cell: &Cell, axis: usize) -> bool {
    let is_across = |side: usize| side / 2 == axis;
    let of_fills = pieces.iter().enumerate().any(|(p, piece)| {
        let tells = |g: usize| is_across(piece.gaps[g].side) && !is_straight(&piece.chains, axis);
        !piece.covers && (0..piece.gaps.len()).any(|g| links.gaps[p][g].is_some() && tells(g))
    });
    let of_strokes = links.ends.iter().any(|(&[p, chain, which], _)| {
        let chain = &pieces[p].chains[chain];
        // What ends at a corner meets others there, whatever it is.
        let sides: Vec<usize> = SIDES.into_iter().filter(|side| cell.is_on(*side, chain.end(which))).collect();
        matches!(sides[..], [side] if is_across(side)) && !is_straight(std::slice::from_ref(chain), axis)
    });
    of_fills || of_strokes
}

/// Whether lines are straight and run along an axis: at whatever length they are cut, they go on.
fn is_straight(chains: &[Chain], axis: usize) -> bool {
    let along = |segment: &PathSeg| {
        let PathSeg::Line(line) = segment else { return false };
        let way = line.p1 - line.p0;
        let off = if axis == 0 { way.y } else { way.x };
        off.abs() <= 1e-3 * way.hypot()
    };
    chains.iter().flat_map(|chain| &chain.segments).all(along)
}

/// Whether something that ends at an edge, and not at the opposite one too, is no part of anything: others, which no edge cuts, are like
/// it.
fn ends_as_a_whole(piece: &Piece, units: &[Unit], pieces: &[Piece], cell: &Cell) -> bool {
    let frame = cell.frame.inflate(cell.near(), cell.near());
    let sides = sides(piece, cell);
    let is_through = sides.iter().any(|side| sides.contains(&opposite(*side)));
    if sides.is_empty() || is_through || frame.union(piece.extent) != frame {
        return false;
    }
    let longer = piece.extent.width().max(piece.extent.height());
    let is_alike = |other: &Rect| {
        (other.width() - piece.extent.width()).abs() <= ALIKE * longer
            && (other.height() - piece.extent.height()).abs() <= ALIKE * longer
    };
    let whole = pieces.iter().filter(|other| self::sides(other, cell).is_empty()).map(|other| &other.extent);
    units.iter().filter(|unit| !unit.is_cut).map(|unit| &unit.extent).chain(whole).any(is_alike)
}

/// The edges that cut a piece, or that it ends at.
fn sides(piece: &Piece, cell: &Cell) -> Vec<usize> {
    let mut sides: Vec<usize> = piece.gaps.iter().map(|gap| gap.side).collect();
    if !piece.is_filled {
        let ends = piece.chains.iter().filter(|chain| !chain.is_closed).flat_map(|chain| [chain.end(0), chain.end(1)]);
        sides.extend(ends.flat_map(|at| SIDES.into_iter().filter(move |side| cell.is_on(*side, at))));
    }
    sides
}
