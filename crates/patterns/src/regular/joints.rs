//! What one cell holds of strokes and areas, and how its pieces go on in the cells around it.

use arabesque_core::{Bounds, Budget, Exemplar, Path, Result, Vector};

use crate::{
    regular::{
        areas::{CellArea, cell_areas},
        cut::pieces,
    },
    repeat::lattice::{Lattice, Node},
};

/// Positions of the cell that are tried, in each direction.
const TRIES: usize = 12;

/// The cell is looked for so many steps from the middle of the frame, where there is a hole in it.
const FAR: i64 = 60;

/// Pieces whose ends are farther apart than this share of the shorter vector do not go on in one another.
const APART: f64 = 0.02;

/// The same as the cosine of the angle at which they meet.
const SMOOTH: f64 = 0.9;

/// Lengths that differ by less than this share are the same.
const SAME_LENGTH: f64 = 1e-3;

/// Work for each segment that is cut, and for each pair of ends.
const WORK: (u64, u64) = (4000, 10);

/// A piece of a stroke in the cell.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) path: Path<2>,
    /// The exemplar curve that it belongs to.
    pub(crate) curve: usize,
    /// For its start and end, the piece that goes on there: its number, which end of it, in which cell from here.
    pub(crate) next: [Option<Next>; 2],
}

/// Where a stroke goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Next {
    pub(crate) part: usize,
    pub(crate) end: usize,
    pub(crate) step: Node,
}

/// The strokes and areas of one cell.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// A corner of it in the exemplar.
    pub(crate) origin: Vector<2>,
    pub(crate) parts: Vec<Part>,
    pub(crate) areas: Vec<CellArea>,
}

impl Cell {
    /// The strokes and areas of the cell, at a place in the frame where every stroke that leaves it comes back in on the other
    /// side; `None` where there is no such place.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(exemplar: &Exemplar<2>, lattice: &Lattice, budget: &Budget) -> Result<Option<Self>> {
        let mut found = Vec::new();
        for origin in origins(&exemplar.window, exemplar.hole.as_ref(), lattice) {
            found.extend(
                Self::at(exemplar, lattice, origin, budget)?.map(|(quality, cell)| (quality, cell.length(), cell)),
            );
        }
        // Wherever the cell lies, it holds the same: where a stroke runs along its side, it may hold none or two of them.
        let mut lengths: Vec<f64> = found.iter().map(|(_, length, _)| *length).collect();
        lengths.sort_by(f64::total_cmp);
        let Some(&usual) = lengths.get(lengths.len() / 2) else { return Ok(None) };
        found.retain(|(_, length, _)| (length - usual).abs() <= SAME_LENGTH * usual);
        let best = found.into_iter().reduce(|best, next| if next.0 > best.0 { next } else { best });
        let Some((_, _, mut cell)) = best else { return Ok(None) };
        cell.areas = cell_areas(exemplar, lattice, cell.origin, budget)?;
        Ok(Some(cell))
    }

    /// Length of all pieces.
    fn length(&self) -> f64 {
        let chords = self.parts.iter().flat_map(|part| &part.path.cubics).flat_map(|c| c.windows(2));
        chords.map(|w| (w[1] - w[0]).norm()).sum()
    }

    /// The cell at `origin`, and how well it is placed: how squarely the strokes pass its sides.
    fn at(
        exemplar: &Exemplar<2>,
        lattice: &Lattice,
        origin: Vector<2>,
        budget: &Budget,
    ) -> Result<Option<(f64, Self)>> {
        let mut parts = Vec::new();
        let mut ends: Vec<End> = Vec::new();
        let near = Bounds::around(corners(origin, lattice));
        for (curve, stroke) in exemplar.curves.iter().enumerate() {
            if !stroke.path.bounds().intersects(&near) {
                continue;
            }
            budget.spend(WORK.0 * stroke.path.cubics.len() as u64)?;
            for piece in pieces(&stroke.path, lattice, origin).into_iter().filter(|p| p.cell == [0, 0]) {
                let number = parts.len();
                for (end, _) in piece.is_cut.iter().enumerate().filter(|(_, cut)| **cut) {
                    ends.push(End::of(&piece.path, end, number, stroke.style, lattice, origin));
                }
                parts.push(Part { path: piece.path, curve, next: [None, None] });
            }
        }
        budget.spend(WORK.1 * (ends.len() as u64).pow(2))?;
        let shorter = lattice.shorter();
        let Some(joined) = joined(&ends, lattice, APART * shorter) else { return Ok(None) };
        let quality = ends.iter().map(|end| end.square(lattice)).fold(1.0, f64::min);
        for (a, b, step) in joined {
            let (from, to) = (&ends[a], &ends[b]);
            parts[from.part].next[from.end] = Some(Next { part: to.part, end: to.end, step });
        }
        Ok(Some((quality, Self { origin, parts, areas: Vec::new() })))
    }
}

/// Places for the cell at which it lies in the frame, and not in the hole.
fn origins(window: &Bounds<2>, hole: Option<&Bounds<2>>, lattice: &Lattice) -> Vec<Vector<2>> {
    let box_of = Bounds::around(corners(Vector::ZERO, lattice));
    let room = Bounds::new(window.min - box_of.min, window.max - box_of.max);
    let slack = 1e-9 * window.size().norm();
    if (0..2).any(|k| room.max[k] < room.min[k] - slack) {
        return Vec::new();
    }
    let room = Bounds::new(room.min, room.max.zip(room.min, f64::max));
    // Only so far as one cell is different from the next; shares that no drawing prefers.
    let span = room.size().zip(box_of.size(), f64::min);
    let start = room.centre() - span * 0.5;
    let share = |n: usize, shift: f64| (n as f64 + shift) / TRIES as f64;
    let all = (0..TRIES * TRIES).map(|n| (n / TRIES, n % TRIES));
    let all = all.map(|(i, j)| start + Vector::xy(span[0] * share(i, 0.463), span[1] * share(j, 0.537)));
    match hole {
        None => all.collect(),
        Some(hole) => all.filter_map(|origin| beside(hole, origin, &room.grown(slack), lattice)).collect(),
    }
}

/// The place nearest to `origin`, whole steps of the lattice from it, at which the cell lies in the frame and beside the hole.
fn beside(hole: &Bounds<2>, origin: Vector<2>, room: &Bounds<2>, lattice: &Lattice) -> Option<Vector<2>> {
    let lies_beside = |p: Vector<2>| room.contains(p) && !Bounds::around(corners(p, lattice)).intersects(hole);
    let [rows, columns] = lattice.nodes_in(origin, room);
    let far = |r: &std::ops::RangeInclusive<i64>| (*r.start()).max(-FAR)..=(*r.end()).min(FAR);
    let (rows, columns) = (far(&rows), far(&columns));
    let steps = rows.flat_map(|i| columns.clone().map(move |j| lattice.at([i, j])));
    let free = steps.filter(|&step| lies_beside(origin + step));
    free.min_by(|a, b| a.norm2().total_cmp(&b.norm2())).map(|step| origin + step)
}

fn corners(origin: Vector<2>, lattice: &Lattice) -> [Vector<2>; 4] {
    let [a, b] = lattice.vectors;
    [origin, origin + a, origin + b, origin + a + b]
}

/// An end of a piece on a side of the cell.
#[derive(Clone, Copy, Debug)]
struct End {
    part: usize,
    end: usize,
    style: usize,
    place: Vector<2>,
    /// Unit vector out of the piece.
    way: Vector<2>,
    /// Which coordinate is a whole number here, and which one: 0 or 1.
    side: (usize, i64),
}

impl End {
    fn of(path: &Path<2>, end: usize, part: usize, style: usize, lattice: &Lattice, origin: Vector<2>) -> Self {
        let (place, way) = tip(path, end);
        let at = lattice.coordinates(place - origin);
        let off = |k: usize| (at[k] - at[k].round()).abs();
        let axis = usize::from(off(1) < off(0));
        Self { part, end, style, place, way, side: (axis, at[axis].round() as i64) }
    }

    /// How squarely the piece meets its side of the cell: the sine of the angle.
    fn square(&self, lattice: &Lattice) -> f64 {
        self.way.cross(lattice.vectors[1 - self.side.0].unit_or_zero()).abs()
    }

    /// The step to the cell beyond its side.
    fn step(&self) -> Node {
        let mut step = [0, 0];
        step[self.side.0] = if self.side.1 >= 1 { 1 } else { -1 };
        step
    }
}

/// The place of an end of a path, and the direction out of it.
fn tip(path: &Path<2>, end: usize) -> (Vector<2>, Vector<2>) {
    let cubic = if end == 0 { path.cubics.first() } else { path.cubics.last() };
    let Some(c) = cubic else { return (Vector::ZERO, Vector::ZERO) };
    let [p, q, r, s] = if end == 0 { *c } else { [c[3], c[2], c[1], c[0]] };
    let way = [q, r, s].into_iter().map(|v| p - v).find(|w| w.norm2() > 0.0);
    (p, way.unwrap_or(Vector::ZERO).unit_or_zero())
}

/// Pairs of ends that go on in one another, both ways; `None` where an end has no partner.
fn joined(ends: &[End], lattice: &Lattice, apart: f64) -> Option<Vec<(usize, usize, Node)>> {
    let mut close = Vec::new();
    for (i, from) in ends.iter().enumerate().filter(|(_, end)| end.side.1 >= 1) {
        let step = from.step();
        let shift = lattice.at(step);
        for (j, to) in ends.iter().enumerate() {
            let fits = to.style == from.style && to.step() == step.map(|n| -n) && from.way.dot(to.way) <= -SMOOTH;
            let gap = (to.place + shift - from.place).norm();
            if fits && gap <= apart {
                close.push((gap, i, j));
            }
        }
    }
    // Nearest first: strokes that lie on one another each find one of their own.
    close.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut is_free = vec![true; ends.len()];
    let mut pairs = Vec::new();
    for (_, i, j) in close {
        if is_free[i] && is_free[j] {
            (is_free[i], is_free[j]) = (false, false);
            let step = ends[i].step();
            pairs.push((i, j, step));
            pairs.push((j, i, step.map(|n| -n)));
        }
    }
    is_free.iter().all(|free| !free).then_some(pairs)
}
