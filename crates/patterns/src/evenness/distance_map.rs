//! How far places around an outline are from it: a raster that answers in a few nanoseconds.
//!
//! Each cell knows the edge that is nearest to it, handed on from cell to cell as in a distance transform; so the distances
//! are those of the outline itself and not of a drawing of it in cells. Between cells they are interpolated.

use arabesque_core::{Outline, Segment, Vector, segment};

/// No edge is known yet.
const NONE: u32 = u32::MAX;

/// Neighbouring cells that have their edge before a cell is looked at, when cells are walked through row by row.
const BEFORE: [(isize, isize); 4] = [(-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Signed distances from one outline, negative on its ink.
#[derive(Clone, Debug)]
pub(crate) struct DistanceMap {
    origin: Vector<2>,
    step: f64,
    per_step: f64,
    /// How far it reaches beyond the outline at least.
    margin: f64,
    counts: [usize; 2],
    value: Vec<f32>,
}

/// Cells of the map of an outline that reaches `margin` beyond it.
pub(crate) fn cells(outline: &Outline<2>, step: f64, margin: f64) -> [usize; 2] {
    let size = outline.bounds().grown(margin).size();
    size.0.map(|side| (side / step).ceil().max(1.0) as usize + 1)
}

/// The edge nearest to a cell, with the square of its distance: cells are offered many edges, and each but one is dropped.
#[derive(Clone, Copy)]
struct Nearest {
    edge: u32,
    distance2: f64,
}

impl Nearest {
    const NONE: Self = Self { edge: NONE, distance2: f64::INFINITY };

    /// Takes an edge that is nearer to the place of the cell than the one that is known.
    #[inline]
    fn offer(&mut self, edge: u32, ends: Segment<2>, place: Vector<2>) {
        if edge == self.edge {
            return;
        }
        let distance2 = (segment::nearest(ends, place) - place).norm2();
        if distance2 < self.distance2 {
            *self = Self { edge, distance2 };
        }
    }
}

impl DistanceMap {
    /// Measures `outline`, in cells of `step`, up to `margin` beyond it.
    pub(crate) fn new(outline: &Outline<2>, step: f64, margin: f64) -> Self {
        let bounds = outline.bounds().grown(margin);
        let counts = cells(outline, step, margin);
        let mut map = Self {
            origin: bounds.min,
            step,
            per_step: 1.0 / step,
            margin,
            counts,
            value: vec![0.0; counts[0] * counts[1]],
        };
        let edges: Vec<Segment<2>> = outline.edges().collect();
        let nearest = map.nearest_edges(&edges);
        for (value, found) in map.value.iter_mut().zip(nearest) {
            *value = if found.edge == NONE { f32::MAX } else { found.distance2.sqrt() as f32 };
        }
        map.mark_ink(&edges);
        map
    }

    fn place(&self, x: usize, y: usize) -> Vector<2> {
        self.origin + Vector::xy(x as f64, y as f64) * self.step
    }

    /// The edge nearest to each cell, or one that is hardly farther.
    fn nearest_edges(&self, edges: &[Segment<2>]) -> Vec<Nearest> {
        let [width, height] = self.counts;
        let mut nearest = vec![Nearest::NONE; width * height];
        for (e, &edge) in (0..).zip(edges) {
            self.sow(e, edge, &mut nearest);
        }
        for _ in 0..2 {
            for (flip, c) in (0..width * height).map(|c| (1, c)).chain((0..width * height).rev().map(|c| (-1, c))) {
                let (x, y) = ((c % width) as isize, (c / width) as isize);
                let place = self.place(x as usize, y as usize);
                for (dx, dy) in BEFORE {
                    let (u, v) = (x + flip * dx, y + flip * dy);
                    if (0..width as isize).contains(&u) && (0..height as isize).contains(&v) {
                        let offered = nearest[v as usize * width + u as usize].edge;
                        if let Some(&edge) = edges.get(offered as usize) {
                            nearest[c].offer(offered, edge, place);
                        }
                    }
                }
            }
        }
        nearest
    }

    /// Offers an edge to the cells that it runs through.
    fn sow(&self, e: u32, edge: Segment<2>, nearest: &mut [Nearest]) {
        let (a, b) = edge;
        let pieces = ((b - a).norm() / self.step).ceil().max(1.0) as usize;
        for k in 0..=pieces {
            let p = (a + (b - a) * (k as f64 / pieces as f64) - self.origin) * (1.0 / self.step);
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (x, y) = (p[0] as usize + dx, p[1] as usize + dy);
                if x < self.counts[0] && y < self.counts[1] {
                    nearest[y * self.counts[0] + x].offer(e, edge, self.place(x, y));
                }
            }
        }
    }

    /// Turns the distances on ink negative: where an odd number of edges lies to the left.
    fn mark_ink(&mut self, edges: &[Segment<2>]) {
        let [width, height] = self.counts;
        let mut crossings = vec![Vec::new(); height];
        for &edge in edges {
            let (low, high) = (edge.0[1].min(edge.1[1]), edge.0[1].max(edge.1[1]));
            let row = |y: f64| (((y - self.origin[1]) / self.step).floor().max(0.0) as usize).min(height - 1);
            for (r, found) in crossings.iter_mut().enumerate().take(row(high) + 1).skip(row(low)) {
                found.extend(segment::crossing_at_height(edge, self.place(0, r)[1]));
            }
        }
        for (r, mut found) in crossings.into_iter().enumerate() {
            found.sort_by(f64::total_cmp);
            let mut passed = 0;
            for x in 0..width {
                let at = self.origin[0] + x as f64 * self.step;
                while found.get(passed).is_some_and(|&crossing| crossing <= at) {
                    passed += 1;
                }
                if passed % 2 == 1 {
                    self.value[r * width + x] = -self.value[r * width + x];
                }
            }
        }
    }

    /// Distance of a place from the ink, negative on it. Beyond the map, a little too large.
    #[inline]
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let (u, v) = ((x - self.origin.0[0]) * self.per_step, (y - self.origin.0[1]) * self.per_step);
        let [width, height] = self.counts;
        // Compared with what is not a number, nothing is inside.
        let is_inside = u >= 0.0 && v >= 0.0 && u < (width - 1) as f64 && v < (height - 1) as f64;
        if is_inside { self.between(u, v) } else { self.beyond(u, v) }
    }

    /// The same, but beyond the map no more than is certain.
    #[inline]
    pub(crate) fn at_least(&self, [x, y]: [f64; 2]) -> f64 {
        let (u, v) = ((x - self.origin.0[0]) * self.per_step, (y - self.origin.0[1]) * self.per_step);
        let [width, height] = self.counts;
        let is_inside = u >= 0.0 && v >= 0.0 && u < (width - 1) as f64 && v < (height - 1) as f64;
        if is_inside { self.between(u, v) } else { self.margin }
    }

    /// Between the cells around a place inside the map, in cells.
    #[inline]
    fn between(&self, u: f64, v: f64) -> f64 {
        let (i, j) = (u as i32, v as i32);
        let (s, t) = ((u - f64::from(i)) as f32, (v - f64::from(j)) as f32);
        let row = j as usize * self.counts[0] + i as usize;
        let (Some(&[a, b]), Some(&[c, d])) =
            (self.value[row..].first_chunk(), self.value[row + self.counts[0]..].first_chunk())
        else {
            return f64::INFINITY;
        };
        let (low, high) = (a + (b - a) * s, c + (d - c) * s);
        f64::from(low + (high - low) * t)
    }

    #[cold]
    fn beyond(&self, u: f64, v: f64) -> f64 {
        let inner = |x: f64, count: usize| x.clamp(0.0, (count - 1) as f64 * (1.0 - 1e-12) - 1e-9);
        let (a, b) = (inner(u, self.counts[0]), inner(v, self.counts[1]));
        self.between(a, b) + ((u - a) * (u - a) + (v - b) * (v - b)).sqrt() * self.step
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Outline, Stage, Stream};

    use super::*;

    #[test]
    fn distances_are_those_to_the_nearest_edge() {
        for seed in 0..5 {
            let mut random = Stream::new(seed, Stage::TEST, 0);
            let corner = |k: u32| {
                let turn = std::f64::consts::TAU * f64::from(k) / 23.0;
                Vector::xy(turn.cos(), turn.sin()) * random.range(2.0, 9.0)
            };
            let outline = Outline { rings: vec![(0..23).map(corner).collect()] };
            let map = DistanceMap::new(&outline, 0.37, 5.0);
            let edges: Vec<Segment<2>> = outline.edges().collect();
            for (c, &value) in map.value.iter().enumerate() {
                let place = map.place(c % map.counts[0], c / map.counts[0]);
                let nearest = edges.iter().map(|&e| segment::distance(e, place)).fold(f64::INFINITY, f64::min);
                assert!((f64::from(value.abs()) - nearest).abs() < 0.02, "seed {seed}: {value} for {nearest}");
                assert_eq!(value < 0.0, outline.contains(place), "seed {seed}: {place:?}");
            }
        }
    }
}
