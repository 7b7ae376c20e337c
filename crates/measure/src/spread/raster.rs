//! Ink on a grid of cells: how far every place is from it, and how much of it lies around.

use arabesque_core::{Bounds, Budget, Outline, Result, Vector, cell_index, cell_place, segment};
use rayon::prelude::*;

use crate::scene::Scene;

/// Cells along a spacing, in the plane and in space.
const FINENESS: [f64; 2] = [20.0, 8.0];
/// Most cells of one grid.
const MOST_CELLS: f64 = 8e6;
/// Work for each cell.
const CELL: u64 = 60;
/// Farther than anything, in cells.
const FAR: f32 = 1e18;

/// Cells over a box.
#[derive(Clone, Debug)]
pub(crate) struct Raster<const D: usize> {
    pub(crate) bounds: Bounds<D>,
    pub(crate) counts: [usize; D],
    /// Side of a cell.
    pub(crate) pitch: f64,
    /// Whether there is ink at the middle of each cell.
    pub(crate) ink: Vec<bool>,
}

/// Side of the cells with which both of two boxes are looked at.
pub(crate) fn pitch<const D: usize>(spacing: f64, boxes: &[Bounds<D>]) -> f64 {
    let fine = spacing / FINENESS[usize::from(D > 2)];
    let largest = boxes.iter().map(Bounds::measure).fold(0.0, f64::max);
    fine.max((largest / MOST_CELLS).powf(1.0 / D as f64))
}

impl<const D: usize> Raster<D> {
    /// The ink of a scene, in the box around its domain.
    pub(crate) fn of(scene: &Scene<'_, D>, pitch: f64, budget: &Budget) -> Result<Self> {
        let bounds = scene.domain.bounds();
        let counts = bounds.size().0.map(|side| ((side / pitch).round() as usize).max(1));
        let cells = counts.iter().product::<usize>();
        budget.spend(CELL * cells as u64)?;
        let mut raster = Self { bounds, counts, pitch, ink: vec![false; cells] };
        let mut meter = budget.meter();
        for body in &scene.bodies {
            meter.spend(raster.rows_of(&body.bounds) * (1 + body.outline.points().count() as u64))?;
            raster.fill(&body.outline);
            raster.dot(body.centre, body.outline.rings.is_empty());
        }
        for area in &scene.content.areas {
            meter.spend(raster.rows_of(&area.outline.bounds()) * area.outline.points().count() as u64)?;
            raster.fill(&area.outline);
        }
        for line in &scene.lines {
            let reach = (0.5 * line.width).max(0.6 * pitch);
            for w in line.points.windows(2) {
                let around = Bounds::around([w[0], w[1]]).grown(reach);
                meter.spend(8 * raster.cells_in(&around))?;
                raster.stroke((w[0], w[1]), reach);
            }
        }
        Ok(raster)
    }

    /// Middle of a cell.
    pub(crate) fn middle(&self, index: usize) -> Vector<D> {
        let place = cell_place(index, &self.counts);
        Vector(std::array::from_fn(|k| self.bounds.min[k] + (place[k] as f64 + 0.5) * self.pitch))
    }

    /// The cells whose middles may lie in a box, from and to in each coordinate.
    fn span(&self, b: &Bounds<D>) -> [std::ops::Range<usize>; D] {
        std::array::from_fn(|k| {
            let at = |v: f64| ((v - self.bounds.min[k]) / self.pitch - 0.5).clamp(-1.0, self.counts[k] as f64);
            let (low, high) = (at(b.min[k]).ceil().max(0.0), at(b.max[k]).floor() + 1.0);
            low as usize..(high.max(0.0) as usize).min(self.counts[k])
        })
    }

    fn cells_in(&self, b: &Bounds<D>) -> u64 {
        self.span(b).iter().map(|s| s.len() as u64).product::<u64>() + 1
    }

    fn rows_of(&self, b: &Bounds<D>) -> u64 {
        self.span(b).iter().skip(1).map(|s| s.len() as u64).product::<u64>() + 1
    }

    /// Marks the cell at a place; where something has an area, only if that has marked none.
    fn dot(&mut self, p: Vector<D>, is_point: bool) {
        let place: [f64; D] = std::array::from_fn(|k| ((p[k] - self.bounds.min[k]) / self.pitch).floor());
        let inside = (0..D).all(|k| place[k] >= 0.0 && (place[k] as usize) < self.counts[k]);
        if inside && is_point {
            let index = cell_index(place.map(|v| v as usize), &self.counts);
            self.ink[index] = true;
        }
    }

    /// Marks what an outline of the plane covers, by the even-odd rule along rows of cells.
    fn fill(&mut self, outline: &Outline<D>) {
        if D != 2 || outline.rings.is_empty() {
            return;
        }
        let rows = self.span(&outline.bounds())[1].clone();
        let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); rows.len()];
        for ring in &outline.rings {
            for k in 0..ring.len() {
                let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
                let (low, high) = (a[1].min(b[1]), a[1].max(b[1]));
                let at = |v: f64| ((v - self.bounds.min[1]) / self.pitch - 0.5).ceil().max(rows.start as f64) as usize;
                for row in at(low)..at(high).min(rows.end) {
                    let y = self.bounds.min[1] + (row as f64 + 0.5) * self.pitch;
                    crossings[row - rows.start].push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
                }
            }
        }
        for (row, mut xs) in rows.zip(crossings) {
            xs.sort_by(f64::total_cmp);
            for pair in xs.chunks_exact(2) {
                let at = |v: f64| {
                    ((v - self.bounds.min[0]) / self.pitch - 0.5).ceil().clamp(0.0, self.counts[0] as f64) as usize
                };
                let (from, to) = (at(pair[0]), at(pair[1]));
                self.ink[row * self.counts[0] + from..row * self.counts[0] + to.max(from)].fill(true);
            }
        }
    }

    /// Marks what lies within `reach` of a straight stroke.
    fn stroke(&mut self, piece: (Vector<D>, Vector<D>), reach: f64) {
        let span = self.span(&Bounds::around([piece.0, piece.1]).grown(reach));
        let sides: [usize; D] = std::array::from_fn(|k| span[k].len());
        for step in 0..sides.iter().product() {
            let offset = cell_place(step, &sides);
            let place: [usize; D] = std::array::from_fn(|k| span[k].start + offset[k]);
            let index = cell_index(place, &self.counts);
            if !self.ink[index] && segment::distance(piece, self.middle(index)) <= reach {
                self.ink[index] = true;
            }
        }
    }

    /// Distance of the middle of every cell to the nearest cell with ink, in user units; infinite where there is no ink at all
    /// [Felzenszwalb 2012].
    pub(crate) fn distances(&self, budget: &Budget) -> Result<Vec<f32>> {
        budget.spend(CELL * self.ink.len() as u64)?;
        let mut squares: Vec<f32> = self.ink.iter().map(|&ink| if ink { 0.0 } else { FAR }).collect();
        self.along_all(&mut squares, |line| {
            let envelope = lower_envelope(line);
            line.copy_from_slice(&envelope);
        });
        let pitch = self.pitch as f32;
        squares.par_iter_mut().for_each(|d| *d = if *d >= 0.5 * FAR { f32::INFINITY } else { d.sqrt() * pitch });
        Ok(squares)
    }

    /// Share of ink around every cell, under a bell as wide as `deviation`, of what lies in `inside`.
    pub(crate) fn smoothed(&self, deviation: f64, inside: &[bool], budget: &Budget) -> Result<Vec<f32>> {
        budget.spend(2 * CELL * self.ink.len() as u64)?;
        // Three boxes are a bell: each adds a variance of (w^2 - 1) / 12.
        let width = ((4.0 * (deviation / self.pitch).powi(2) + 1.0).sqrt().round() as usize) | 1;
        let blurred = |mut values: Vec<f32>| {
            self.along_all(&mut values, |line| (0..3).for_each(|_| box_mean(line, width)));
            values
        };
        let known = blurred(inside.iter().map(|&i| f32::from(u8::from(i))).collect());
        let ink = blurred(self.ink.iter().zip(inside).map(|(&ink, &i)| f32::from(u8::from(ink && i))).collect());
        Ok(ink.into_iter().zip(known).map(|(ink, known)| if known > 1e-3 { ink / known } else { 0.0 }).collect())
    }

    /// Applies `work` to all rows, then to all columns, and so on.
    fn along_all(&self, values: &mut Vec<f32>, work: impl Fn(&mut [f32]) + Sync) {
        let mut stride = 1;
        for k in 0..D {
            let n = self.counts[k];
            if stride == 1 {
                values.par_chunks_mut(n).for_each(&work);
            } else {
                let source = &*values;
                let line = |index: usize| {
                    let start = index / stride * stride * n + index % stride;
                    let mut line: Vec<f32> = (0..n).map(|i| source[start + i * stride]).collect();
                    work(&mut line);
                    line
                };
                // Some lines at a time, so that only they are held twice.
                let mut next = vec![0.0; source.len()];
                let all = source.len() / n;
                for first in (0..all).step_by(LINES) {
                    let lines: Vec<Vec<f32>> = (first..(first + LINES).min(all)).into_par_iter().map(line).collect();
                    for (index, line) in (first..).zip(lines) {
                        let start = index / stride * stride * n + index % stride;
                        line.into_iter().enumerate().for_each(|(i, v)| next[start + i * stride] = v);
                    }
                }
                *values = next;
            }
            stride *= n;
        }
    }
}

/// Lines of cells that are held twice at a time.
const LINES: usize = 256;

/// Least of `f(q) + (p - q)^2` over all `q`, for every `p`.
fn lower_envelope(f: &[f32]) -> Vec<f32> {
    let mut hull: Vec<(usize, f64)> = Vec::with_capacity(f.len());
    let value = |q: usize| f64::from(f[q]) + (q * q) as f64;
    for q in (0..f.len()).filter(|&q| f[q] < FAR) {
        let mut from = f64::NEG_INFINITY;
        while let Some(&(last, start)) = hull.last() {
            from = (value(q) - value(last)) / (2.0 * (q - last) as f64);
            if from > start {
                break;
            }
            hull.pop();
            from = f64::NEG_INFINITY;
        }
        hull.push((q, from));
    }
    let mut k = 0;
    let at = |p: usize| {
        while k + 1 < hull.len() && hull[k + 1].1 <= p as f64 {
            k += 1;
        }
        hull.get(k).map_or(FAR, |&(q, _)| (f64::from(f[q]) + (p as f64 - q as f64).powi(2)) as f32)
    };
    (0..f.len()).map(at).collect()
}

/// Mean over `width` cells around each, nothing beyond the ends.
fn box_mean(line: &mut [f32], width: usize) {
    let half = width / 2;
    let mut sums = Vec::with_capacity(line.len() + 1);
    sums.push(0.0_f64);
    for &v in &*line {
        sums.push(sums[sums.len() - 1] + f64::from(v));
    }
    for k in 0..line.len() {
        let (low, high) = (k.saturating_sub(half), (k + half + 1).min(line.len()));
        line[k] = ((sums[high] - sums[low]) / width as f64) as f32;
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Domain, Exemplar};

    use super::*;

    fn scene_of(points: &[Vector<2>], side: f64) -> Exemplar<2> {
        let mut exemplar = Exemplar::from_points("t", points, &vec![0; points.len()], &["a".into()]).unwrap();
        exemplar.window = Bounds::new(Vector::ZERO, Vector::splat(side));
        exemplar
    }

    #[test]
    fn distances_are_those_to_the_nearest_ink() {
        let points = [Vector::xy(2.25, 7.25), Vector::xy(8.25, 1.25), Vector::xy(5.25, 5.25)];
        let exemplar = scene_of(&points, 10.0);
        let scene = Scene::new(&exemplar, Domain::Box(exemplar.window), 10.0, &Budget::default()).unwrap();
        let raster = Raster::of(&scene, 0.5, &Budget::default()).unwrap();
        let distances = raster.distances(&Budget::default()).unwrap();
        for (index, &d) in distances.iter().enumerate() {
            let p = raster.middle(index);
            let nearest = points.iter().map(|&q| (p - q).norm()).fold(f64::INFINITY, f64::min);
            assert!((f64::from(d) - nearest).abs() < 1e-3, "{p:?}: {d} and {nearest}");
        }
    }

    #[test]
    fn outlines_and_strokes_cover_what_they_fill() {
        let mut exemplar = scene_of(&[Vector::xy(5.0, 5.0), Vector::xy(1.0, 1.0)], 10.0);
        let square = [(3.0, 3.0), (7.0, 3.0), (7.0, 7.0), (3.0, 7.0)].map(|(x, y)| Vector::xy(x, y));
        let hole = [(4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0)].map(|(x, y)| Vector::xy(x, y));
        exemplar.elements[0].outline = Outline { rings: vec![square.to_vec(), hole.to_vec()] };
        let scene = Scene::new(&exemplar, Domain::Box(exemplar.window), 4.0, &Budget::default()).unwrap();
        let mut raster = Raster::of(&scene, 0.1, &Budget::default()).unwrap();
        let share = |raster: &Raster<2>| raster.ink.iter().filter(|i| **i).count() as f64 * 0.01;
        assert!((share(&raster) - 12.0).abs() < 0.1, "{}", share(&raster));
        raster.stroke((Vector::xy(0.0, 9.0), Vector::xy(10.0, 9.0)), 0.2);
        assert!((share(&raster) - 16.0).abs() < 0.2, "{}", share(&raster));
    }

    #[test]
    fn the_bell_keeps_a_constant_and_spreads_a_dot() {
        let exemplar = scene_of(&[Vector::xy(5.05, 5.05), Vector::xy(1.0, 2.0)], 10.0);
        let scene = Scene::new(&exemplar, Domain::Box(exemplar.window), 1.0, &Budget::default()).unwrap();
        let mut raster = Raster::of(&scene, 0.1, &Budget::default()).unwrap();
        raster.ink.fill(false);
        raster.dot(Vector::xy(5.05, 5.05), true);
        let all = vec![true; raster.ink.len()];
        let dot = raster.smoothed(1.0, &all, &Budget::default()).unwrap();
        let variance: f64 =
            (0..dot.len()).map(|k| f64::from(dot[k]) * (raster.middle(k)[0] - 5.05).powi(2)).sum::<f64>();
        assert!((variance - 1.0).abs() < 0.12, "{variance}");
        raster.ink.fill(true);
        let flat = raster.smoothed(1.0, &all, &Budget::default()).unwrap();
        assert!(flat.iter().all(|v| (v - 1.0).abs() < 1e-3));
    }
}
