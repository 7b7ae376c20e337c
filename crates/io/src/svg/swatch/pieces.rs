//! Subpaths cut at the edges of the cell: the chains of segments that are left, and the gaps along the edges between
//! them.

use kurbo::{BezPath, Line, ParamCurve, PathSeg, Point, Rect, Shape, Vec2};

use crate::svg::{
    shape::subpath::is_closed,
    swatch::{
        cell::{Cell, SIDES, across, along},
        units::Unit,
    },
};

/// A part of a subpath that lies in the cell, in one piece.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub(crate) segments: Vec<PathSeg>,
    /// Whether it ends where it starts.
    pub(crate) is_closed: bool,
}

impl Chain {
    /// Where it starts (0) or ends (1).
    pub(crate) fn end(&self, which: usize) -> Point {
        let of = if which == 0 { self.segments.first() } else { self.segments.last() };
        of.map_or(Point::ZERO, |s| if which == 0 { s.start() } else { s.end() })
    }

    /// Whether it is no more than a place of an edge where an outline turns.
    pub(crate) fn is_turn(&self) -> bool {
        matches!(self.segments[..], [PathSeg::Line(line)] if line.p0 == line.p1)
    }

    /// The way out of it at an end, of length 1.
    pub(crate) fn way_out(&self, which: usize) -> Vec2 {
        let at = self.end(which);
        let of = if which == 0 { self.segments.first() } else { self.segments.last() };
        let before = of.map_or(at, |s| s.eval(if which == 0 { 0.05 } else { 0.95 }));
        let way = at - before;
        if way.hypot() > 0.0 { way.normalize() } else { way }
    }
}

/// An end of a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GapEnd {
    /// The start (0) or end (1) of a chain.
    Chain(usize, usize),
    /// A corner of the cell.
    Corner,
}

/// A stretch of an edge along which the edge cuts something that is filled.
#[derive(Clone, Debug)]
pub(crate) struct Gap {
    pub(crate) side: usize,
    /// From where to where, along the edge.
    pub(crate) range: [f64; 2],
    pub(crate) ends: [GapEnd; 2],
}

/// What is left of one subpath in the cell.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// The thing that it belongs to.
    pub(crate) unit: usize,
    pub(crate) extent: Rect,
    pub(crate) chains: Vec<Chain>,
    /// For fills; none for strokes.
    pub(crate) gaps: Vec<Gap>,
    pub(crate) is_filled: bool,
    /// Whether it fills the whole cell.
    pub(crate) covers: bool,
}

/// The pieces of a thing that the edges cut.
pub(crate) fn pieces(number: usize, unit: &Unit, cell: &Cell) -> Vec<Piece> {
    let Some(path) = &unit.path else { return Vec::new() };
    let subpaths = path.subpaths().map(|elements| (is_closed(elements), BezPath::from_vec(elements.to_vec())));
    subpaths
        .filter_map(|(is_closed, mut subpath)| {
            if unit.is_filled && !is_closed {
                subpath.close_path();
            }
            let chains = chains(&subpath, cell, unit.is_filled, is_closed || unit.is_filled);
            let covers = unit.is_filled && chains.is_empty() && subpath.winding(cell.frame.center()) != 0;
            let gaps = if unit.is_filled { gaps(&subpath, &chains, cell) } else { Vec::new() };
            let extent = subpath.bounding_box();
            let piece = Piece { unit: number, extent, chains, gaps, is_filled: unit.is_filled, covers };
            (covers || !piece.chains.is_empty()).then_some(piece)
        })
        .collect()
}

/// Parts along an edge no longer than this, in terms of what is near to it, are no cut: lines, and arcs, which leave it slowly.
const SLIVER: f64 = 0.5;
const ARC: f64 = 5.0;

/// The parts of a subpath in the cell. What runs along an edge is a cut where the subpath is filled, else a part of it.
fn chains(subpath: &BezPath, cell: &Cell, is_filled: bool, is_closed: bool) -> Vec<Chain> {
    let mut parts: Vec<(PathSeg, bool)> = Vec::new();
    for segment in subpath.segments() {
        for part in split(segment, cell) {
            if part.is_point(1e-3 * cell.near()) {
                continue;
            }
            let middle = part.eval(0.5);
            let on_edge =
                SIDES.into_iter().any(|s| [part.start(), middle, part.end()].iter().all(|p| cell.is_on(s, *p)));
            // An arc that touches the edge is split there, and a sliver of it lies on the edge.
            let slack = if matches!(part, PathSeg::Line(_)) { SLIVER } else { ARC };
            let is_sliver = (part.end() - part.start()).hypot() <= slack * cell.near();
            let is_kept = match (on_edge, is_sliver) {
                (true, false) => !is_filled && is_within(cell, middle),
                (true, true) => is_within(cell, middle),
                (false, _) => cell.frame.contains(middle),
            };
            parts.push((part, is_kept));
        }
    }
    if parts.iter().all(|(_, is_kept)| *is_kept) {
        let segments: Vec<_> = parts.into_iter().map(|(part, _)| part).collect();
        return if segments.is_empty() { Vec::new() } else { vec![Chain { segments, is_closed }] };
    }
    if is_closed && let Some(first) = parts.iter().position(|(_, is_kept)| !is_kept) {
        parts.rotate_left(first);
    }
    let mut chains: Vec<Chain> = Vec::new();
    let mut was_kept = false;
    for (part, is_kept) in parts {
        match chains.last_mut() {
            _ if !is_kept => {}
            Some(chain) if was_kept && (chain.end(1) - part.start()).hypot() <= cell.near() => {
                chain.segments.push(part)
            }
            _ => chains.push(Chain { segments: vec![part], is_closed: false }),
        }
        was_kept = is_kept;
    }
    if !is_filled {
        // What an edge leaves of a stroke that hardly reaches in.
        chains.retain(|chain| chain.segments.iter().map(|s| (s.end() - s.start()).hypot()).sum::<f64>() > cell.near());
    }
    chains
}

fn is_within(cell: &Cell, at: Point) -> bool {
    cell.frame.inflate(cell.near(), cell.near()).contains(at)
}

trait Tiny {
    /// Whether it has no length to speak of.
    fn is_point(&self, near: f64) -> bool;
}

impl Tiny for PathSeg {
    fn is_point(&self, near: f64) -> bool {
        [1.0, 0.5].into_iter().all(|t| (self.eval(t) - self.start()).hypot() <= near)
    }
}

/// A segment, cut where it crosses the lines along the edges.
fn split(segment: PathSeg, cell: &Cell) -> Vec<PathSeg> {
    const LEAST: f64 = 1e-6;
    let b = segment.bounding_box().union(cell.frame);
    let reach = 1.0 + b.width() + b.height();
    let mut at = vec![0.0, 1.0];
    for side in SIDES {
        let [low, high] = cell.range(side);
        let line = Line::new(cell.on(side, low - reach), cell.on(side, high + reach));
        at.extend(segment.intersect_line(line).iter().map(|hit| hit.segment_t));
    }
    at.retain(|t| *t == 0.0 || *t == 1.0 || (LEAST..1.0 - LEAST).contains(t));
    at.sort_by(f64::total_cmp);
    at.dedup_by(|b, a| *b - *a < LEAST && *b < 1.0);
    at.windows(2).map(|t| segment.subsegment(t[0]..t[1])).collect()
}

/// The stretches of the edges that the inside of a closed subpath lies along.
fn gaps(subpath: &BezPath, chains: &[Chain], cell: &Cell) -> Vec<Gap> {
    let inward = [Vec2::new(1.0, 0.0), Vec2::new(-1.0, 0.0), Vec2::new(0.0, 1.0), Vec2::new(0.0, -1.0)];
    let mut gaps = Vec::new();
    for side in SIDES {
        let [low, high] = cell.range(side);
        let mut stops: Vec<(f64, GapEnd)> = Vec::new();
        for (k, chain) in chains.iter().enumerate().filter(|(_, chain)| !chain.is_closed) {
            for which in 0..2 {
                let at = chain.end(which);
                if (across(side, at) - cell.level(side)).abs() <= cell.near() {
                    stops.push((along(side, at), GapEnd::Chain(k, which)));
                }
            }
        }
        for corner in [low, high] {
            if stops.iter().all(|(at, _)| (at - corner).abs() > cell.near()) {
                stops.push((corner, GapEnd::Corner));
            }
        }
        stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Of chains that meet at one place of the edge, the one that leads back comes first: it bounds what lies before.
        let lean = |end: GapEnd| match end {
            GapEnd::Chain(k, which) => -along(side, chains[k].way_out(which).to_point()),
            GapEnd::Corner => 0.0,
        };
        for together in stops.chunk_by_mut(|a, b| b.0 - a.0 <= cell.near()) {
            together.sort_by(|a, b| lean(a.1).total_cmp(&lean(b.1)));
        }
        for pair in stops.windows(2) {
            let (from, to) = (pair[0].0, pair[1].0);
            let depth = inward[side] * cell.near().min(0.02 * (to - from));
            // Nearly all along: an arc that touches the edge at one place is not cut by it, and a gap may narrow to a point.
            let is_inside = |share: f64| subpath.winding(cell.on(side, from + share * (to - from)) + depth) != 0;
            let inside = [0.2, 0.5, 0.8].into_iter().filter(|share| is_inside(*share)).count();
            if to - from > cell.near() && inside >= 2 {
                gaps.push(Gap { side, range: [from, to], ends: [pair[0].1, pair[1].1] });
            }
        }
    }
    gaps
}
