//! Along curves: ropes, vines, chains.

use std::ops::Range;

use arabesque_core::{Bounds, Budget, Domain, Error, Matrix, Result, Vector, arc_lengths, carried};

use super::{
    plan::{SitePlan, Territory},
    site::Site,
};

/// A number that varies along a curve: at shares of the length in rising order, linear in between and constant beyond.
#[derive(Clone, Debug, PartialEq)]
pub struct Along(pub Vec<(f64, f64)>);

impl Along {
    /// The same everywhere.
    pub fn constant(value: f64) -> Self {
        Self(vec![(0.0, value)])
    }

    /// The value at a share of the length.
    pub fn at(&self, share: f64) -> f64 {
        let after = self.0.partition_point(|s| s.0 <= share);
        match (after.checked_sub(1).and_then(|n| self.0.get(n)), self.0.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (share - a.0) / (b.0 - a.0),
            (Some(a), None) => a.1,
            (None, Some(b)) => b.1,
            (None, None) => 0.0,
        }
    }
}

/// One line that the pattern runs along.
#[derive(Clone, Debug)]
pub struct Thread<const D: usize> {
    /// Its corners; the first one comes again at the end where `closed`.
    pub corners: Vec<Vector<D>>,
    /// Whether it is closed.
    pub closed: bool,
    /// Size of the pattern along it.
    pub scale: Along,
    /// How far the pattern is turned about the line, in radians.
    pub roll: Along,
}

impl<const D: usize> Thread<D> {
    /// The pattern as it is along a line, which is closed where it ends at its start.
    pub fn new(mut corners: Vec<Vector<D>>) -> Self {
        let bounds = Bounds::around(corners.iter().copied());
        let size = if bounds.is_empty() { 0.0 } else { bounds.size().norm() };
        corners.dedup_by(|a, b| (*a - *b).norm() <= 1e-9 * size);
        let closed = corners.len() > 3 && (corners[0] - corners[corners.len() - 1]).norm() <= 1e-3 * size;
        if closed {
            let first = corners[0];
            let last = corners.len() - 1;
            corners[last] = first;
        }
        Self { corners, closed, scale: Along::constant(1.0), roll: Along::constant(0.0) }
    }
}

/// The surroundings of one or several lines. A pattern that repeats along more than one direction fills a tube of the given radius.
#[derive(Clone, Debug)]
pub struct Tube<const D: usize> {
    threads: Vec<Traced<D>>,
    /// How far from the line there are sites across it, for patterns that repeat across it; in the units of the output.
    radius: f64,
}

/// A line with its lengths and frames.
#[derive(Clone, Debug)]
struct Traced<const D: usize> {
    thread: Thread<D>,
    /// Length from the start to each corner.
    lengths: Vec<f64>,
    /// Frame at each corner: the tangent, and the directions across.
    frames: Vec<[Vector<D>; D]>,
    /// The segments in runs, so that those that are far away need not be looked at one by one.
    runs: Vec<Run<D>>,
}

/// Segments that follow one another, and a ball around them.
#[derive(Clone, Debug)]
struct Run<const D: usize> {
    segments: Range<usize>,
    middle: Vector<D>,
    radius: f64,
}

impl<const D: usize> Tube<D> {
    /// A tube around lines.
    ///
    /// # Errors
    /// When there is no line, or one has no length.
    pub fn new(threads: Vec<Thread<D>>, radius: f64) -> Result<Self> {
        if threads.is_empty() {
            return Err(Error::input("the curve", "no line", "give a polyline or a path"));
        }
        let threads: Result<Vec<_>> = threads.into_iter().enumerate().map(|(n, t)| Traced::new(n, t)).collect();
        Ok(Self { threads: threads?, radius })
    }
}

/// Where the nearest of the lines runs by a place, and how.
#[derive(Clone, Copy, Debug)]
pub struct Foot<const D: usize> {
    /// The nearest point.
    pub point: Vector<D>,
    /// From the pattern, whose x runs along the line, to its frame there.
    pub rotation: Matrix<D>,
    /// How far away it is.
    pub distance: f64,
    /// How far beyond an end of an open line the place lies along it; 0 for most.
    pub beyond: f64,
}

impl<const D: usize> Tube<D> {
    /// The nearest point of the lines to `p`.
    pub fn foot(&self, p: Vector<D>) -> Foot<D> {
        let of = |traced: &Traced<D>| {
            let (s, offset) = traced.nearest(p);
            (offset.norm(), s, offset)
        };
        let mut best = (0, of(&self.threads[0]));
        for (n, traced) in self.threads.iter().enumerate().skip(1) {
            let found = of(traced);
            if found.0 < best.1.0 {
                best = (n, found);
            }
        }
        let (traced, (distance, s, offset)) = (&self.threads[best.0], best.1);
        let (_, rotation, _) = traced.at(s, 0);
        let is_end = !traced.thread.closed && (s <= 0.0 || s >= traced.length());
        let tangent = Vector(std::array::from_fn(|r| rotation.0[r][0]));
        let beyond = if is_end { (offset.dot(tangent) * if s <= 0.0 { -1.0 } else { 1.0 }).max(0.0) } else { 0.0 };
        Foot { point: p - offset, rotation, distance, beyond }
    }

    /// The smallest box around the lines.
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.threads.iter().flat_map(|t| t.thread.corners.iter().copied()))
    }

    /// Length of all lines.
    pub fn length(&self) -> f64 {
        self.threads.iter().map(Traced::length).sum()
    }
}

impl<const D: usize> Traced<D> {
    fn new(n: usize, thread: Thread<D>) -> Result<Self> {
        let lengths = arc_lengths(&thread.corners);
        let length = lengths.last().copied().unwrap_or(0.0);
        if !(length > 0.0 && length.is_finite()) {
            let problem = format!("line {} has no length", n + 1);
            return Err(Error::input("the curve", problem, "give a line with at least two different points"));
        }
        let frames = frames(&thread);
        let runs = runs(&thread.corners);
        Ok(Self { thread, lengths, frames, runs })
    }

    fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// By how much the pattern is stretched so that it closes: whole repetitions fill a closed line.
    fn closing(&self, plan: &SitePlan<D>) -> f64 {
        let (true, Some(repetition)) = (self.thread.closed, plan.repetition) else { return 1.0 };
        let steps = 256;
        let share = |k: usize| (k as f64 + 0.5) / f64::from(steps);
        let shown: f64 = (0..steps as usize).map(|k| 1.0 / self.thread.scale.at(share(k)).max(1e-9)).sum();
        let count = shown / f64::from(steps) * self.length() / repetition;
        if count < 1.0 { 1.0 } else { count / count.round() }
    }

    /// Point, rotation with `along` as the tangent's coordinate, and scale at a distance from the start; straight on beyond the ends.
    fn at(&self, s: f64, along: usize) -> (Vector<D>, Matrix<D>, f64) {
        let length = self.length();
        let inside = if self.thread.closed { s.rem_euclid(length) } else { s.clamp(0.0, length) };
        let after = self.lengths.partition_point(|&l| l <= inside).clamp(1, self.lengths.len() - 1);
        let (a, b) = (self.lengths[after - 1], self.lengths[after]);
        let t = if b > a { (inside - a) / (b - a) } else { 0.0 };
        let corners = &self.thread.corners;
        let blend = |k: usize| self.frames[after - 1][k] * (1.0 - t) + self.frames[after][k] * t;
        let mut place = corners[after - 1] + (corners[after] - corners[after - 1]) * t;
        let mut columns = Matrix::zero();
        for k in 0..D {
            let direction = blend(k);
            // In cyclic order, so that right-handed stays right-handed.
            let c = (along + k) % D;
            (0..D).for_each(|r| columns.0[r][c] = direction[r]);
        }
        let mut rotation = columns.nearest_rotation();
        let share = inside / length;
        let roll = self.thread.roll.at(share);
        if D == 3 && roll != 0.0 {
            let column = |c: usize| Vector([rotation.0[0][c], rotation.0[1][c], rotation.0[2 % D][c]]);
            let (u, v) = (column((along + 1) % D), column((along + 2) % D));
            let (p, q) = (u * roll.cos() + v * roll.sin(), v * roll.cos() - u * roll.sin());
            for r in 0..D {
                rotation.0[r][(along + 1) % D] = p[r];
                rotation.0[r][(along + 2) % D] = q[r];
            }
        }
        if s != inside && !self.thread.closed {
            let tangent = Vector(std::array::from_fn(|r| rotation.0[r][along]));
            place += tangent * (s - inside);
        }
        (place, rotation, self.thread.scale.at(share))
    }

    /// The nearest point of the line to `p`: distance along it, and offset from there.
    fn nearest(&self, p: Vector<D>) -> (f64, Vector<D>) {
        let gap = |run: &Run<D>| ((p - run.middle).norm() - run.radius).max(0.0);
        let mut best = Near { d2: f64::INFINITY, segment: 0, share: 0.0, offset: Vector::ZERO };
        // The run that seems nearest rules out most of the others.
        let first =
            (0..self.runs.len()).min_by(|&a, &b| gap(&self.runs[a]).total_cmp(&gap(&self.runs[b]))).unwrap_or(0);
        for n in std::iter::once(first).chain((0..self.runs.len()).filter(|&n| n != first)) {
            // A run whose ball just touches may hold the nearest point, whatever rounding makes of it.
            if gap(&self.runs[n]).powi(2) <= best.d2 * (1.0 + 1e-9) {
                self.look(&self.runs[n], p, &mut best);
            }
        }
        let Near { segment: n, share, offset, .. } = best;
        (self.lengths[n] + share * (self.lengths[n + 1] - self.lengths[n]), offset)
    }

    /// The nearest point of some segments, if it is nearer than `best`; of equally near ones the first along the line.
    fn look(&self, run: &Run<D>, p: Vector<D>, best: &mut Near<D>) {
        for segment in run.segments.clone() {
            let [a, b] = [self.thread.corners[segment], self.thread.corners[segment + 1]];
            let d = b - a;
            let share = ((p - a).dot(d) / d.norm2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let offset = p - (a + d * share);
            let d2 = offset.norm2();
            if d2 < best.d2 || d2 == best.d2 && segment < best.segment {
                *best = Near { d2, segment, share, offset };
            }
        }
    }
}

/// The nearest point of a line so far: squared distance, segment, share of the way along that, and offset.
struct Near<const D: usize> {
    d2: f64,
    segment: usize,
    share: f64,
    offset: Vector<D>,
}

/// The segments between `corners` in about as many runs as a run has segments.
fn runs<const D: usize>(corners: &[Vector<D>]) -> Vec<Run<D>> {
    let count = corners.len() - 1;
    let long = ((count as f64).sqrt().ceil() as usize).max(4);
    let run = |from: usize| {
        let segments = from..(from + long).min(count);
        let own = &corners[from..=segments.end];
        let middle = Bounds::around(own.iter().copied()).centre();
        let radius = own.iter().map(|&c| (c - middle).norm()).fold(0.0, f64::max);
        Run { segments, middle, radius }
    };
    (0..count).step_by(long).map(run).collect()
}

/// Tangents and directions across at the corners of a line.
fn frames<const D: usize>(thread: &Thread<D>) -> Vec<[Vector<D>; D]> {
    let corners = &thread.corners;
    let n = corners.len();
    let step = |k: usize| (corners[k + 1] - corners[k]).unit_or_zero();
    let tangents: Vec<Vector<D>> = (0..n)
        .map(|k| {
            let (before, after) = match (k, thread.closed) {
                (0, true) => (step(n - 2), step(0)),
                (0, false) => (step(0), step(0)),
                (k, true) if k == n - 1 => (step(n - 2), step(0)),
                (k, false) if k == n - 1 => (step(n - 2), step(n - 2)),
                _ => (step(k - 1), step(k)),
            };
            (before + after).unit_if_longer(1e-9).unwrap_or(after)
        })
        .collect();
    if D == 2 {
        return tangents.iter().map(|t| std::array::from_fn(|k| if k == 0 { *t } else { left(*t) })).collect();
    }
    let in_space: Vec<Vector<3>> = tangents.iter().map(|t| Vector(std::array::from_fn(|k| t[k.min(D - 1)]))).collect();
    let first = in_space[0];
    // Square to the tangent, from the axis that it is least along.
    let least = (0..3).min_by(|&a, &b| first[a].abs().total_cmp(&first[b].abs())).unwrap_or(2);
    let mut axis = Vector::<3>::ZERO;
    axis[least] = 1.0;
    let side = (axis - first * axis.dot(first)).unit_or_zero();
    let sides = carried(&in_space, side, thread.closed);
    let narrow = |v: Vector<3>| Vector(std::array::from_fn(|k| v[k]));
    in_space
        .iter()
        .zip(&sides)
        .map(|(t, s)| {
            let third = t.cross(*s);
            std::array::from_fn(|k| narrow([*t, *s, third][k]))
        })
        .collect()
}

/// A direction of the plane turned to the left; of space it is not asked for.
fn left<const D: usize>(t: Vector<D>) -> Vector<D> {
    Vector(std::array::from_fn(|k| if k == 0 { -t[1] } else { t[0] }))
}

impl<const D: usize> Territory<D> for Tube<D> {
    fn sites(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>> {
        let along = (0..D).find(|&k| plan.base[k]).unwrap_or(0);
        let across: Vec<usize> = (0..D).filter(|&k| plan.base[k] && k != along).collect();
        let mut sites = Vec::new();
        for traced in &self.threads {
            let fit = traced.closing(plan);
            let scale = |s: f64| fit * traced.thread.scale.at((s / traced.length()).clamp(0.0, 1.0));
            let margin = if traced.thread.closed { 0.0 } else { plan.margin };
            // Stations as far apart as the pattern is large there: equal steps of the length measured in it.
            let (mut stations, mut s) = (Vec::new(), -margin * scale(0.0));
            let end = traced.length() + if traced.thread.closed { 0.0 } else { margin * scale(traced.length()) };
            while s < end {
                if !(scale(s) > 0.0 && scale(s).is_finite()) {
                    return Err(Error::parameter("scale", scale(s), "a positive number all along the curve"));
                }
                stations.push(s);
                s += plan.step * scale(s);
                budget.within(
                    "quadrature points",
                    stations.len(),
                    ("output-elements", budget.limits().output_elements),
                )?;
            }
            // Spread what is left evenly.
            let stretch = (end - stations[0]) / (s - stations[0]);
            let start = stations[0];
            for s in stations.into_iter().map(|s| start + (s - start) * stretch) {
                let (place, rotation, scale) = traced.at(s, along);
                let scale = fit * scale;
                let weight = stretch;
                let reach = if across.is_empty() {
                    0
                } else {
                    ((self.radius + plan.margin * scale) / (plan.step * scale)) as i64
                };
                let side = 2 * reach + 1;
                for n in 0..side.pow(across.len() as u32) {
                    let (mut rest, mut offset) = (n, Vector::<D>::ZERO);
                    for &k in &across {
                        offset[k] = (rest % side - reach) as f64 * plan.step;
                        rest /= side;
                    }
                    if offset.norm() * scale <= self.radius + plan.margin * scale {
                        sites.push(Site { place: place + rotation.apply(offset) * scale, rotation, scale, weight });
                    }
                }
                budget.spend(1_000)?;
            }
        }
        Ok(sites)
    }

    fn contains(&self, p: Vector<D>, plan: &SitePlan<D>) -> bool {
        let wide = plan.base.iter().filter(|b| **b).count() > 1;
        self.threads.iter().any(|traced| {
            let (s, offset) = traced.nearest(p);
            let end = !traced.thread.closed && (s <= 0.0 || s >= traced.length());
            if end {
                let (_, rotation, _) = traced.at(s, 0);
                let tangent = Vector(std::array::from_fn(|r| rotation.0[r][0]));
                let beyond = offset.dot(tangent) * if s <= 0.0 { -1.0 } else { 1.0 };
                if beyond > 0.0 {
                    return false;
                }
            }
            !wide || offset.norm() <= self.radius
        })
    }

    fn surroundings(&self) -> Domain<D> {
        let corners = self.threads.iter().flat_map(|t| t.thread.corners.iter().copied());
        Domain::Box(Bounds::around(corners).grown(self.radius))
    }

    fn measure(&self, repeats: usize) -> f64 {
        let length: f64 = self.threads.iter().map(Traced::length).sum();
        match repeats {
            1 => length,
            2 => length * 2.0 * self.radius,
            _ => length * std::f64::consts::PI * self.radius * self.radius,
        }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Stage, Stream};

    use super::*;

    #[test]
    fn runs_of_segments_find_what_all_segments_would() {
        let mut random = Stream::new(7, Stage::TEST, 0);
        for count in [2, 3, 17, 600] {
            let mut at = Vector::ZERO;
            let mut step = || {
                at += Vector(std::array::from_fn(|_| random.range(-1.0, 1.0)));
                at
            };
            let traced = Traced::new(0, Thread::<3>::new((0..count).map(|_| step()).collect())).unwrap();
            let corners = &traced.thread.corners;
            for _ in 0..200 {
                let p = Vector(std::array::from_fn(|_| random.range(-15.0, 15.0)));
                let of = |n: usize| {
                    let d = corners[n + 1] - corners[n];
                    let share = ((p - corners[n]).dot(d) / d.norm2()).clamp(0.0, 1.0);
                    (p - (corners[n] + d * share)).norm()
                };
                let least = (0..corners.len() - 1).map(of).fold(f64::INFINITY, f64::min);
                let (s, offset) = traced.nearest(p);
                assert!((offset.norm() - least).abs() < 1e-12, "{count}: {} {least}", offset.norm());
                assert!((traced.at(s, 0).0 - (p - offset)).norm() < 1e-9, "the length leads to the same place");
            }
        }
    }
}
