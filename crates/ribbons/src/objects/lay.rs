//! Whole objects along one curve: between its corners, apart from one another, with gaps that fill what there is.

use arabesque_core::{Budget, Result, Vector};

use crate::{
    objects::{
        choice::{Chooser, Chosen, Stretch},
        find::{Object, Objects},
        place::{Obstacle, Placed, Placing, Tried},
        way::{Corner, Way},
    },
    params::RibbonParams,
};

/// How far an object is moved on where it cannot lie, in heights of the exemplar.
const NUDGE: f64 = 0.01;
/// Share of the smallest gap that must be left between outlines, which are known at some of their points.
const APART: f64 = 0.97;
/// Halvings of the search for the gaps that fill a stretch.
const HALVINGS: usize = 14;
/// Work of placing an object, of comparing a box, and of comparing two outlines.
const PLACE: u64 = 4000;
const BOX: u64 = 4;
const OUTLINES: u64 = 4000;

/// What is laid along all curves of one run.
pub(crate) struct Laying<'a, const D: usize> {
    pub(crate) objects: &'a Objects,
    pub(crate) params: &'a RibbonParams,
    pub(crate) seed: u64,
    /// Shares of the length at which one exemplar passes into the next.
    pub(crate) changes: &'a [f64],
    /// The object that every curve begins with.
    pub(crate) first: Option<usize>,
    pub(crate) blocked: Option<&'a dyn Fn(Vector<D>) -> bool>,
    pub(crate) budget: &'a Budget,
    /// What was laid along earlier curves.
    pub(crate) others: Vec<Placed<D>>,
}

/// A part of a curve between two corners.
#[derive(Clone, Copy, Debug)]
struct Part {
    from: f64,
    to: f64,
    corners: [Option<Corner>; 2],
    closed: bool,
}

/// All objects of a row, or how many of them fit, and why no more.
type Fit<const D: usize> = std::result::Result<Vec<Placed<D>>, (usize, Obstacle)>;

/// A sequence of objects along a part.
struct Row<'a, const D: usize> {
    part: Part,
    placing: Placing<'a, D>,
    chosen: Vec<Chosen>,
}

impl<const D: usize> Laying<'_, D> {
    /// Lays objects along curve number `curve`; tells why there are none.
    pub(crate) fn along(&mut self, way: &Way<'_, D>, curve: usize) -> Result<Tried<Vec<Placed<D>>>> {
        let placing = Placing {
            way,
            scale: self.params.scale,
            height: self.objects.height * self.params.scale,
            relax: self.params.relax,
        };
        let parts = parts(way);
        let count = parts.len();
        let (begun, mut why) = (self.others.len(), Obstacle::End);
        for (k, part) in parts.into_iter().enumerate() {
            let item = ((curve as u64) << 24) + k as u64;
            let stretch = self.stretch(&part, way, [k == 0, k + 1 == count]);
            let chooser = Chooser {
                objects: self.objects,
                seed: self.seed,
                repetition: self.params.repetition,
                varied: self.params.variety > 0.0,
                budget: self.budget,
            };
            let chosen = chooser.choose(&stretch, item)?;
            let mut row = Row { part, placing, chosen };
            match self.filled(&mut row, [!stretch.first.is_empty(), !stretch.last.is_empty()])? {
                Ok(placed) => self.others.extend(placed),
                Err(obstacle) => why = why.max(obstacle),
            }
        }
        let placed = self.others[begun..].to_vec();
        Ok(if placed.is_empty() { Err(why) } else { Ok(placed) })
    }

    /// What is to be chosen for a part, which is the first or the last of its curve.
    fn stretch(&self, part: &Part, way: &Way<'_, D>, [first, last]: [bool; 2]) -> Stretch {
        let (objects, scale) = (self.objects, self.params.scale);
        let n = objects.gaps.len();
        let share = |k: usize| self.changes.get(k).copied().unwrap_or(f64::INFINITY);
        let to = |k: usize| if k + 1 < n { (share(k) * way.length() - part.from) / scale } else { f64::INFINITY };
        let mut begin = if first && !way.closed() { objects.first.clone() } else { Vec::new() };
        if let Some(object) = self.first.filter(|_| first) {
            begin = vec![object];
        }
        Stretch {
            length: (part.to - part.from - self.margins(part)) / scale,
            closed: part.closed,
            first: begin,
            last: if last && !way.closed() { objects.last.clone() } else { Vec::new() },
            sources: (0..n).map(|k| (k, to(k))).collect(),
        }
    }

    /// The room that corners take from a part, for an object like the first.
    fn margins(&self, part: &Part) -> f64 {
        let object = &self.objects.list[0];
        self.room(object, part, 0) + self.room(object, part, 1)
    }

    /// How far from an end of a part an object must stay.
    fn room(&self, object: &Object, part: &Part, end: usize) -> f64 {
        let Some(corner) = part.corners[end] else { return 0.0 };
        let scale = self.params.scale;
        let half = 0.5 * self.objects.range(object.source)[0] * scale;
        let away = |x: f64| if end == 0 { x } else { object.length() - x };
        corner.room(object.outline.iter().map(|p| [away(p[0]) * scale, p[1] * scale]), half)
    }

    /// The objects of a row with gaps that fill its part; `fixed` ends stay where they are.
    fn filled(&self, row: &mut Row<'_, D>, fixed: [bool; 2]) -> Result<Tried<Vec<Placed<D>>>> {
        let mut stretch = -1.0;
        let mut best = loop {
            match self.row(row, stretch, 0.0)? {
                Ok(placed) => break placed,
                Err((0, obstacle)) => return self.single(row, obstacle),
                Err(_) if row.chosen.len() > 1 => self.shorten(row, fixed[1]),
                Err((_, obstacle)) => return self.single(row, obstacle),
            }
        };
        let whole = row.part.closed || fixed == [true, true];
        let most = if whole { 1.0 + (row.part.to - row.part.from) / self.params.scale } else { 1.0 };
        // The largest gaps with which all objects fit.
        let mut over = most;
        if let Ok(placed) = self.row(row, most, 0.0)? {
            (best, stretch, over) = (placed, most, most);
        }
        for _ in 0..HALVINGS {
            if over <= stretch {
                break;
            }
            // What the exemplar has, first.
            let tried = match (stretch < 0.0 && over > 0.0, stretch < 1.0 && over > 1.0) {
                (true, _) => 0.0,
                (_, true) => 1.0,
                _ => 0.5 * (stretch + over),
            };
            match self.row(row, tried, 0.0)? {
                Ok(placed) => (best, stretch) = (placed, tried),
                Err(_) => over = tried,
            }
        }
        if row.part.closed || fixed[0] {
            return Ok(Ok(best));
        }
        let Some((last, chosen)) = best.last().zip(row.chosen.last()) else { return Ok(Ok(best)) };
        let left = row.part.to - self.room(&self.objects.list[chosen.object], &row.part, 1) - last.to;
        let moved = self.row(row, stretch, if fixed[1] { left } else { 0.5 * left })?;
        Ok(Ok(moved.unwrap_or(best)))
    }

    /// One object less, but not the one that must be at the end.
    fn shorten(&self, row: &mut Row<'_, D>, ends: bool) {
        let n = row.chosen.len();
        if ends && n > self.objects.last.len() {
            row.chosen.remove(n - 1 - self.objects.last.len());
        } else {
            row.chosen.pop();
        }
    }

    /// Any object that fits where the first one that was chosen does not, the longest of them.
    fn single(&self, row: &mut Row<'_, D>, obstacle: Obstacle) -> Result<Tried<Vec<Placed<D>>>> {
        let mut order: Vec<usize> = (0..self.objects.list.len()).collect();
        order.sort_by(|&a, &b| self.objects.list[b].length().total_cmp(&self.objects.list[a].length()).then(a.cmp(&b)));
        let Some(&sample) = row.chosen.first() else { return Ok(Err(obstacle)) };
        let mut why = obstacle;
        for object in order {
            let mut chosen = sample;
            chosen.object = object;
            row.chosen = vec![chosen];
            match self.row(row, -1.0, 0.0)? {
                Ok(placed) => {
                    let last = placed[0].to;
                    let left = row.part.to - self.room(&self.objects.list[object], &row.part, 1) - last;
                    let moved = if row.part.closed { 0.0 } else { 0.5 * left };
                    return Ok(Ok(self.row(row, -1.0, moved)?.unwrap_or(placed)));
                }
                Err((_, obstacle)) => why = why.max(obstacle),
            }
        }
        Ok(Err(why))
    }

    /// All objects of a row, `later` than its part begins; else how many fit, and why no more.
    fn row(&self, row: &Row<'_, D>, stretch: f64, later: f64) -> Result<Fit<D>> {
        let (part, scale) = (&row.part, self.params.scale);
        let mut placed: Vec<Placed<D>> = Vec::with_capacity(row.chosen.len());
        let mut from = part.from + later;
        for (k, chosen) in row.chosen.iter().enumerate() {
            let object = &self.objects.list[chosen.object];
            match placed.last() {
                Some(last) => from = last.to + chosen.gap(stretch) * scale,
                None => from += self.room(object, part, 0),
            }
            let last = k + 1 == row.chosen.len();
            let end = match (last, part.closed) {
                // The gap before the first object closes the curve.
                (true, true) => part.to - row.chosen[0].gap(stretch) * scale,
                _ => part.to - self.room(object, part, 1),
            };
            match self.next(row, object, [from, end], &placed)? {
                Ok(next) => placed.push(next),
                Err(obstacle) => return Ok(Err((k, obstacle))),
            }
        }
        Ok(Ok(placed))
    }

    /// `object` at the first place from `from` on, up to `end`, where it can lie.
    fn next(
        &self,
        row: &Row<'_, D>,
        object: &Object,
        [mut from, end]: [f64; 2],
        before: &[Placed<D>],
    ) -> Result<Tried<Placed<D>>> {
        let least = APART * self.objects.range(object.source)[0] * self.params.scale;
        let mut why = Obstacle::End;
        loop {
            self.budget.spend(PLACE)?;
            match row.placing.place(object, from, end) {
                Ok(placed) if self.is_free(&placed, before, least)? => return Ok(Ok(placed)),
                Err(Obstacle::End) => return Ok(Err(why)),
                Ok(_) => why = why.max(Obstacle::Taken),
                Err(obstacle) => why = why.max(obstacle),
            }
            from += NUDGE * row.placing.height;
        }
    }

    /// Whether `placed` stays off all others and off what is to be avoided.
    fn is_free(&self, placed: &Placed<D>, before: &[Placed<D>], least: f64) -> Result<bool> {
        self.budget.spend(BOX * (before.len() + self.others.len()) as u64)?;
        for other in before.iter().rev().chain(&self.others) {
            if placed.bounds.grown(least).intersects(&other.bounds) {
                self.budget.spend(OUTLINES)?;
                if !placed.clears(other, least) {
                    return Ok(false);
                }
            }
        }
        let Some(blocked) = self.blocked else { return Ok(true) };
        // Points come in pairs, from the upper to the lower end of a column.
        for pair in placed.points.chunks_exact(2) {
            let steps = ((pair[1] - pair[0]).norm() / (0.5 * self.params.scale)).ceil().max(1.0) as usize;
            self.budget.spend(BOX * steps as u64)?;
            let at = |k: usize| pair[0] + (pair[1] - pair[0]) * (k as f64 / steps as f64);
            if (0..=steps).any(|k| blocked(at(k))) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The parts of a curve between its corners.
fn parts<const D: usize>(way: &Way<'_, D>) -> Vec<Part> {
    let (corners, length) = (way.corners(), way.length());
    let (Some(first), Some(last)) = (corners.first(), corners.last()) else {
        return vec![Part { from: 0.0, to: length, corners: [None; 2], closed: way.closed() }];
    };
    let between = |a: &Corner, b: &Corner, more: f64| Part {
        from: a.to,
        to: b.from + more,
        corners: [Some(*a), Some(*b)],
        closed: false,
    };
    let mut parts: Vec<Part> = corners.windows(2).map(|pair| between(&pair[0], &pair[1], 0.0)).collect();
    if way.closed() {
        parts.push(between(last, first, length));
    } else {
        parts.insert(0, Part { from: 0.0, to: first.from, corners: [None, Some(*first)], closed: false });
        parts.push(Part { from: last.to, to: length, corners: [Some(*last), None], closed: false });
    }
    parts
}
