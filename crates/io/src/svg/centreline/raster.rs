//! Outlines as pixels, and pixels thinned to lines of one pixel.

use arabesque_core::{Bounds, Budget, Outline, Result, Vector};

/// Empty pixels around the ink.
const MARGIN: usize = 2;

/// Work for each pixel in each round of thinning.
const PER_PIXEL: u64 = 20;

/// Most places at which edges pass rows.
const MAX_PASSED: f64 = 3e7;

/// A bitmap laid over an outline.
#[derive(Clone, Debug)]
pub(super) struct Raster {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Lower corner of pixel 0.
    origin: Vector<2>,
    /// Side of a pixel.
    pub(super) step: f64,
    pub(super) ink: Vec<bool>,
}

impl Raster {
    /// The pixels of side `step` whose centres lie in the outline; gaps narrower than half a pixel are closed.
    /// `None` for more than `limit` pixels, and where edges pass too many of their rows.
    pub(super) fn new(outline: &Outline<2>, step: f64, limit: f64) -> Option<Self> {
        let bounds: Bounds<2> = outline.bounds();
        let size = bounds.size().map(|s| (s / step).ceil() + 2.0 * MARGIN as f64);
        if !(size[0] * size[1]).is_finite() || size[0] * size[1] > limit {
            return None;
        }
        let passed: f64 = outline.edges().map(|(a, b)| ((a[1] - b[1]) / step).abs()).sum();
        if passed > MAX_PASSED {
            return None;
        }
        let (width, height) = (size[0] as usize, size[1] as usize);
        let origin = bounds.min - Vector::splat(MARGIN as f64 * step);
        let mut raster = Self { width, height, origin, step, ink: vec![false; width * height] };
        // Two lines of sight a row close seams that run along the rows.
        for share in [0.3, 0.7] {
            raster.scan(outline, share);
        }
        Some(raster)
    }

    fn scan(&mut self, outline: &Outline<2>, share: f64) {
        let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); self.height];
        for (a, b) in outline.edges() {
            let row_of = |y: f64| (y - self.origin[1]) / self.step - share;
            let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
            let first = row_of(low[1]).ceil().max(0.0) as usize;
            for (row, xs) in crossings.iter_mut().enumerate().skip(first) {
                let y = self.origin[1] + (row as f64 + share) * self.step;
                if y >= high[1] {
                    break;
                }
                if y >= low[1] {
                    xs.push(low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]));
                }
            }
        }
        for (row, xs) in crossings.iter_mut().enumerate() {
            xs.sort_by(f64::total_cmp);
            self.fill(row, xs);
        }
    }

    fn fill(&mut self, row: usize, xs: &[f64]) {
        let mut last_end = f64::NEG_INFINITY;
        for pair in xs.chunks_exact(2) {
            let from = if pair[0] - last_end < 0.5 * self.step { last_end } else { pair[0] };
            let column = |x: f64| (((x - self.origin[0]) / self.step - 0.5).ceil().max(0.0) as usize).min(self.width);
            let (start, end) = (column(from), column(pair[1]));
            if start < end {
                self.ink[row * self.width + start..row * self.width + end].fill(true);
            }
            last_end = pair[1];
        }
    }

    /// Centre of a pixel.
    pub(super) fn centre(&self, pixel: usize) -> Vector<2> {
        let (x, y) = (pixel % self.width, pixel / self.width);
        self.origin + Vector::xy(x as f64 + 0.5, y as f64 + 0.5) * self.step
    }

    /// The eight pixels around an inner pixel, turning from east by way of north-east.
    pub(super) fn around(&self, pixel: usize) -> [usize; 8] {
        let w = self.width;
        [pixel + 1, pixel + 1 + w, pixel + w, pixel + w - 1, pixel - 1, pixel - 1 - w, pixel - w, pixel + 1 - w]
    }

    /// The ink pixels, row by row.
    pub(super) fn pixels(&self) -> Vec<usize> {
        (0..self.ink.len()).filter(|&p| self.ink[p]).collect()
    }

    /// The ink among the eight pixels around.
    pub(super) fn neighbours(&self, pixel: usize) -> impl Iterator<Item = usize> + '_ {
        self.around(pixel).into_iter().filter(|&p| self.ink[p])
    }

    /// Marks off what lies within `radius` of `at`.
    pub(super) fn erase_disc(&mut self, at: Vector<2>, radius: f64) {
        for pixel in self.disc(at, radius) {
            self.ink[pixel] = false;
        }
    }

    /// Numbers of blank and of all pixels within `radius` of `at`.
    pub(super) fn blank_in_disc(&self, at: Vector<2>, radius: f64) -> (usize, usize) {
        let disc = self.disc(at, radius);
        (disc.iter().filter(|&&pixel| !self.ink[pixel]).count(), disc.len())
    }

    fn disc(&self, at: Vector<2>, radius: f64) -> Vec<usize> {
        let low = (at - Vector::splat(radius) - self.origin).map(|c| (c / self.step).floor().max(0.0));
        let high = (at + Vector::splat(radius) - self.origin).map(|c| (c / self.step).ceil().max(0.0));
        let rows = low[1] as usize..(high[1] as usize).min(self.height);
        let columns = low[0] as usize..(high[0] as usize).min(self.width);
        rows.flat_map(|y| columns.clone().map(move |x| y * self.width + x))
            .filter(|&pixel| (self.centre(pixel) - at).norm2() <= radius * radius)
            .collect()
    }

    /// Thins the ink to lines of one pixel with the same connections: Zhang and Suen's parallel thinning, then single
    /// redundant pixels.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub(super) fn thin(&mut self, budget: &Budget) -> Result<()> {
        let mut active = self.pixels();
        // Every round takes a layer off, so the rounds are bounded by the size of the picture.
        for _ in 0..self.width.max(self.height) {
            let before = active.len();
            budget.spend(PER_PIXEL * before as u64)?;
            for first in [true, false] {
                let gone: Vec<usize> = active.iter().copied().filter(|&p| self.is_rim(p, first)).collect();
                gone.iter().for_each(|&p| self.ink[p] = false);
                active.retain(|&p| self.ink[p]);
            }
            if active.len() == before {
                break;
            }
        }
        for p in active {
            // Two groups of neighbours: never the end of a line, which would be eaten up from there.
            if self.groups(p) == 2 && self.is_redundant(p) {
                self.ink[p] = false;
            }
        }
        Ok(())
    }

    /// Whether a sub-step of the parallel thinning takes a pixel away.
    fn is_rim(&self, pixel: usize, first: bool) -> bool {
        let n = self.around(pixel).map(|p| self.ink[p]);
        let count = n.iter().filter(|&&b| b).count();
        let [east, _, north, _, west, _, south, _] = n;
        let open = if first { !east || !south || (!north && !west) } else { !north || !west || (!east && !south) };
        // Pixels with two neighbours stay: slanting lines two pixels wide would vanish.
        (3..=6).contains(&count) && self.groups(pixel) == 1 && open
    }

    /// Runs of ink in the ring of eight pixels.
    fn groups(&self, pixel: usize) -> usize {
        let n = self.around(pixel).map(|p| self.ink[p]);
        (0..8).filter(|&k| !n[k] && n[(k + 1) % 8]).count()
    }

    /// Whether taking a pixel away leaves all connections among its neighbours (the connectivity number of eight
    /// neighbours is one).
    fn is_redundant(&self, pixel: usize) -> bool {
        let empty = self.around(pixel).map(|p| !self.ink[p]);
        let number = (0..8).step_by(2).filter(|&k| empty[k] && !(empty[(k + 1) % 8] && empty[(k + 2) % 8])).count();
        number == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(length: f64) -> Outline<2> {
        let corners = [(0.0, 0.0), (length, 0.0), (length, 1.0), (0.0, 1.0)];
        Outline { rings: vec![corners.map(|(x, y)| Vector::xy(x, y)).to_vec()] }
    }

    #[test]
    fn a_bar_thins_to_a_line_of_pixels() {
        let mut raster = Raster::new(&bar(10.0), 0.125, 1e6).unwrap();
        raster.thin(&Budget::default()).unwrap();
        let pixels = raster.pixels();
        assert!(pixels.iter().all(|&p| (raster.centre(p)[1] - 0.5).abs() < 0.15));
        assert_eq!(pixels.iter().filter(|&&p| raster.neighbours(p).count() == 1).count(), 2);
        assert!(pixels.iter().all(|&p| raster.neighbours(p).count() <= 2));
    }

    #[test]
    fn slanting_bars_keep_their_length() {
        for degrees in (0..180).step_by(5) {
            let turn = arabesque_core::Matrix::<2>::rotation(f64::from(degrees).to_radians());
            for step in [0.11, 0.2, 0.43, 0.6] {
                let turned = Outline { rings: vec![bar(10.0).rings[0].iter().map(|&p| turn.apply(p)).collect()] };
                let mut raster = Raster::new(&turned, step, 1e6).unwrap();
                raster.thin(&Budget::default()).unwrap();
                let line: Vec<_> = raster.pixels().into_iter().map(|p| raster.centre(p)).collect();
                let extent = arabesque_core::Bounds::around(line).size().norm();
                assert!(extent > 7.5, "{degrees} degrees, pixels of {step}: {extent}");
            }
        }
    }

    #[test]
    fn too_many_pixels_are_refused() {
        assert!(Raster::new(&bar(10.0), 0.001, 1e6).is_none());
        assert!(Raster::new(&bar(f64::INFINITY), 0.1, 1e6).is_none());
    }
}
