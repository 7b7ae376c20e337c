//! Points in samples, as balls.
//!
//! A point with a direction is a point of a surface: its ball touches the surface from behind, and is lit mostly as the surface is, so
//! that many of them look like it, a little rough. Seen from behind they are darker.

use arabesque_core::{Budget, Result};

use super::frame::{Frame, Sample};

/// Work of one point, and of one sample of its square.
const PER_POINT: u64 = 40;
const PER_SAMPLE: u64 = 5;

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

/// Draws points.
pub(super) fn draw(dabs: impl Iterator<Item = Dab>, frame: &mut Frame, budget: &Budget) -> Result<()> {
    let mut meter = budget.meter();
    for dab in dabs {
        meter.spend(PER_POINT)?;
        let ball = dab.ball();
        let ([cx, cy, _], r) = (ball, dab.radius);
        let columns = Frame::span(cx - r, cx + r, frame.width);
        for y in Frame::span(cy - r, cy + r, frame.height) {
            meter.spend(PER_SAMPLE * columns.len() as u64)?;
            for x in columns.clone() {
                let [dx, dy] = [(x as f64 + 0.5 - cx) / r, (cy - (y as f64 + 0.5)) / r];
                if let Some(sample) = dab.at(ball, dx, dy) {
                    frame.put(x, y, sample);
                }
            }
        }
    }
    Ok(())
}

impl Dab {
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
        draw(std::iter::once(dab), &mut frame, &Budget::default()).unwrap();
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
