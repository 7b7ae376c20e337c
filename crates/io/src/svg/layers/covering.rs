//! Who covers whom: along lines over the whole drawing, what lies on what where painted areas meet.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, BTreeSet, BinaryHeap},
};

use arabesque_core::{Bounds, Budget, Outline, Result};

/// Lines across the drawing, each way.
const LINES: usize = 480;

/// Where between two lines the drawing is looked at: no round share, since edges often lie on these.
const OFF: f64 = 0.381_966;

/// Things that overlap by less than twice this share of the drawing abut.
const ABUT: f64 = 1e-5;

/// Work for an edge, and for a stretch of a line that is covered.
const PRICE: (u64, u64) = (20, 150);

/// Bytes of a stretch.
const STRETCH: usize = 48;

/// Something painted, in drawing order.
#[derive(Clone, Debug)]
pub(crate) struct Painted<'a> {
    pub(crate) outline: &'a Outline<2>,
    /// Whether it is strokes, not an element.
    pub(crate) is_strokes: bool,
}

/// How often the first of two, things or kinds of them, lies directly below the second.
pub(crate) type Counts = BTreeMap<(usize, usize), u64>;

/// A stretch of a line that something covers.
struct Stretch {
    from: f64,
    to: f64,
    which: usize,
}

/// The same for kinds of things, given for each thing the kinds of what it is, from bottom to top; two things of one kind count for
/// nothing.
pub(crate) fn by_kind(counts: &Counts, kinds: &[Vec<usize>]) -> Counts {
    let mut found = Counts::new();
    for (&(low, high), &n) in counts {
        if let (Some(&low), Some(&high)) = (kinds[low].last(), kinds[high].first())
            && low != high
        {
            *found.entry((low, high)).or_default() += n;
        }
    }
    found
}

/// Counts which things lie on which, by their numbers, strokes and elements each on the next above and below of both.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub(crate) fn counts(painted: &[Painted<'_>], window: &Bounds<2>, budget: &Budget) -> Result<Counts> {
    let mut counts = Counts::new();
    for axis in 0..2 {
        let lines = stretches(painted, window, axis, budget)?;
        let all: usize = lines.iter().map(Vec::len).sum();
        let _held = budget.hold("what covers what", all * STRETCH)?;
        budget.spend(PRICE.1 * all as u64)?;
        for line in lines {
            sweep(line, painted, &mut counts);
        }
    }
    Ok(counts)
}

/// The covered stretches of each line across the window; lines run along `axis`.
fn stretches(painted: &[Painted<'_>], window: &Bounds<2>, axis: usize, budget: &Budget) -> Result<Vec<Vec<Stretch>>> {
    let (across, size) = (1 - axis, window.size());
    let step = size[across] / LINES as f64;
    let mut lines: Vec<Vec<Stretch>> = (0..LINES).map(|_| Vec::new()).collect();
    let mut crossings: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    let mut meter = budget.meter();
    for (which, thing) in painted.iter().enumerate() {
        for (a, b) in thing.outline.edges() {
            let (low, high) = (a[across].min(b[across]), a[across].max(b[across]));
            let line = |v: f64| ((v - window.min[across]) / step - OFF).ceil().clamp(0.0, LINES as f64) as usize;
            let passed = line(low)..line(high);
            meter.spend(PRICE.0 * (1 + passed.len() as u64))?;
            for k in passed {
                let at = window.min[across] + (k as f64 + OFF) * step;
                let share = (at - a[across]) / (b[across] - a[across]);
                crossings.entry(k).or_default().push(a[axis] + share * (b[axis] - a[axis]));
            }
        }
        for (k, mut places) in std::mem::take(&mut crossings) {
            places.sort_by(f64::total_cmp);
            // What ends where another begins does not lie on it.
            let slack = ABUT * size[axis];
            let is_seen = |p: &&[f64]| p[1] > window.min[axis] && p[0] < window.max[axis] && p[1] - p[0] > 2.0 * slack;
            let pairs = places.chunks_exact(2).filter(is_seen);
            lines[k].extend(pairs.map(|p| Stretch { from: p[0] + slack, to: p[1] - slack, which }));
        }
    }
    Ok(lines)
}

/// Goes along a line and counts what comes to lie on what.
fn sweep(mut line: Vec<Stretch>, painted: &[Painted<'_>], counts: &mut Counts) {
    line.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.which.cmp(&b.which)));
    let mut present: [BTreeSet<usize>; 2] = Default::default();
    let mut ends: BinaryHeap<Reverse<(u64, usize)>> = BinaryHeap::new();
    // Bits of numbers above 0 are in the order of the numbers.
    let lowest = line.first().map_or(0.0, |s| s.from);
    let key = |v: f64| (v - lowest).max(0.0).to_bits();
    for stretch in &line {
        while let Some(Reverse((_, which))) = ends.peek().copied().filter(|e| e.0.0 <= key(stretch.from)) {
            ends.pop();
            present[usize::from(painted[which].is_strokes)].remove(&which);
        }
        let new = stretch.which;
        for others in &present {
            let below = others.range(..new).next_back().map(|&other| (other, new));
            let above = others.range(new + 1..).next().map(|&other| (new, other));
            for pair in below.into_iter().chain(above) {
                *counts.entry(pair).or_default() += 1;
            }
        }
        present[usize::from(painted[new].is_strokes)].insert(new);
        ends.push(Reverse((key(stretch.to), new)));
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::Vector;

    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Outline<2> {
        let ring = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)];
        Outline { rings: vec![ring.map(|(x, y)| Vector::xy(x, y)).to_vec()] }
    }

    fn counted(things: &[(Outline<2>, usize, bool)]) -> Counts {
        let painted: Vec<_> =
            things.iter().map(|(outline, _, is_strokes)| Painted { outline, is_strokes: *is_strokes }).collect();
        let kinds: Vec<Vec<usize>> = things.iter().map(|(_, kind, _)| vec![*kind]).collect();
        let window = Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0));
        by_kind(&counts(&painted, &window, &Budget::default()).unwrap(), &kinds)
    }

    #[test]
    fn what_meets_is_counted_and_what_is_apart_is_not() {
        let found = counted(&[(square(10.0, 10.0, 30.0), 0, false), (square(30.0, 30.0, 30.0), 1, false)]);
        assert!(found.len() == 1 && found[&(0, 1)] > 50, "{found:?}");
        assert!(counted(&[(square(10.0, 10.0, 20.0), 0, false), (square(40.0, 40.0, 20.0), 1, false)]).is_empty());
        assert!(counted(&[(square(10.0, 10.0, 20.0), 0, false), (square(15.0, 15.0, 20.0), 0, false)]).is_empty());
    }

    #[test]
    fn strokes_are_compared_with_elements_through_other_elements() {
        let things = [
            (square(10.0, 10.0, 30.0), 0, false),
            (square(10.0, 10.0, 30.0), 1, false),
            (square(20.0, 20.0, 5.0), 2, true),
            (square(0.0, 20.0, 2.0), 3, true),
        ];
        let found = counted(&things);
        assert!(
            found.contains_key(&(1, 2)) && found.contains_key(&(0, 1)) && !found.contains_key(&(2, 3)),
            "{found:?}"
        );
    }
}
