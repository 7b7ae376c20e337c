//! The centre line of a mesh that is long and thin.
//!
//! How far each vertex is from both ends along the surface slices the mesh; the middles of the slices are a line, and slices across that
//! line a better one. Nothing is asked of how the mesh is made: rings of any number, caps or none, triangles in any order.

use std::{cmp::Reverse, collections::BinaryHeap};

use arabesque_core::{Budget, Result, TriangleMesh, Vector, polyline_length};

use crate::mesh::topology::Topology;

/// Slices of the first line, and of the finer ones that follow it.
const FIRST: usize = 16;
const FINE: usize = 32;
const PASSES: usize = 3;
/// A place belongs to a stretch of the line that is no farther along it from where it was taken for than this share of its length.
const WINDOW: f64 = 0.12;
/// A line that is shorter than this share of the way along the surface is none: the thing is round, or a ring.
const STRAIGHT: f64 = 0.72;
/// So many times longer than thick it is at least.
const LEAST: f64 = 2.0;
/// A slice may reach so many of its mean radii from its middle: the thing may be flat, but is no pair of arms.
const FLAT: f64 = 2.6;
/// Slices between the ends are as thick as the median one within these factors.
const EVEN: (f64, f64) = (0.3, 2.2);
/// Share of the slices at either end that may be of any thickness.
const ENDS: f64 = 0.12;
/// The line goes on beyond its outermost slices by no more than so many steps.
const BEYOND: f64 = 1.5;
/// Places of a line that tell whether it is straight.
const SAGGING: usize = 24;
/// Work of a corner of a triangle in a pass.
const CORNER: u64 = 600;

/// A long thin thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Tube {
    /// Its centre line from one end to the other.
    pub line: Vec<Vector<3>>,
    /// Mean distance of its surface from that.
    pub radius: f64,
}

/// A slice: its middle, mean and largest distance from there.
#[derive(Clone, Copy, Debug)]
struct Slice {
    middle: Vector<3>,
    mean: f64,
    most: f64,
}

impl Tube {
    /// The centre line of a mesh; `None` where it is not one long thing, as round things, rings and several things are not.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub fn of(mesh: &TriangleMesh, budget: &Budget) -> Result<Option<Self>> {
        if mesh.triangles.len() < 8 || mesh.positions.iter().any(|p| !p.is_finite()) {
            return Ok(None);
        }
        budget.spend(CORNER * 3 * mesh.triangles.len() as u64)?;
        let topology = Topology::new(mesh, budget)?;
        let Some((along, length)) = along_surface(&topology) else { return Ok(None) };
        let Some(mut slices) = sliced(&topology, &along, FIRST) else { return Ok(None) };
        for _ in 0..PASSES {
            budget.spend(CORNER * topology.points.len() as u64)?;
            let line = ended(&topology, &slices);
            let places = along_line(&topology, &line, &along);
            let Some(finer) = sliced(&topology, &places, FINE) else { return Ok(None) };
            slices = finer;
        }
        let line = ended(&topology, &slices);
        let mut thickness: Vec<f64> = slices.iter().map(|s| s.mean).collect();
        thickness.sort_by(f64::total_cmp);
        let radius = thickness[thickness.len() / 2];
        let inner = (ENDS * slices.len() as f64).ceil() as usize;
        let is_even = slices[inner..slices.len() - inner]
            .iter()
            .all(|s| s.mean > EVEN.0 * radius && s.mean < EVEN.1 * radius && s.most < FLAT * s.mean);
        let tube = Self { line, radius };
        let is_one = is_even && radius > 0.0 && tube.length() > STRAIGHT * length && tube.slenderness() >= LEAST;
        Ok(is_one.then_some(tube))
    }

    /// Length of the centre line.
    pub fn length(&self) -> f64 {
        polyline_length(&self.line)
    }

    /// How many times longer than thick it is.
    pub fn slenderness(&self) -> f64 {
        self.length() / (2.0 * self.radius)
    }

    /// By how much the line leaves the straight way between its ends, in radii; its very ends, which caps decide, left out.
    pub fn sag(&self) -> f64 {
        let places = self.samples(SAGGING);
        let inner = &places[2..places.len() - 2];
        let (Some(a), Some(b)) = (inner.first(), inner.last()) else { return 0.0 };
        let axis = (*b - *a).unit_or_zero();
        let off = |p: &Vector<3>| (*p - *a - axis * (*p - *a).dot(axis)).norm();
        inner.iter().map(off).fold(0.0, f64::max) / self.radius
    }

    /// So many places at even steps along the line.
    pub fn samples(&self, count: usize) -> Vec<Vector<3>> {
        let steps = count.max(2) - 1;
        let (total, mut done, mut k) = (self.length(), 0.0, 0);
        let mut found = Vec::with_capacity(steps + 1);
        for n in 0..=steps {
            let at = total * n as f64 / steps as f64;
            let mut step = (self.line[k + 1] - self.line[k]).norm();
            while k + 2 < self.line.len() && done + step < at {
                done += step;
                k += 1;
                step = (self.line[k + 1] - self.line[k]).norm();
            }
            let share = if step > 0.0 { ((at - done) / step).clamp(0.0, 1.0) } else { 0.0 };
            found.push(self.line[k] + (self.line[k + 1] - self.line[k]) * share);
        }
        found
    }
}

/// For each vertex where it lies between the two ends of the surface, and how far these are apart along it.
fn along_surface(topology: &Topology) -> Option<(Vec<f64>, f64)> {
    let points = &topology.points;
    let mut edges: Vec<Vec<(u32, f64)>> = vec![Vec::new(); points.len()];
    for t in &topology.triangles {
        for k in 0..3 {
            let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
            let length = (points[a] - points[b]).norm();
            edges[a].push((b as u32, length));
            edges[b].push((a as u32, length));
        }
    }
    let middle = points.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / points.len() as f64);
    let start = farthest(points.iter().map(|p| (*p - middle).norm()))?;
    let first = farthest(distances(&edges, start).into_iter())?;
    let from_first = distances(&edges, first);
    let last = farthest(from_first.iter().copied())?;
    let from_last = distances(&edges, last);
    let length = from_first[last];
    // Vertices that no triangle uses are nowhere, and neither is another component.
    let is_whole = topology.triangles.iter().flatten().all(|v| from_first[*v as usize].is_finite());
    if !(is_whole && length > 0.0 && length.is_finite()) {
        return None;
    }
    let place = |(a, b): (&f64, &f64)| if a.is_finite() { 0.5 * (a - b) } else { 0.0 };
    Some((from_first.iter().zip(&from_last).map(place).collect(), length))
}

/// The largest of finite distances.
fn farthest(distances: impl Iterator<Item = f64>) -> Option<usize> {
    let finite = distances.enumerate().filter(|(_, d)| d.is_finite());
    finite
        .fold(
            None,
            |best: Option<(usize, f64)>, (n, d)| if best.is_some_and(|b| b.1 >= d) { best } else { Some((n, d)) },
        )
        .map(|(n, _)| n)
}

/// Distances along edges from a vertex.
fn distances(edges: &[Vec<(u32, f64)>], from: usize) -> Vec<f64> {
    let mut found = vec![f64::INFINITY; edges.len()];
    let mut heap = BinaryHeap::new();
    found[from] = 0.0;
    heap.push(Reverse((0_u64, from)));
    while let Some(Reverse((bits, v))) = heap.pop() {
        // Distances are not negative: their bits are in the order of their values.
        let d = f64::from_bits(bits);
        if d > found[v] {
            continue;
        }
        for &(other, length) in &edges[v] {
            let through = d + length;
            if through < found[other as usize] {
                found[other as usize] = through;
                heap.push(Reverse((through.to_bits(), other as usize)));
            }
        }
    }
    found
}

/// Slices of a mesh at even steps of a value of its vertices; `None` where one is empty.
fn sliced(topology: &Topology, values: &[f64], count: usize) -> Option<Vec<Slice>> {
    let used = || topology.triangles.iter().flatten().map(|v| values[*v as usize]);
    let (low, high) = used().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let step = (high - low) / count as f64;
    if !(step > 0.0 && step.is_finite()) {
        return None;
    }
    let mut cuts: Vec<Vec<[Vector<3>; 2]>> = vec![Vec::new(); count];
    for t in &topology.triangles {
        let corners = t.map(|v| (topology.points[v as usize], values[v as usize]));
        let own = corners.map(|(_, v)| v);
        let (least, most) = (own[0].min(own[1]).min(own[2]), own[0].max(own[1]).max(own[2]));
        let first = ((least - low) / step - 0.5).ceil().max(0.0) as usize;
        for (k, cut) in cuts.iter_mut().enumerate().skip(first) {
            let level = low + (k as f64 + 0.5) * step;
            if level > most {
                break;
            }
            cut.extend(crossing(&corners, level));
        }
    }
    cuts.iter().map(|cut| slice(cut)).collect()
}

/// Where a triangle is cut at a value of its corners.
fn crossing(corners: &[(Vector<3>, f64); 3], level: f64) -> Option<[Vector<3>; 2]> {
    let mut found = [None; 2];
    let mut count = 0;
    for k in 0..3 {
        let ((a, u), (b, v)) = (corners[k], corners[(k + 1) % 3]);
        if (u < level) != (v < level) && count < 2 {
            found[count] = Some(a + (b - a) * ((level - u) / (v - u)));
            count += 1;
        }
    }
    Some([found[0]?, found[1]?])
}

fn slice(cut: &[[Vector<3>; 2]]) -> Option<Slice> {
    let total: f64 = cut.iter().map(|[a, b]| (*b - *a).norm()).sum();
    if total <= 0.0 {
        return None;
    }
    let middles = || cut.iter().map(|[a, b]| ((*a + *b) * 0.5, (*b - *a).norm()));
    let middle = middles().fold(Vector::ZERO, |sum, (m, l)| sum + m * l) * (1.0 / total);
    let mean = middles().map(|(m, l)| (m - middle).norm() * l).sum::<f64>() / total;
    let most = cut.iter().map(|[a, _]| (*a - middle).norm()).fold(0.0, f64::max);
    Some(Slice { middle, mean, most })
}

/// The middles of slices as a line that reaches to the tips of the mesh.
fn ended(topology: &Topology, slices: &[Slice]) -> Vec<Vector<3>> {
    let mut line: Vec<Vector<3>> = slices.iter().map(|s| s.middle).collect();
    let tip = |end: Vector<3>, step: Vector<3>, radius: f64| {
        let way = step.unit_or_zero();
        let ahead = |p: &Vector<3>| {
            let (along, off) = ((*p - end).dot(way), *p - end);
            (along > 0.0 && (off - way * along).norm() < 2.0 * radius).then_some(along)
        };
        let near = topology.points.iter().filter(|p| (**p - end).norm() < 6.0 * radius + (way.norm() * radius));
        // The outermost slices are half a step from the ends; what goes on farther than that goes around a corner.
        end + way * near.filter_map(ahead).fold(0.0, f64::max).min(BEYOND * step.norm())
    };
    if let [first, second, ..] = *slices {
        line.insert(0, tip(first.middle, first.middle - second.middle, first.most.max(second.most)));
    }
    if let [.., before, last] = *slices {
        line.push(tip(last.middle, last.middle - before.middle, last.most.max(before.most)));
    }
    line.dedup();
    line
}

/// For each vertex how far along a line its nearest place is, near where it was on the surface between the ends.
fn along_line(topology: &Topology, line: &[Vector<3>], along: &[f64]) -> Vec<f64> {
    let mut starts = vec![0.0];
    line.windows(2).for_each(|w| starts.push(starts[starts.len() - 1] + (w[1] - w[0]).norm()));
    let total = starts[starts.len() - 1];
    let (low, high) = along.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    let span = (high - low).max(f64::MIN_POSITIVE);
    let one = |(p, v): (&Vector<3>, &f64)| {
        let expected = (v - low) / span * total;
        let mut best = (f64::INFINITY, expected);
        for (k, w) in line.windows(2).enumerate() {
            if starts[k + 1] < expected - WINDOW * total || starts[k] > expected + WINDOW * total {
                continue;
            }
            let step = w[1] - w[0];
            let mut t = (*p - w[0]).dot(step) / step.norm2().max(f64::MIN_POSITIVE);
            // Beyond the ends the line goes on straight.
            let (is_first, is_last) = (k == 0, k + 2 == line.len());
            t = t.clamp(if is_first { f64::NEG_INFINITY } else { 0.0 }, if is_last { f64::INFINITY } else { 1.0 });
            let away = (w[0] + step * t - *p).norm2();
            if away < best.0 {
                best = (away, starts[k] + t * step.norm());
            }
        }
        best.1
    };
    topology.points.iter().zip(along).map(one).collect()
}
