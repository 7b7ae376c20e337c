//! Fills that abut along a seam: a pattern of copied tiles cuts its lines at the border of each tile, and no eye sees
//! where.
//!
//! Shapes of one colour whose borders run along one another are joined where all of them together are lines of one
//! width over most of the frame, or where pieces of them are, once compound paths are taken apart: a net with motifs in
//! its cells, or outlines of leaves. Everything else stays as it is drawn: tiles of one colour side by side may well be
//! separate elements.

use std::{collections::BTreeMap, rc::Rc};

use arabesque_core::{Bounds, Budget, DisjointSets, Result, Vector, ring};

use crate::svg::{
    centreline::centrelines,
    shape::{
        adjacency::{Edge, Looks, edge_distance, meeting},
        painted_area::Painter,
    },
    understand::item::{Item, Kind, Origin},
};

/// Pairs of edges that are looked at in one file.
const EDGE_PAIRS: u64 = 200_000_000;

/// Work for each of them.
const PAIR: u64 = 10;

/// Share of the painted area of tiles that lines make up where tiles without a net are put together.
const NEARLY_ALL: f64 = 0.9;

/// Borders run along one another when they do so for at least this many tolerances.
const MIN_SEAM: f64 = 5.0;

/// Joins what abuts along seams within `tolerance` where it makes lines.
///
/// # Errors
/// As [`Painter::painted`].
pub(crate) fn join_lines(
    items: Vec<Item>,
    painter: &Painter<'_, '_>,
    frame: Bounds<2>,
    tolerance: f64,
) -> Result<Vec<Item>> {
    let mut joined = Vec::with_capacity(items.len());
    for group in abutting(&items, tolerance, painter.source.budget)? {
        let tiles: Vec<Item> = group.iter().map(|&i| items[i].clone()).collect();
        match tiles.len() {
            1 => joined.extend(tiles),
            _ => joined.extend(whole(&tiles, painter, frame, tolerance)?.unwrap_or(tiles)),
        }
    }
    Ok(joined)
}

/// What tiles show together: one net, or, where they are taken apart, lines and other things.
fn whole(tiles: &[Item], painter: &Painter<'_, '_>, frame: Bounds<2>, tolerance: f64) -> Result<Option<Vec<Item>>> {
    let all: Vec<usize> = (0..tiles.len()).collect();
    let budget = painter.source.budget;
    let merged = Item::merged(tiles, &all, frame, budget)?;
    if let Some(net) = lined(merged, frame, budget)?.filter(|net| net.kind == Kind::Large) {
        return Ok(Some(vec![net]));
    }
    if tiles.iter().all(|tile| tile.compound.is_none()) {
        return Ok(None);
    }
    let Pieces { items, homes } = apart(tiles, painter, frame)?;
    let (mut has_net, mut painted, mut lines) = (false, 0.0, 0.0);
    let mut found = Vec::new();
    let mut place = vec![0; items.len()];
    for group in touching(&items, tolerance, budget)? {
        group.iter().for_each(|&i| place[i] = found.len());
        let one = Item::merged(&items, &group, frame, budget)?;
        let area = one.outline.area();
        let item = lined(one.clone(), frame, budget)?.inspect(|_| lines += area).unwrap_or(one);
        // What is not a net now is a thing of its own, and not a scrap of one.
        let origin = if item.lines.is_some() { item.origin } else { Origin::Whole };
        let item = Item { origin, ..item };
        has_net |= item.lines.is_some();
        painted += area;
        found.push(item);
    }
    let homes: Vec<_> = homes.into_iter().map(|(i, home)| (place[i], place[home])).collect();
    if has_net || lines >= NEARLY_ALL * painted {
        return Ok(Some(nested(&found, &homes, frame, budget)?));
    }
    Ok(None)
}

/// An item with its lines; `None` where it is not a set of lines of one width.
fn lined(item: Item, frame: Bounds<2>, budget: &Budget) -> Result<Option<Item>> {
    let lines = centrelines(&item.outline, Some(&frame), budget)?;
    Ok(lines.map(|lines| Item { lines: (item.kind == Kind::Large).then(|| Rc::new(lines)), ..item }))
}

/// Tiles taken apart.
struct Pieces {
    items: Vec<Item>,
    /// Pieces in the hole of another piece of the same tile, with the number of that.
    homes: Vec<(usize, usize)>,
}

fn apart(tiles: &[Item], painter: &Painter<'_, '_>, frame: Bounds<2>) -> Result<Pieces> {
    let mut pieces = Pieces { items: Vec::new(), homes: Vec::new() };
    for tile in tiles {
        let Some((compound, which)) = &tile.compound else {
            pieces.items.push(tile.clone());
            continue;
        };
        compound.note_losses(painter);
        let mut place = BTreeMap::new();
        for &k in which {
            if let Some(item) = Item::of_pieces(compound, painter, vec![k], frame)? {
                place.insert(k, pieces.items.len());
                pieces.items.push(item);
            }
        }
        let home = |k: usize| Some((*place.get(&k)?, *place.get(&compound.pieces[k].within?)?));
        pieces.homes.extend(which.iter().filter_map(|&k| home(k)));
    }
    Ok(pieces)
}

/// Joins what lies in the hole of something no larger than an element to it, or did so in a tile.
fn nested(items: &[Item], homes: &[(usize, usize)], frame: Bounds<2>, budget: &Budget) -> Result<Vec<Item>> {
    let boxes: Vec<_> = items.iter().map(|item| item.outline.bounds()).collect();
    let may_hold = |home: usize| items[home].kind == Kind::Element;
    let is_around = |home: usize, k: usize| {
        let point = items[k].outline.points().next();
        may_hold(home) && point.is_some_and(|p| items[home].outline.rings.iter().any(|r| ring::winding(r, p) != 0))
    };
    let mut sets = DisjointSets::new(items.len());
    homes.iter().filter(|(_, home)| may_hold(*home)).for_each(|&(k, home)| sets.join(k, home));
    meeting(
        &boxes,
        |_| 0.0,
        budget,
        |i, j| {
            if is_around(i, j) || is_around(j, i) {
                sets.join(i, j);
            }
            true
        },
    )?;
    sets.groups().iter().map(|group| Item::merged(items, group, frame, budget)).collect()
}

/// Items in groups that seams connect.
fn abutting(items: &[Item], tolerance: f64, budget: &Budget) -> Result<Vec<Vec<usize>>> {
    grouped(items, tolerance, budget, |p, q| is_seam(p, q, tolerance))
}

/// Items in groups whose borders meet.
fn touching(items: &[Item], tolerance: f64, budget: &Budget) -> Result<Vec<Vec<usize>>> {
    grouped(items, tolerance, budget, |p, q| edge_distance(p, q) <= tolerance)
}

/// Fills of one colour in groups, connected where a test holds for an edge of either.
fn grouped(
    items: &[Item],
    tolerance: f64,
    budget: &Budget,
    test: impl Fn(Edge, Edge) -> bool,
) -> Result<Vec<Vec<usize>>> {
    let is_fill = |item: &Item| matches!(item.origin, Origin::Fill | Origin::Piece) && item.kind != Kind::Curve;
    let colours: Vec<String> = items.iter().map(|item| item.painted.colours_key()).collect();
    let boxes: Vec<_> = items.iter().map(|item| item.outline.bounds()).collect();
    let edges: Vec<Vec<Edge>> = items.iter().map(|item| item.outline.edges().collect()).collect();
    let mut sets = DisjointSets::new(items.len());
    let mut looks = Looks(EDGE_PAIRS);
    meeting(
        &boxes,
        |_| 0.5 * tolerance,
        budget,
        |i, j| {
            let alike = is_fill(&items[i]) && is_fill(&items[j]) && colours[i] == colours[j];
            if !alike || sets.of(i) == sets.of(j) {
                return true;
            }
            let meets = looks.any(&edges[i], &edges[j], tolerance, &test);
            if meets == Some(true) {
                sets.join(i, j);
            }
            meets.is_some()
        },
    )?;
    budget.spend(PAIR * (EDGE_PAIRS - looks.0))?;
    Ok(sets.groups())
}

/// Whether two edges run along one another, each with the inside on the other side.
fn is_seam(p: Edge, q: Edge, tolerance: f64) -> bool {
    let way = p.1 - p.0;
    let length = way.norm();
    if length <= MIN_SEAM * tolerance || way.dot(q.1 - q.0) > 0.0 {
        return false;
    }
    let way = way * (1.0 / length);
    let off = |v: Vector<2>| way.cross(v - p.0).abs();
    let along = |v: Vector<2>| way.dot(v - p.0).clamp(0.0, length);
    off(q.0) <= tolerance && off(q.1) <= tolerance && (along(q.0) - along(q.1)).abs() > MIN_SEAM * tolerance
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(a: (f64, f64), b: (f64, f64)) -> Edge {
        (Vector::xy(a.0, a.1), Vector::xy(b.0, b.1))
    }

    #[test]
    fn a_seam_is_one_line_from_both_sides() {
        let p = edge((0.0, 0.0), (10.0, 0.0));
        assert!(is_seam(p, edge((12.0, 0.0), (5.0, 0.0)), 0.1));
        assert!(!is_seam(p, edge((5.0, 0.0), (12.0, 0.0)), 0.1), "the inside lies on the same side");
        assert!(!is_seam(p, edge((20.0, 0.0), (10.0, 0.0)), 0.1), "end to end");
        assert!(!is_seam(p, edge((9.0, 0.0), (3.0, 4.0)), 0.1), "across");
        assert!(!is_seam(p, edge((9.0, 0.5), (3.0, 0.5)), 0.1), "beside");
    }
}
