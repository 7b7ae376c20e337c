//! Fills that abut along a seam: a pattern of copied tiles cuts its lines at the border of each tile, and no eye sees where.
//!
//! Shapes of one colour whose borders run along one another are joined where all of them together are lines of one width over most of
//! the frame. Everything else stays as it is drawn: tiles of one colour side by side may well be separate elements.

use std::rc::Rc;

use arabesque_core::{Bounds, Vector};

use super::{
    item::{Item, Kind, Origin},
    join::merged,
    touch::{Budget, Edge, Sets, meeting},
};
use crate::centreline::centrelines;

/// Pairs of edges that are looked at in one file.
const EDGE_PAIRS: u64 = 200_000_000;

/// Borders run along one another when they do so for at least this many tolerances.
const LEAST: f64 = 5.0;

/// Joins what abuts along seams within `tolerance` where it makes lines.
pub(super) fn join_lines(items: Vec<Item>, frame: Bounds<2>, tolerance: f64) -> Vec<Item> {
    let groups = abutting(&items, tolerance);
    let mut joined = Vec::with_capacity(items.len());
    for group in groups {
        match net(&items, &group, frame) {
            Some(net) => joined.push(net),
            None => joined.extend(group.into_iter().map(|i| items[i].clone())),
        }
    }
    joined
}

/// The lines that a group of items draws together, where they reach over most of the frame.
fn net(items: &[Item], group: &[usize], frame: Bounds<2>) -> Option<Item> {
    let extent = group.iter().fold(Bounds::EMPTY, |all, &i| all.union(&items[i].outline.bounds()));
    if group.len() < 2 || extent.measure() < 0.5 * frame.measure() {
        return None;
    }
    let mut net = merged(items, group, frame);
    net.lines = Some(Rc::new(centrelines(&net.outline, Some(&frame))?));
    net.kind = Kind::Large;
    Some(net)
}

/// Items in groups that seams connect.
fn abutting(items: &[Item], tolerance: f64) -> Vec<Vec<usize>> {
    let is_fill = |item: &Item| matches!(item.origin, Origin::Fill | Origin::Piece) && item.kind != Kind::Curve;
    let colours: Vec<String> = items.iter().map(|item| item.ink.colours_key()).collect();
    let boxes: Vec<_> = items.iter().map(|item| item.outline.bounds()).collect();
    let edges: Vec<Vec<Edge>> = items.iter().map(|item| item.outline.edges().collect()).collect();
    let mut sets = Sets::new(items.len());
    let mut budget = Budget(EDGE_PAIRS);
    meeting(
        &boxes,
        |_| 0.5 * tolerance,
        |i, j| {
            let alike = is_fill(&items[i]) && is_fill(&items[j]) && colours[i] == colours[j];
            if !alike || sets.of(i) == sets.of(j) {
                return true;
            }
            let meets = budget.any(&edges[i], &edges[j], tolerance, |p, q| is_seam(p, q, tolerance));
            if meets == Some(true) {
                sets.join(i, j);
            }
            meets.is_some()
        },
    );
    sets.groups()
}

/// Whether two edges run along one another, each with the inside on the other side.
fn is_seam(p: Edge, q: Edge, tolerance: f64) -> bool {
    let way = p.1 - p.0;
    let length = way.norm();
    if length <= LEAST * tolerance || way.dot(q.1 - q.0) > 0.0 {
        return false;
    }
    let way = way * (1.0 / length);
    let off = |v: Vector<2>| way.cross(v - p.0).abs();
    let along = |v: Vector<2>| way.dot(v - p.0).clamp(0.0, length);
    off(q.0) <= tolerance && off(q.1) <= tolerance && (along(q.0) - along(q.1)).abs() > LEAST * tolerance
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
