//! Who covers whom in the exemplar, by classes and by where one lies from the other.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Domain, GridIndex, Result, Vector};

use crate::finish::clearance::{ExemplarClearance, PlacedFigure};

/// Overlaps below this share of the smaller element do not show who is on top.
const VISIBLE: f64 = 1e-4;

/// Offsets that differ by less than this share of the mean spacing are one.
const SAME: f64 = 0.02;

/// How far an offset may be from that of the exemplar's pair, as a share of how far the two reach, before its vote
/// counts half.
const ALIKE: f64 = 0.1;

/// Weight of what elements of other classes do.
const OTHERS: f64 = 0.5;

/// Work for each overlap of the exemplar.
const PER_OVERLAP: u64 = 1000;

/// Radii, doubled each time, within which a nearest offset is looked for.
const WIDENINGS: i32 = 12;

/// Two classes, the lower index first.
type ClassPair = (usize, usize);

/// Who covers whom in an exemplar.
#[derive(Clone, Debug)]
pub(crate) struct ExemplarOrder {
    by_classes: BTreeMap<ClassPair, Table>,
    /// The same whatever the classes.
    any: Table,
}

impl ExemplarOrder {
    /// What the elements of an exemplar do, whose drawing order is that of the figures; `None` where no two overlap.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(clearance: &ExemplarClearance, budget: &Budget) -> Result<Option<Self>> {
        budget.spend(PER_OVERLAP * clearance.overlaps.len() as u64)?;
        let mut by_classes: BTreeMap<ClassPair, Vec<Known>> = BTreeMap::new();
        let mut any = Vec::new();
        for overlap in &clearance.overlaps {
            let (low, high) = (&clearance.figures[overlap.a], &clearance.figures[overlap.b]);
            if overlap.a == overlap.b || overlap.area < VISIBLE * low.area.min(high.area) {
                continue;
            }
            let up = Known { offset: high.centre - low.centre, above: 1.0 };
            let down = Known { offset: -up.offset, above: -1.0 };
            let (a, b) = (clearance.class[overlap.a], clearance.class[overlap.b]);
            let list = by_classes.entry((a.min(b), a.max(b))).or_default();
            list.extend((a <= b).then_some(up));
            list.extend((a >= b).then_some(down));
            any.extend([up, down]);
        }
        let same = SAME * clearance.spacing;
        let table = |(classes, list): (ClassPair, Vec<Known>)| (classes, Table::new(list, same));
        let order = Self { by_classes: by_classes.into_iter().map(table).collect(), any: Table::new(any, same) };
        Ok((!order.any.known.is_empty()).then_some(order))
    }

    /// How sure it is that `b` lies above `a`; negative where it lies below.
    pub(crate) fn above(&self, a: &PlacedFigure, b: &PlacedFigure) -> f64 {
        let (Some(first), Some(second)) = (a.class, b.class) else { return 0.0 };
        if first > second {
            return -self.above(b, a);
        }
        let offset = b.centre - a.centre;
        // Each of the two sees the other in the exemplar's coordinates turned and scaled as it is itself.
        let seen = [a, b].map(|by| (by.place.inverse().apply_offset(offset), (a.radius + b.radius) / by.place.scale));
        seen.into_iter().map(|(offset, reach)| self.vote((first, second), offset, reach)).sum()
    }

    fn vote(&self, classes: ClassPair, offset: Vector<2>, reach: f64) -> f64 {
        let own = self.by_classes.get(&classes).map_or(0.0, |table| table.vote(offset, reach));
        let others = OTHERS * self.any.vote(offset, reach);
        if own.abs() >= others.abs() { own } else { others }
    }
}

/// That one of a pair lies above the other at some offset.
#[derive(Clone, Copy, Debug)]
struct Known {
    offset: Vector<2>,
    /// 1 where always, -1 where always the other way round.
    above: f64,
}

/// Offsets at which elements overlap, and which of the two lies above.
#[derive(Clone, Debug)]
struct Table {
    known: Vec<Known>,
    index: GridIndex<2>,
    /// What offsets that are the same may differ by.
    same: f64,
    /// What all say, whatever the offset, and how sure that is; 0 where they say different things.
    always: f64,
}

impl Table {
    fn new(list: Vec<Known>, same: f64) -> Self {
        let same_side = list.first().filter(|one| list.iter().all(|k| k.above == one.above));
        // Few may say the same by chance.
        let always = same_side.map_or(0.0, |k| k.above * (1.0 - 0.5_f64.powi(list.len() as i32 - 1)));
        let known = merged(list, same.max(f64::MIN_POSITIVE));
        let points: Vec<_> = known.iter().map(|k| k.offset).collect();
        let index = GridIndex::new(&points, 4.0 * same, &Domain::Box(Bounds::around(points.iter().copied())));
        Self { known, index, same, always }
    }

    /// What the nearest offset says, the less the farther it is; or what all say.
    fn vote(&self, offset: Vector<2>, reach: f64) -> f64 {
        let nearest = self.nearest(offset, reach);
        if nearest.abs() >= self.always.abs() { nearest } else { self.always }
    }

    fn nearest(&self, offset: Vector<2>, reach: f64) -> f64 {
        let radii = (0..WIDENINGS).map(|n| 2.0 * self.same * f64::from(1 << n)).take_while(|r| *r < 4.0 * reach);
        let Some((k, off)) = radii.filter_map(|r| self.index.nearest(offset, r, None)).next() else { return 0.0 };
        let off = (off - self.same).max(0.0) / (ALIKE * reach).max(f64::MIN_POSITIVE);
        self.known[k].above / (1.0 + off * off)
    }
}

/// Offsets that are the same as one, with the mean of what they say.
fn merged(list: Vec<Known>, same: f64) -> Vec<Known> {
    let mut cells: BTreeMap<[i64; 2], Vec<Known>> = BTreeMap::new();
    for known in list {
        let cell = [0, 1].map(|k| (known.offset[k] / same).round() as i64);
        cells.entry(cell).or_default().push(known);
    }
    let mean = |all: &Vec<Known>| {
        let share = 1.0 / all.len() as f64;
        let sum = all.iter().fold((Vector::ZERO, 0.0), |(o, a), k| (o + k.offset, a + k.above));
        Known { offset: sum.0 * share, above: sum.1 * share }
    };
    cells.values().map(mean).collect()
}
