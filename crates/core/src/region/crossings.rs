//! What a boolean operation on polygons will cost, found out before it is begun.
//!
//! The sweeps of such an operation take longest where edges cross: every crossing becomes a corner, and so n edges may make n²/2 of them.
//! Crossings are counted here by an exact test of all pairs of edges whose boxes meet, found by
//! a sweep in bands.

use crate::{
    budget::Budget,
    error::{Error, Result},
    region::segment::Segment,
    space::{Bounds, Vector},
    text::rounded,
};

/// Work for each edge that an operation is given: sorting and sweeping.
const PER_EDGE: u64 = 500;
/// Work for each crossing: rounded to the grid, crossings make others, which are looked for again.
const PER_CROSSING: u64 = 8000;
/// Work for each pair of edges whose boxes meet.
const PER_PAIR: u64 = 20;
/// Work for each pair of edges that a sweep looks at.
const PER_LOOK: u64 = 3;
/// Memory for each edge and each crossing, in bytes.
const BYTES: usize = 240;
/// Boxes in a band, at least.
const IN_BAND: usize = 64;
/// How many bands a box lies in, in the mean, beside its first.
const REPEATED: f64 = 2.0;
/// How many times the limit is counted before counting stops.
const FAR_OVER: usize = 16;

/// Draws on the budget what an operation on these edges will take, and refuses it where there is not enough.
pub(super) fn foresee(edges: &[Segment<2>], budget: &Budget) -> Result<()> {
    let limits = budget.limits();
    budget.within("corners of outlines", edges.len(), ("outline-nodes", limits.outline_nodes))?;
    in_range(edges.iter().map(|e| e.0), budget)?;
    budget.spend(edges.len() as u64 * PER_EDGE)?;
    let crossings = count(edges, limits.crossings, budget)?;
    budget.within("places where edges of outlines cross", crossings, ("crossings", limits.crossings))?;
    drop(budget.hold("outlines", BYTES.saturating_mul(edges.len() + crossings))?);
    budget.spend(crossings as u64 * PER_CROSSING)
}

/// Refuses corners that are not numbers, or farther away than anything drawn may be.
pub(super) fn in_range(points: impl Iterator<Item = Vector<2>>, budget: &Budget) -> Result<()> {
    // What was read lies within the limit; growing and turning it may lead a little farther.
    let most = 8.0 * budget.limits().coordinate;
    let far = |p: &Vector<2>| !p.0.iter().all(|v| v.abs() <= most);
    let Some(found) = { points }.find(far) else { return Ok(()) };
    Err(Error::input(
        "outline",
        format!(
            "a corner at ({}, {}), expected coordinates of at most {}",
            rounded(found[0]),
            rounded(found[1]),
            rounded(most)
        ),
        "draw it smaller, and nearer to the origin",
    ))
}

/// How often edges cross, touch or run along one another, ends that they share left out. Counting stops far over the limit.
fn count(edges: &[Segment<2>], limit: usize, budget: &Budget) -> Result<usize> {
    let edges = distinct(edges);
    let boxes: Vec<Bounds<2>> = edges.iter().map(|e| Bounds::around([e.0, e.1])).collect();
    let sweeps = [0, 1].map(|axis| Sweep::new(&boxes, axis));
    let sweep = sweeps.into_iter().min_by(|a, b| a.looks.total_cmp(&b.looks));
    let Some(sweep) = sweep.filter(|_| edges.len() > 1) else { return Ok(0) };
    budget.foresee((sweep.looks * PER_LOOK as f64) as u64)?;
    let mut meter = budget.meter();
    let (mut found, mut active, mut last) = (0, Vec::<u32>::new(), 0);
    for (band, i) in sweep.bands(&boxes) {
        if band != last {
            (active, last) = (Vec::new(), band);
        }
        let here = &boxes[i as usize];
        meter.spend(PER_LOOK * (1 + active.len() as u64))?;
        active.retain(|&j| boxes[j as usize].max[sweep.axis] >= here.min[sweep.axis]);
        let near = active.iter().filter(|&&j| boxes[j as usize].intersects(here));
        // Where both lie in several bands, they count in the first of them.
        let near = near.filter(|&&j| band == sweep.band(sweep.across(&boxes[j as usize]).max(sweep.across(here))));
        let mut pairs = 0;
        found += near.inspect(|_| pairs += 1).filter(|&&j| cross(edges[i as usize], edges[j as usize])).count();
        meter.spend(PER_PAIR * pairs)?;
        if found > limit.saturating_mul(FAR_OVER) {
            break;
        }
        active.push(i);
    }
    Ok(found)
}

/// The edges without copies: they are merged before anything is looked for.
fn distinct(edges: &[Segment<2>]) -> Vec<Segment<2>> {
    let key = |e: &Segment<2>| [e.0[0], e.0[1], e.1[0], e.1[1]];
    let before = |p: &[f64], q: &[f64]| {
        let differing = p.iter().zip(q).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
        differing.unwrap_or(std::cmp::Ordering::Equal)
    };
    let forwards = |&(a, b): &Segment<2>| if before(&a.0, &b.0).is_gt() { (b, a) } else { (a, b) };
    let mut all: Vec<Segment<2>> = edges.iter().filter(|e| e.0 != e.1).map(forwards).collect();
    all.sort_by(|p, q| before(&key(p), &key(q)));
    all.dedup();
    all
}

/// A sweep along one axis, in bands along which few boxes are high.
struct Sweep {
    axis: usize,
    /// Boxes by where they start along the axis.
    order: Vec<u32>,
    low: f64,
    /// Width of a band.
    width: f64,
    /// Bands less one.
    last: u32,
    /// About how many pairs will be looked at.
    looks: f64,
}

impl Sweep {
    fn new(boxes: &[Bounds<2>], axis: usize) -> Self {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        order.sort_by(|&a, &b| boxes[a as usize].min[axis].total_cmp(&boxes[b as usize].min[axis]));
        let mut ends: Vec<f64> = boxes.iter().map(|b| b.max[axis]).collect();
        ends.sort_by(f64::total_cmp);
        let (mut ended, mut pairs) = (0, 0.0);
        for (started, &i) in order.iter().enumerate() {
            while ends[ended] < boxes[i as usize].min[axis] {
                ended += 1;
            }
            pairs += (started - ended) as f64;
        }
        let all = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        let (low, size) = (all.min[1 - axis], all.size()[1 - axis]);
        let heights: f64 = boxes.iter().map(|b| b.size()[1 - axis]).sum();
        let most = (boxes.len() / IN_BAND) as f64;
        let bands = (REPEATED * boxes.len() as f64 * size / heights).min(most).max(1.0).floor();
        Self { axis, order, low, width: size / bands, last: bands as u32 - 1, looks: pairs / bands }
    }

    /// The low side of a box across the sweep.
    fn across(&self, b: &Bounds<2>) -> f64 {
        b.min[1 - self.axis]
    }

    fn band(&self, v: f64) -> u32 {
        if self.last == 0 { 0 } else { ((v - self.low) / self.width).clamp(0.0, f64::from(self.last)) as u32 }
    }

    /// The boxes of each band, in the order of the sweep.
    fn bands(&self, boxes: &[Bounds<2>]) -> Vec<(u32, u32)> {
        let spans = self.order.iter().flat_map(|&i| {
            let b = &boxes[i as usize];
            (self.band(self.across(b))..=self.band(b.max[1 - self.axis])).map(move |band| (band, i))
        });
        let mut entries: Vec<_> = spans.collect();
        // Stable: each band keeps the order of the sweep.
        entries.sort_by_key(|(band, _)| *band);
        entries
    }
}

/// Whether two edges whose boxes meet have more in common than an end.
fn cross((a, b): Segment<2>, (c, d): Segment<2>) -> bool {
    let side = |(a, b): Segment<2>, v: Vector<2>| (b - a).cross(v - a);
    let (to_c, to_d) = (side((a, b), c), side((a, b), d));
    let (to_a, to_b) = (side((c, d), a), side((c, d), b));
    let apart = |u: f64, v: f64| (u > 0.0 && v > 0.0) || (u < 0.0 && v < 0.0);
    if apart(to_c, to_d) || apart(to_a, to_b) {
        return false;
    }
    let shares_end = a == c || a == d || b == c || b == d;
    if !shares_end {
        return true;
    }
    // Ends on one line: they run along one another unless they part where they meet.
    let in_line = to_c == 0.0 && to_d == 0.0;
    let (p, q) = if a == c || b == d { (b - a, d - c) } else { (b - a, c - d) };
    in_line && p.dot(q) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        budget::Limits,
        random::{Stage, Stream},
    };

    fn random(n: usize, reach: f64) -> Vec<Segment<2>> {
        let mut s = Stream::new(1, Stage::TEST, 0);
        let mut point = |around: Vector<2>, r: f64| around + Vector::xy(s.range(-r, r), s.range(-r, r));
        (0..n)
            .map(|_| point(Vector::ZERO, 100.0))
            .collect::<Vec<_>>()
            .into_iter()
            .map(|p| (p, point(p, reach)))
            .collect()
    }

    #[test]
    fn every_crossing_is_counted_once() {
        for (reach, least) in [(60.0, 10_000), (4.0, 100), (0.5, 1)] {
            let edges = random(2100, reach);
            let all = (0..edges.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
            let want = all.filter(|&(i, j)| crate::region::segment::crosses(edges[i], edges[j])).count();
            assert_eq!(count(&edges, 1 << 30, &Budget::default()).unwrap(), want);
            assert!(want > least, "{want}");
        }
    }

    #[test]
    fn many_small_rings_are_looked_at_in_little_work() {
        let side = |k: usize| ((k % 300) as f64 * 2.0, (k / 300) as f64 * 2.0);
        let corners = |(x, y): (f64, f64)| {
            [(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)].map(|(x, y)| Vector::xy(x, y))
        };
        let squares = |n: usize| -> Vec<Segment<2>> {
            (0..n).flat_map(|k| crate::region::ring::edges(&corners(side(k))).collect::<Vec<_>>()).collect()
        };
        let budget = Budget::default();
        assert_eq!(count(&squares(90_000), 1000, &budget).unwrap(), 0);
        assert!(budget.work() < 90_000 * 4 * 500, "{}", budget.work());
    }

    #[test]
    fn neighbours_do_not_cross_but_what_runs_along_does() {
        let p = |x: f64, y: f64| Vector::xy(x, y);
        assert!(!cross((p(0.0, 0.0), p(1.0, 0.0)), (p(1.0, 0.0), p(1.0, 1.0))));
        assert!(!cross((p(0.0, 0.0), p(1.0, 0.0)), (p(1.0, 0.0), p(2.0, 0.0))), "one after the other");
        let there_and_back = [(p(0.0, 0.0), p(1.0, 0.0)), (p(1.0, 0.0), p(0.0, 0.0)), (p(3.0, 3.0), p(3.0, 3.0))];
        assert_eq!(distinct(&there_and_back).len(), 1);
        assert!(cross((p(0.0, 0.0), p(1.0, 0.0)), (p(0.0, 0.0), p(2.0, 0.0))));
        assert!(cross((p(0.0, 0.0), p(2.0, 0.0)), (p(1.0, 0.0), p(3.0, 0.0))));
        assert!(cross((p(0.0, 0.0), p(2.0, 0.0)), (p(1.0, 0.0), p(1.0, 3.0))), "touching");
    }

    #[test]
    fn too_many_corners_crossings_and_numbers_are_refused() {
        let refused = |limits: Limits, edges: &[Segment<2>]| {
            foresee(edges, &Budget::new(limits).stage("reading")).map_or_else(|e| e.to_string(), |()| "fine".into())
        };
        let edges = random(300, 100.0);
        assert_eq!(refused(Limits::default(), &edges), "fine");
        let few = refused(Limits { crossings: 100, ..Limits::default() }, &edges);
        assert!(
            few.contains("reading: places where edges of outlines cross") && few.contains("--limit crossings="),
            "{few}"
        );
        assert!(refused(Limits { outline_nodes: 299, ..Limits::default() }, &edges).contains("outline-nodes=598"));
        for wrong in [f64::NAN, f64::INFINITY, -1e30] {
            let told =
                refused(Limits::default(), &[(Vector::ZERO, Vector::ZERO), (Vector::xy(1.0, wrong), Vector::ZERO)]);
            assert!(told.contains("a corner at (1, "), "{told}");
        }
    }
}
