//! Periods that the author does not speak of: pages whose opposite edges cut what fits together.

use std::collections::BTreeSet;

use kurbo::{PathSeg, Rect};

use crate::svg::swatch::{
    cell::{Cell, SIDES, opposite},
    fit::{Ending, is_upright, misfit},
    links::Links,
    pieces::{Chain, GapEnd, Piece},
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
    if is_clipped(units) || pieces.iter().any(|piece| ends_as_a_whole(piece, &units.all, pieces, cell)) {
        return false;
    }
    (0..2).all(|axis| units.doubled[axis] > 0 || goes_on(pieces, links, cell, axis))
}

/// Whether something had to be clipped, because it could not be cut.
fn is_clipped(units: &Units) -> bool {
    units.all.iter().any(|unit| unit.node.viewport_clip.is_some())
}

/// Pieces beyond which a page is not taken for a period by most of what its edges cut.
const MOST_PIECES: usize = 400;
/// With more whole things than this, a page shows enough as it is unless its edges leave no doubt.
const ENOUGH: usize = 12;
/// Share of what the edges cut along an axis that goes on: of a page that may be a period, and of one that can be nothing else.
const HALF: f64 = 0.5;
const CLEAR: f64 = 0.7;
/// So many that go on are no chance.
const SEVERAL: usize = 3;

/// Whether a page is likely to be one period: along an axis most of what its edges cut goes on at the opposite one, not only as straight
/// lines do along it.
pub(crate) fn is_likely(units: &Units, pieces: &[Piece], links: &Links, cell: &Cell) -> bool {
    if is_clipped(units) || units.all.len() > MOST || pieces.len() > MOST_PIECES || !is_drawn_to_fit(links, cell) {
        return false;
    }
    if ends_as_drawn(units, pieces, cell) {
        return true;
    }
    let whole = units.all.iter().filter(|unit| !unit.is_cut).count()
        + pieces.iter().filter(|piece| sides(piece, cell).is_empty()).count();
    (0..2).any(|axis| {
        let [on, all] = counts(pieces, links, cell, axis);
        let share = on as f64 / all.max(1) as f64;
        let is_clear = on >= SEVERAL && share >= CLEAR;
        let is_enough = if whole >= ENOUGH { is_clear } else { on > 0 && share >= HALF };
        is_enough && goes_on(pieces, links, cell, axis)
    })
}

/// Whether what lies at the edges was put there: all sides are along the edges, and nothing reaches beyond these; or things lie flush with
/// one edge across each axis, and not with the other, and are whole as others are.
fn ends_as_drawn(units: &Units, pieces: &[Piece], cell: &Cell) -> bool {
    let frame = cell.frame.inflate(cell.near(), cell.near());
    let at = |side: usize| {
        pieces.iter().filter(move |piece| self::sides(piece, cell).contains(&side)).collect::<Vec<&Piece>>()
    };
    let flush = SIDES.map(at);
    if pieces.iter().any(|piece| !piece.is_filled || frame.union(piece.extent) != frame) {
        return false;
    }
    let all_upright = units.all.iter().all(|unit| unit.is_cut) && pieces.iter().all(is_upright);
    let gaps = |side: usize| pieces.iter().flat_map(|piece| &piece.gaps).filter(|gap| gap.side == side).count();
    if all_upright && SIDES.into_iter().all(|side| gaps(side) >= 2) {
        return true;
    }
    (0..2).all(|axis| {
        let (here, there) = (&flush[2 * axis], &flush[2 * axis + 1]);
        let one = if there.is_empty() { here } else { there };
        (here.is_empty() || there.is_empty())
            && one.len() >= 2
            && one.iter().all(|piece| ends_as_a_whole(piece, &units.all, pieces, cell))
    })
}

/// Whether strokes that go on do so exactly: by hand, lines at about the same places come to opposite edges of any page.
fn is_drawn_to_fit(links: &Links, cell: &Cell) -> bool {
    links.ends.is_empty() || links.loose.is_empty() && links.off <= cell.near()
}

/// Whether most of what there is lies where something else does.
fn is_heaped(units: &Units, cell: &Cell) -> bool {
    let key = |unit: &Unit| {
        [unit.extent.x0, unit.extent.y0, unit.extent.x1, unit.extent.y1].map(|v| (v / cell.apart()).round() as i64)
    };
    let places: BTreeSet<_> = units.all.iter().map(key).collect();
    2 * places.len() < units.all.len()
}

/// Whether a page that shows too little to be continued may be one period: nothing is drawn beyond its edges that does not go on.
///
/// Strokes have to go on along both axes: a few that lie within the page are a drawing, and no swatch.
pub(crate) fn is_possible(units: &Units, pieces: &[Piece], links: &Links, cell: &Cell) -> bool {
    let has_lines = units.all.iter().any(|unit| unit.is_stroked && !unit.is_filled);
    let goes_on = || (0..2).all(|axis| counts(pieces, links, cell, axis)[0] > 0);
    !units.all.is_empty()
        && !is_clipped(units)
        && is_drawn_to_fit(links, cell)
        && !is_heaped(units, cell)
        && !is_cut_out(pieces, links, cell)
        && (!has_lines || goes_on())
}

/// Edges at which something ends before a page is a part cut out of something larger.
const EDGES: usize = 3;

/// Whether a page is a part cut out of something larger: what ends along its edges does so all around, and less of it than not goes on
/// at the opposite ones. Shapes that were put there end at the ground they stand on, or have sides along the edges alone.
fn is_cut_out(pieces: &[Piece], links: &Links, cell: &Cell) -> bool {
    let mut open = [false; 4];
    for (p, piece) in pieces.iter().enumerate().filter(|(_, piece)| !piece.covers && !is_upright(piece)) {
        for (gap, link) in piece.gaps.iter().zip(&links.gaps[p]) {
            open[gap.side] |= link.is_none() && gap.ends != [GapEnd::Corner; 2];
        }
    }
    let [on, all] = [0, 1]
        .map(|axis| counts(pieces, links, cell, axis))
        .into_iter()
        .fold([0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    open.into_iter().filter(|open| *open).count() >= EDGES && (on as f64) < HALF * all as f64
}

/// How much of what the edges across an axis cut goes on, and how much they cut.
fn counts(pieces: &[Piece], links: &Links, cell: &Cell, axis: usize) -> [usize; 2] {
    let (mut on, mut all) = (0, 0);
    for (p, piece) in pieces.iter().enumerate().filter(|(_, piece)| !piece.covers) {
        for (gap, link) in piece.gaps.iter().zip(&links.gaps[p]).filter(|(gap, _)| gap.side / 2 == axis) {
            // What reaches from corner to corner lies behind it all.
            if gap.ends != [GapEnd::Corner; 2] {
                (on, all) = (on + usize::from(link.is_some()), all + 1);
            }
        }
    }
    let is_across = |&[p, chain, which]: &[usize; 3]| {
        let at = pieces[p].chains[chain].end(which);
        SIDES.into_iter().any(|side| side / 2 == axis && cell.is_on(side, at))
    };
    let ends = links.ends.keys().filter(|end| is_across(end)).count();
    [on + ends, all + ends + links.loose.iter().filter(|end| is_across(end)).count()]
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
