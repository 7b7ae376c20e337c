//! Points in samples, as balls.
//!
//! A point with a direction is a point of a surface: its ball touches the surface from behind, and is lit mostly as the surface is, so
//! that many of them look like it, a little rough. Seen from behind they are darker.

use arabesque_core::{Budget, Meter, Result};
use rayon::prelude::*;

use super::frame::{Band, Frame, Reach, Sample};

/// Work of one point, and of one sample of its square.
const PER_POINT: u64 = 40;
const PER_SAMPLE: u64 = 5;

/// Points of a batch.
const BATCH: usize = 1 << 16;
/// Points that are passed over together.
const RUN: usize = 64;

/// How round the balls of a surface look.
const ROUND: f32 = 0.3;
/// How far the back of a surface stands out, relative to a ball.
const FLAT: f64 = 0.2;

/// A point as it is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dab {
    /// Column, row and nearness, in samples.
    pub(super) place: [f64; 3],
    pub(super) radius: f64,
    /// The direction of the surface there, as the picture has it, where there is one.
    pub(super) normal: Option<[f32; 3]>,
    pub(super) colour: [u8; 3],
}

/// Draws `count` points, in their order: a batch at a time, the bands of the picture at the same time.
///
/// # Errors
/// [`arabesque_core::Error::Limit`] when the work or the memory is used up, [`arabesque_core::Error::Stopped`].
pub(super) fn draw(count: usize, dab: impl Fn(usize) -> Dab + Sync, frame: &mut Frame, budget: &Budget) -> Result<()> {
    let (mut dabs, _held) = budget.list("points as they are seen", count.min(BATCH))?;
    for first in (0..count).step_by(BATCH) {
        let end = (first + BATCH).min(count);
        budget.spend(PER_POINT * (end - first) as u64)?;
        (first..end).into_par_iter().map(&dab).collect_into_vec(&mut dabs);
        let reaches: Vec<Reach> = dabs.chunks(RUN).map(reach).collect();
        frame.bands().into_par_iter().try_for_each(|mut band| {
            let mut meter = budget.meter();
            dabs.chunks(RUN).zip(&reaches).try_for_each(|(run, reach)| {
                if band.rows(reach.from, reach.to).is_empty() {
                    return Ok(());
                }
                run.iter().try_for_each(|dab| dab.draw(&mut band, &mut meter))
            })
        })?;
        budget.spend(0)?;
    }
    Ok(())
}

/// The rows of some points.
fn reach(dabs: &[Dab]) -> Reach {
    dabs.iter().fold(Reach::NONE, |reach, dab| {
        let [_, y, _] = dab.ball();
        reach.joined(y - dab.radius, y + dab.radius)
    })
}

impl Dab {
    /// Draws what lies in a band.
    fn draw(&self, band: &mut Band<'_>, meter: &mut Meter<'_>) -> Result<()> {
        let ball = self.ball();
        let ([cx, cy, _], r) = (ball, self.radius);
        let columns = Frame::span(cx - r, cx + r, band.width);
        for y in band.rows(cy - r, cy + r) {
            meter.spend(PER_SAMPLE * columns.len() as u64)?;
            for x in columns.clone() {
                let [dx, dy] = [(x as f64 + 0.5 - cx) / r, (cy - (y as f64 + 0.5)) / r];
                if let Some(sample) = self.at(ball, dx, dy) {
                    band.put(x, y, sample);
                }
            }
        }
        Ok(())
    }

    /// Middle of the ball that is drawn: where there is a direction, of one that touches the surface from behind. The back of a surface
    /// stays where it is, so that it does not come through the front of something thin.
    fn ball(&self) -> [f64; 3] {
        let [nx, ny, nz] = self.normal.unwrap_or([0.0; 3]).map(f64::from);
        let ([x, y, z], r) = (self.place, self.radius);
        [x - r * nx, y + r * ny, z - r * nz.max(0.0)]
    }

    fn is_behind(&self) -> bool {
        self.normal.is_some_and(|n| n[2] < 0.0)
    }

    /// What is seen of its ball at an offset right and up, in radii.
    fn at(&self, ball: [f64; 3], dx: f64, dy: f64) -> Option<Sample> {
        let square = 1.0 - dx * dx - dy * dy;
        if square < 0.0 {
            return None;
        }
        let height = square.sqrt();
        let flat = if self.is_behind() { FLAT } else { 1.0 };
        let depth = (ball[2] + flat * height * self.radius) as f32;
        let round = [dx, dy, height].map(|c| c as f32);
        let Some(normal) = self.normal else { return Some(Sample::new(depth, round, self.colour)) };
        if self.is_behind() {
            return Some(Sample::from_behind(depth, round, self.colour));
        }
        let mixed = std::array::from_fn(|k| ROUND * round[k] + (1.0 - ROUND) * normal[k]);
        Some(Sample::new(depth, mixed, self.colour))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(normal: Option<[f32; 3]>) -> Frame {
        let mut frame = Frame::empty([10, 10], &Budget::default()).unwrap();
        let dab = Dab { place: [10.0, 10.0, 1.0], radius: 8.0, normal, colour: [9; 3] };
        draw(1, |_| dab, &mut frame, &Budget::default()).unwrap();
        frame
    }

    #[test]
    fn a_ball_is_round_and_nearest_in_its_middle() {
        let frame = seen(None);
        let covered = frame.samples.iter().filter(|s| s.is_something()).count() as f64;
        assert!((covered - std::f64::consts::PI * 64.0).abs() < 12.0, "{covered}");
        let at = |x: usize, y: usize| frame.samples[y * frame.width + x];
        assert!(at(10, 10).depth > 8.9 && at(10, 10).direction()[2] > 0.98);
        // To the right it faces right, above it faces up.
        assert!(at(16, 10).direction()[0] > 0.7 && at(10, 3).direction()[1] > 0.7);
    }

    #[test]
    fn a_ball_of_a_surface_touches_it_from_behind() {
        let facing = seen(Some([0.0, 0.0, 1.0]));
        let middle = facing.samples[10 * facing.width + 10];
        assert!((middle.depth - 1.0).abs() < 0.1 && !middle.behind, "{middle:?}");
        let aside = seen(Some([1.0, 0.0, 0.0]));
        let row = &aside.samples[10 * aside.width..11 * aside.width];
        assert!(row[9].is_something() && !row[11].is_something());
        let behind = seen(Some([0.0, 0.0, -1.0]));
        let middle = behind.samples[10 * behind.width + 10];
        assert!(middle.behind && (middle.depth - 2.6).abs() < 0.1, "{middle:?}");
    }
}
