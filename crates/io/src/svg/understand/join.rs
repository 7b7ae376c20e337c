//! Joining what belongs together: strokes that touch, and pieces of one colour that abut.

use arabesque_core::{Bounds, DisjointSets, Result};

use crate::svg::{
    options::{LargeFills, Method},
    parse::notes::Note,
    shape::{
        adjacency::{Edge, Looks, edges_meet, meeting},
        extent::longer,
        painted_area::Painter,
    },
    understand::{
        abutting,
        item::{Item, Origin, Selection},
    },
};

/// Pairs of edges that are looked at in one file.
const EDGE_PAIRS: u64 = 200_000_000;

/// Work for each of them.
const PAIR: u64 = 10;

/// Gap that still counts as touching, as a share of the frame.
pub(crate) const SEAM: f64 = 2e-4;

/// Joins items: pieces of the same colour that touch always, strokes and what they touch when every connected piece is
/// an element. Lines that seams cut are joined to strokes, unless fills painted alike are areas.
pub(crate) fn join(
    found: Selection,
    painter: &Painter<'_, '_>,
    frame: Bounds<2>,
    (method, large_fills): (Method, LargeFills),
) -> Result<Selection> {
    let Selection { items, background, left_out } = found;
    let tolerance = SEAM * longer(&frame);
    let items = if method == Method::Elements || large_fills == LargeFills::AreasAlike {
        items
    } else {
        abutting::join_lines(items, painter, frame, tolerance)?
    };
    let colours: Vec<String> = items.iter().map(|item| item.painted.colours_key()).collect();
    let may_join = |i: usize, j: usize| {
        let (a, b) = (items[i].origin, items[j].origin);
        let pieces = a == Origin::Piece && b == Origin::Piece && colours[i] == colours[j];
        let loose = a != Origin::Whole && b != Origin::Whole;
        let is_done = items[i].lines.is_some() || items[j].lines.is_some();
        (!is_done && pieces) || (method == Method::Elements && loose && (a == Origin::Stroke || b == Origin::Stroke))
    };
    let items = if items.iter().any(|item| matches!(item.origin, Origin::Piece | Origin::Stroke)) {
        let groups = connected(&items, may_join, tolerance, painter)?;
        let merged = |group: Vec<usize>| Item::merged(&items, &group, frame, painter.source.budget);
        groups.into_iter().map(merged).collect::<Result<_>>()?
    } else {
        items
    };
    Ok(Selection { items, background, left_out })
}

/// Items in groups of which each holds together by touching; only pairs that may join are looked at.
///
/// # Errors
/// As [`arabesque_core::Budget::spend`].
pub(crate) fn connected(
    items: &[Item],
    may_join: impl Fn(usize, usize) -> bool,
    tolerance: f64,
    painter: &Painter<'_, '_>,
) -> Result<Vec<Vec<usize>>> {
    let boxes: Vec<_> = items.iter().map(|item| item.outline.bounds()).collect();
    let edges: Vec<Vec<Edge>> = items.iter().map(|item| item.outline.edges().collect()).collect();
    let mut sets = DisjointSets::new(items.len());
    let mut looks = Looks(EDGE_PAIRS);
    meeting(
        &boxes,
        |_| 0.5 * tolerance,
        painter.source.budget,
        |i, j| {
            if !may_join(i, j) || sets.of(i) == sets.of(j) {
                return true;
            }
            let meets = edges_meet(&edges[i], &edges[j], tolerance, &mut looks);
            let inside = |a: &Item, b: &Item| a.outline.points().next().is_some_and(|p| b.outline.contains(p));
            match meets {
                Some(true) => sets.join(i, j),
                Some(false) if inside(&items[i], &items[j]) || inside(&items[j], &items[i]) => sets.join(i, j),
                Some(false) => {}
                None => painter.source.notes.add(Note::TooTangled, || "not all touching strokes joined".to_owned()),
            }
            meets.is_some()
        },
    )?;
    painter.source.budget.spend(PAIR * (EDGE_PAIRS - looks.0))?;
    Ok(sets.groups())
}
