//! What is in front at every place of a picture, four times as finely as it is shown.

use std::ops::Range;

use arabesque_core::{Bounds, Budget, Held, Result, Vector};

use super::view::Axes;

/// Samples along a side of a pixel.
pub(super) const FINE: usize = 2;

/// Bands of a picture: several for each thread of a usual machine, since some have more in them than others.
const BANDS: usize = 32;

/// What is in front at one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Nearness to the eye, in pixels; nothing where it is -infinity.
    pub(super) depth: f32,
    /// Direction as the picture has it, in steps of [`STEPS`]; not always of length 1.
    pub(super) normal: [i16; 3],
    pub(super) colour: [u8; 3],
    /// Whether it is seen from behind.
    pub(super) behind: bool,
}

/// Steps of a length of 1.
const STEPS: f32 = 16_000.0;

impl Sample {
    const NOTHING: Self = Self { depth: f32::NEG_INFINITY, normal: [0; 3], colour: [0; 3], behind: false };

    /// What faces the eye, whichever side it shows.
    pub(super) fn new(depth: f32, normal: [f32; 3], colour: [u8; 3]) -> Self {
        let behind = normal[2] < 0.0;
        let sign = if behind { -STEPS } else { STEPS };
        Self { depth, normal: normal.map(|c| (c * sign) as i16), colour, behind }
    }

    /// The same, of the back of something.
    pub(super) fn from_behind(depth: f32, normal: [f32; 3], colour: [u8; 3]) -> Self {
        Self { behind: true, ..Self::new(depth, normal, colour) }
    }

    pub(super) fn is_something(&self) -> bool {
        self.depth > f32::NEG_INFINITY
    }

    /// The direction at length 1.
    pub(super) fn direction(&self) -> [f32; 3] {
        let n = self.normal.map(f32::from);
        let length = n.iter().map(|c| c * c).sum::<f32>().sqrt();
        if length > 0.0 { n.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
    }
}

/// From space to samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    pub(super) axes: Axes,
    /// Samples per unit.
    pub(super) scale: f64,
    /// What is moved to the middle, right and up; and the depth that counts as 0.
    centre: Vector<3>,
    /// Middle of the picture, in samples.
    middle: [f64; 2],
}

impl Projection {
    /// Fits a box of the picture's directions into so many pixels, with a border.
    pub(super) fn fitted(axes: Axes, seen: &Bounds<3>, size: [usize; 2], border: f64) -> Self {
        let extent = seen.size();
        let room = size.map(|n| (n * FINE) as f64);
        let inner = room.map(|n| (n * (1.0 - 2.0 * border)).max(1.0));
        let scale = (0..2).map(|k| inner[k] / extent[k].max(f64::MIN_POSITIVE)).fold(f64::INFINITY, f64::min);
        // One point fills as much as there is.
        let scale = if scale.is_finite() && extent[0].max(extent[1]) > 0.0 { scale } else { 1.0 };
        Self { axes, scale, centre: seen.centre(), middle: room.map(|n| n / 2.0) }
    }

    /// A point as column, row and nearness, all in samples.
    pub(super) fn place(&self, p: Vector<3>) -> [f64; 3] {
        let v = (self.axes.turned(p) - self.centre) * self.scale;
        [self.middle[0] + v[0], self.middle[1] - v[1], v[2]]
    }
}

/// The samples of a picture.
pub(super) struct Frame {
    /// Samples along a row, and rows.
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) samples: Vec<Sample>,
    _held: Held,
}

impl Frame {
    /// Nothing, in so many pixels.
    pub(super) fn empty(size: [usize; 2], budget: &Budget) -> Result<Self> {
        let [width, height] = size.map(|n| n * FINE);
        let (mut samples, held) = budget.list("samples of the picture", width.saturating_mul(height))?;
        samples.resize(width * height, Sample::NOTHING);
        Ok(Self { width, height, samples, _held: held })
    }

    /// The samples, in bands of rows that can be drawn at the same time. What is drawn in a place is in one band, so that the picture does
    /// not depend on how many there are.
    pub(super) fn bands(&mut self) -> Vec<Band<'_>> {
        let (width, rows) = (self.width, self.height.div_ceil(BANDS).max(1));
        let parts = self.samples.chunks_mut((rows * width).max(1)).enumerate();
        parts.map(|(k, samples)| Band { width, first: k * rows, samples }).collect()
    }

    /// Whether everything within a ball is behind what is there already. Nothing is hidden by what is not drawn yet.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub(super) fn hides(&self, ball: &Ball, budget: &Budget) -> Result<bool> {
        let ([cx, cy, _], near) = (ball.place, ball.near() as f32);
        // A little more than the ball, for the rounding of places.
        let reach = ball.radius + 1.0;
        let mut looked = 1;
        let is_hidden = Self::span(cy - reach, cy + reach, self.height).all(|y| {
            let half = (reach * reach - (y as f64 + 0.5 - cy).powi(2)).max(0.0).sqrt();
            let columns = Self::span(cx - half, cx + half, self.width);
            looked += columns.len() as u64;
            self.samples[y * self.width..][columns].iter().all(|sample| sample.depth > near)
        });
        budget.spend(looked)?;
        Ok(is_hidden)
    }

    /// All samples as one band.
    #[cfg(test)]
    pub(super) fn whole(&mut self) -> Band<'_> {
        Band { width: self.width, first: 0, samples: &mut self.samples }
    }

    /// The samples of a pixel.
    pub(super) fn of_pixel(&self, x: usize, y: usize) -> [Sample; FINE * FINE] {
        std::array::from_fn(|k| self.samples[(FINE * y + k / FINE) * self.width + FINE * x + k % FINE])
    }

    /// The columns, or rows, of `count` whose middles lie between two numbers.
    pub(super) fn span(from: f64, to: f64, count: usize) -> Range<usize> {
        let first = (from - 0.5).ceil().clamp(0.0, count as f64) as usize;
        let end = ((to - 0.5).floor() + 1.0).clamp(0.0, count as f64) as usize;
        first..end.max(first)
    }
}

/// Rows of a picture that one thread draws.
pub(super) struct Band<'a> {
    /// Samples along a row.
    pub(super) width: usize,
    /// The first row.
    first: usize,
    samples: &'a mut [Sample],
}

impl Band<'_> {
    /// The rows whose middles lie between two numbers.
    pub(super) fn rows(&self, from: f64, to: f64) -> Range<usize> {
        let first = self.first as f64;
        let rows = Frame::span(from - first, to - first, self.samples.len() / self.width.max(1));
        rows.start + self.first..rows.end + self.first
    }

    /// Whether nothing is nearer, or as near, at a place.
    pub(super) fn is_free(&self, x: usize, y: usize, depth: f32) -> bool {
        depth > self.samples[(y - self.first) * self.width + x].depth
    }

    /// Puts something in a place where nothing is nearer.
    pub(super) fn put(&mut self, x: usize, y: usize, sample: Sample) {
        if self.is_free(x, y, sample.depth) {
            self.samples[(y - self.first) * self.width + x] = sample;
        }
    }
}

/// The ball around a thing, in samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    /// Which thing it is.
    pub(super) number: usize,
    /// Column, row and nearness of its middle.
    pub(super) place: [f64; 3],
    pub(super) radius: f64,
}

impl Ball {
    /// How near it comes to the eye.
    pub(super) fn near(&self) -> f64 {
        self.place[2] + self.radius + 1.0
    }
}

/// Things that follow one another, and the rows that they reach over together: most bands pass over most of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Reach {
    /// Over no rows.
    pub(super) const NONE: Self = Self { from: f64::INFINITY, to: f64::NEG_INFINITY };

    /// The same with more rows.
    pub(super) fn joined(self, from: f64, to: f64) -> Self {
        Self { from: self.from.min(from), to: self.to.max(to) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::view::View;

    #[test]
    fn what_is_nearer_stays() {
        let mut frame = Frame::empty([1, 1], &Budget::default()).unwrap();
        for (depth, red) in [(1.0, 1), (3.0, 3), (2.0, 2)] {
            frame.whole().put(1, 0, Sample::new(depth, [0.0, 0.0, 1.0], [red, 0, 0]));
        }
        assert_eq!(frame.samples[1].colour, [3, 0, 0]);
        assert!(!frame.samples[0].is_something());
    }

    #[test]
    fn a_box_is_fitted_into_the_middle() {
        let seen = Bounds::new(Vector([1.0, 1.0, 0.0]), Vector([3.0, 2.0, 0.0]));
        let projection = Projection::fitted(Axes::of(View::TOP), &seen, [100, 100], 0.1);
        let [x, y, _] = projection.place(Vector([1.0, 2.0, 0.0]));
        assert!((x - 20.0).abs() < 1e-9 && (y - 60.0).abs() < 1e-9, "{x} {y}");
    }

    #[test]
    fn spans_stay_in_the_picture() {
        assert_eq!(Frame::span(0.4, 2.6, 9), 0..3);
        assert_eq!(Frame::span(-1e300, 1e300, 9), 0..9);
        assert_eq!(Frame::span(f64::NAN, 3.0, 9).len(), 3);
        assert!(Frame::span(5.0, 2.0, 9).is_empty());
    }

    #[test]
    fn what_lies_behind_is_hidden_and_nothing_else() {
        let budget = Budget::default();
        let mut frame = Frame::empty([20, 20], &budget).unwrap();
        let hides = |frame: &Frame, x: f64, depth: f64| {
            frame.hides(&Ball { number: 0, place: [x, 20.0, depth], radius: 5.0 }, &budget).unwrap()
        };
        assert!(!hides(&frame, 20.0, -100.0));
        for at in 0..40 * 30 {
            frame.whole().put(at % 30, at / 30, Sample::new(0.0, [0.0, 0.0, 1.0], [0; 3]));
        }
        assert!(hides(&frame, 20.0, -10.0));
        assert!(!hides(&frame, 20.0, -4.0), "it reaches to the front");
        assert!(!hides(&frame, 26.0, -10.0), "it reaches beyond what is in front");
    }

    #[test]
    fn bands_are_the_rows_of_the_picture() {
        for height in [1, 3, 40, 333] {
            let mut frame = Frame::empty([2, height], &Budget::default()).unwrap();
            let mut next = 0;
            for mut band in frame.bands() {
                let rows = band.rows(f64::NEG_INFINITY, f64::INFINITY);
                assert_eq!(rows.start, next);
                next = rows.end;
                rows.for_each(|y| band.put(3, y, Sample::new(y as f32, [0.0, 0.0, 1.0], [0; 3])));
            }
            assert_eq!(next, frame.height);
            let depths = frame.samples.chunks(frame.width).map(|row| row[3].depth);
            assert!(depths.enumerate().all(|(y, depth)| depth == y as f32), "{height}");
        }
    }

    #[test]
    fn directions_keep_their_bits_and_turn_to_the_eye() {
        let sample = Sample::new(0.0, [0.6, 0.0, -0.8], [0; 3]);
        assert!(sample.behind);
        let [x, _, z] = sample.direction();
        assert!((x + 0.6).abs() < 1e-3 && (z - 0.8).abs() < 1e-3);
    }
}
