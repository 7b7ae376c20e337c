//! Cut things put together over the edges of the cells, in a layout of several.

use std::collections::BTreeMap;

use arabesque_core::{Budget, DisjointSets, Result};
use kurbo::{Affine, BezPath, ParamCurve, Point, Shape};

use crate::svg::swatch::{
    cell::{Cell, beyond},
    links::Links,
    pieces::{GapEnd, Piece},
};

/// Work for each chain that is walked along.
const CHAIN: u64 = 50;
/// Corners that a walk may pass between two chains.
const CORNERS: usize = 64;

/// The cells of a layout: from the first to before the last, in columns and rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    pub(crate) from: [i64; 2],
    pub(crate) to: [i64; 2],
}

impl Layout {
    /// All cells, row by row.
    pub(crate) fn tiles(self) -> impl Iterator<Item = [i64; 2]> {
        (self.from[1]..self.to[1]).flat_map(move |j| (self.from[0]..self.to[0]).map(move |i| [i, j]))
    }

    pub(crate) fn count(self) -> usize {
        (0..2).map(|k| (self.to[k] - self.from[k]).max(0) as usize).product()
    }

    /// The number of a cell; `None` beyond the layout.
    fn number(self, tile: [i64; 2]) -> Option<usize> {
        let is_in = (0..2).all(|k| (self.from[k]..self.to[k]).contains(&tile[k]));
        let row = (self.to[0] - self.from[0]) as usize;
        is_in.then(|| (tile[1] - self.from[1]) as usize * row + (tile[0] - self.from[0]) as usize)
    }
}

/// A path that was put together.
#[derive(Clone, Debug)]
pub(crate) struct Welded {
    /// The thing that it began with.
    pub(crate) unit: usize,
    pub(crate) path: BezPath,
}

/// Puts all pieces of a layout together: what is left of the edges of a cell are those of the layout, and those that nothing goes on at.
pub(crate) fn weld(
    pieces: &[Piece],
    links: &Links,
    cell: &Cell,
    layout: Layout,
    budget: &Budget,
) -> Result<Vec<Welded>> {
    let mut offsets = vec![0];
    pieces.iter().for_each(|piece| offsets.push(offsets.last().unwrap_or(&0) + piece.chains.len()));
    let chains = offsets.last().copied().unwrap_or(0);
    budget.spend(CHAIN * (layout.count() * (chains + pieces.len())) as u64)?;
    let gap_at = pieces.iter().map(gaps_at).collect();
    let seen = vec![false; layout.count() * chains];
    let mut welder = Welder { pieces, links, cell, layout, offsets, gap_at, seen };
    let mut all = welder.areas(budget)?;
    all.extend(welder.strokes());
    all.sort_by_key(|welded| welded.unit);
    Ok(all)
}

/// The gap that a chain ends at, and which end of it that is.
fn gaps_at(piece: &Piece) -> BTreeMap<(usize, usize), (usize, usize)> {
    let mut at = BTreeMap::new();
    for (g, gap) in piece.gaps.iter().enumerate() {
        for (e, end) in gap.ends.into_iter().enumerate() {
            if let GapEnd::Chain(chain, which) = end {
                at.entry((chain, which)).or_insert((g, e));
            }
        }
    }
    at
}

/// An end of a chain in a cell of the layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stop {
    tile: [i64; 2],
    piece: usize,
    chain: usize,
    which: usize,
}

struct Welder<'p> {
    pieces: &'p [Piece],
    links: &'p Links,
    cell: &'p Cell,
    layout: Layout,
    /// Of the first chain of each piece, among all chains of a cell.
    offsets: Vec<usize>,
    gap_at: Vec<BTreeMap<(usize, usize), (usize, usize)>>,
    /// Chains of the layout that were walked along.
    seen: Vec<bool>,
}

impl Welder<'_> {
    fn instance(&self, stop: Stop) -> Option<usize> {
        let chains = self.offsets.last()?;
        Some(self.layout.number(stop.tile)? * chains + self.offsets[stop.piece] + stop.chain)
    }

    /// Walks along a chain from one of its ends, once; `None` where that was done, else the other end.
    fn walk(&mut self, from: Stop, path: &mut BezPath) -> Option<Stop> {
        let instance = self.instance(from)?;
        if std::mem::replace(&mut self.seen[instance], true) {
            return None;
        }
        let chain = &self.pieces[from.piece].chains[from.chain];
        let shift = Affine::translate(self.cell.shift(from.tile));
        let mut segments: Vec<_> = chain.segments.iter().map(|s| shift * *s).collect();
        if from.which == 1 {
            segments = segments.into_iter().rev().map(|s| s.reverse()).collect();
        }
        if path.elements().is_empty() {
            path.move_to(segments.first()?.start());
        }
        segments.iter().for_each(|s| path.push(s.as_path_el()));
        Some(Stop { which: 1 - from.which, ..from })
    }

    fn areas(&mut self, budget: &Budget) -> Result<Vec<Welded>> {
        let groups = self.groups(budget)?;
        let mut found: BTreeMap<usize, Welded> = BTreeMap::new();
        let filled: Vec<usize> = (0..self.pieces.len()).filter(|&p| self.pieces[p].is_filled).collect();
        let mut order = Vec::new();
        let of_piece = |piece: usize| (0..self.pieces[piece].chains.len()).map(move |chain| (piece, chain));
        let all: Vec<(usize, usize)> = filled.iter().copied().flat_map(of_piece).collect();
        // Turns along an edge have no way of their own: outlines keep that of the chains that they were drawn with.
        let (turns, drawn): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|&(piece, chain)| self.pieces[piece].chains[chain].is_turn());
        for chains in [drawn, turns] {
            for (number, tile) in self.layout.tiles().enumerate() {
                for &(piece, chain) in &chains {
                    let group = groups[number * self.pieces.len() + piece];
                    let Some(outline) = self.outline(Stop { tile, piece, chain, which: 0 }) else { continue };
                    let unit = self.pieces[piece].unit;
                    let welded = found.entry(group).or_insert_with(|| {
                        order.push(group);
                        Welded { unit, path: BezPath::new() }
                    });
                    welded.unit = welded.unit.min(unit);
                    welded.path.extend(outline);
                }
            }
        }
        let covers = self.pieces.iter().filter(|piece| piece.covers);
        let mut all: Vec<_> = covers.map(|piece| Welded { unit: piece.unit, path: self.everything() }).collect();
        let cover_of: BTreeMap<usize, usize> = all.iter().enumerate().map(|(k, cover)| (cover.unit, k)).collect();
        for welded in order.into_iter().filter_map(|group| found.remove(&group)) {
            // What lies in an outline that covers the cell are its holes.
            match cover_of.get(&welded.unit) {
                Some(&cover) => all[cover].path.extend(welded.path),
                None => all.push(welded),
            }
        }
        Ok(all)
    }

    /// The whole layout.
    fn everything(&self) -> BezPath {
        let corner = |tile| self.cell.frame.origin() + self.cell.shift(tile);
        kurbo::Rect::from_points(corner(self.layout.from), corner(self.layout.to)).to_path(0.1)
    }

    /// Which pieces of the layout are one thing: those that go on in one another, and those of one path that overlap.
    fn groups(&self, budget: &Budget) -> Result<Vec<usize>> {
        let count = self.pieces.len();
        let mut sets = DisjointSets::new(self.layout.count() * count);
        let mut of_unit: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (p, piece) in self.pieces.iter().enumerate().filter(|(_, piece)| piece.is_filled) {
            of_unit.entry(piece.unit).or_default().push(p);
        }
        let mut together = Vec::new();
        for (k, &a) in of_unit.values().flat_map(|all| all.iter().enumerate()) {
            for &b in &of_unit[&self.pieces[a].unit][k + 1..] {
                budget.spend(1)?;
                let (pa, pb) = (&self.pieces[a], &self.pieces[b]);
                let both = pa.extent.intersect(pb.extent);
                let is_over = both.width() > 0.0 && both.height() > 0.0;
                if is_over || (pa.gaps.is_empty() && pb.gaps.is_empty()) {
                    together.push((a, b));
                }
            }
        }
        for (number, tile) in self.layout.tiles().enumerate() {
            together.iter().for_each(|(a, b)| sets.join(number * count + a, number * count + b));
            for (p, g, [q, _]) in self.linked() {
                if let Some(there) = self.layout.number(plus(tile, beyond(self.pieces[p].gaps[g].side))) {
                    sets.join(number * count + p, there * count + q);
                }
            }
        }
        Ok((0..self.layout.count() * count).map(|i| sets.of(i)).collect())
    }

    fn linked(&self) -> impl Iterator<Item = (usize, usize, [usize; 2])> {
        let all = self.links.gaps.iter().enumerate();
        all.flat_map(|(p, gaps)| gaps.iter().enumerate().filter_map(move |(g, to)| to.map(|to| (p, g, to))))
    }

    /// The closed line that a chain is a part of; `None` where it was walked along.
    fn outline(&mut self, start: Stop) -> Option<BezPath> {
        let mut path = BezPath::new();
        let mut at = start;
        while let Some(end) = self.walk(at, &mut path) {
            if self.pieces[end.piece].chains[end.chain].is_closed {
                break;
            }
            let Some(next) = self.over_gap(end, &mut path) else { break };
            at = next;
        }
        if path.elements().is_empty() {
            return None;
        }
        path.close_path();
        Some(path)
    }

    /// From an end of a chain over a gap to the next chain: beyond the edge where it goes on there, else along the edge.
    fn over_gap(&self, end: Stop, path: &mut BezPath) -> Option<Stop> {
        let Stop { mut tile, mut piece, chain, which } = end;
        let (mut g, mut e) = *self.gap_at[piece].get(&(chain, which))?;
        for _ in 0..CORNERS {
            let there = plus(tile, beyond(self.pieces[piece].gaps[g].side));
            match self.links.gaps[piece][g] {
                Some([p, l]) if self.layout.number(there).is_some() => (tile, piece, g) = (there, p, l),
                _ => {
                    e = 1 - e;
                    path.line_to(self.gap_end(piece, g, e) + self.cell.shift(tile));
                }
            }
            if let GapEnd::Chain(chain, which) = self.pieces[piece].gaps[g].ends[e] {
                return Some(Stop { tile, piece, chain, which });
            }
            (g, e) = self.around_corner(piece, g, self.gap_end(piece, g, e))?;
        }
        None
    }

    fn gap_end(&self, piece: usize, gap: usize, end: usize) -> Point {
        let gap = &self.pieces[piece].gaps[gap];
        self.cell.on(gap.side, gap.range[end])
    }

    /// The other gap of a piece at a corner.
    fn around_corner(&self, piece: usize, gap: usize, corner: Point) -> Option<(usize, usize)> {
        let all = self.pieces[piece].gaps.iter().enumerate().filter(|(other, _)| *other != gap);
        let mut ends = all.flat_map(|(other, found)| (0..2).map(move |e| (other, e, found.ends[e])));
        let is_there = |other, e| (self.gap_end(piece, other, e) - corner).hypot() <= self.cell.near();
        ends.find(|&(other, e, end)| end == GapEnd::Corner && is_there(other, e)).map(|(other, e, _)| (other, e))
    }

    fn strokes(&mut self) -> Vec<Welded> {
        let lines: Vec<usize> = (0..self.pieces.len()).filter(|&p| !self.pieces[p].is_filled).collect();
        let mut all = Vec::new();
        // Lines with ends before those that close.
        for only_ends in [true, false] {
            for tile in self.layout.tiles() {
                for &piece in &lines {
                    for chain in 0..self.pieces[piece].chains.len() {
                        let ends = [0, 1].map(|which| Stop { tile, piece, chain, which });
                        let start = ends.into_iter().find(|end| !only_ends || self.goes_on(*end).is_none());
                        let path = start.and_then(|start| self.line(start));
                        all.extend(path.map(|path| Welded { unit: self.pieces[piece].unit, path }));
                    }
                }
            }
        }
        all
    }

    /// Where a stroke goes on beyond its end, within the layout.
    fn goes_on(&self, end: Stop) -> Option<Stop> {
        let &([piece, chain, which], shift) = self.links.ends.get(&[end.piece, end.chain, end.which])?;
        let tile = plus(end.tile, shift);
        self.layout.number(tile).map(|_| Stop { tile, piece, chain, which })
    }

    fn line(&mut self, start: Stop) -> Option<BezPath> {
        let mut path = BezPath::new();
        let mut at = start;
        while let Some(end) = self.walk(at, &mut path) {
            if self.pieces[end.piece].chains[end.chain].is_closed {
                path.close_path();
                break;
            }
            let Some(next) = self.goes_on(end) else { break };
            if next == start {
                path.close_path();
                break;
            }
            at = next;
        }
        (!path.elements().is_empty()).then_some(path)
    }
}

fn plus(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
