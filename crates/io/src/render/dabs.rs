//! Points in samples: balls, and discs that lie across a direction.

use arabesque_core::{Budget, Result};

use super::frame::{Frame, Sample};

/// Work of one point, and of one sample of its square.
const PER_POINT: u64 = 40;
const PER_SAMPLE: u64 = 5;

/// A point as it is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dab {
    /// Column, row and nearness, in samples.
    pub(super) place: [f64; 3],
    pub(super) radius: f64,
    /// The direction across which a disc lies, as the picture has it; a ball where there is none.
    pub(super) normal: Option<[f32; 3]>,
    pub(super) colour: [u8; 3],
}

/// Draws balls and discs.
pub(super) fn draw(dabs: impl Iterator<Item = Dab>, frame: &mut Frame, budget: &Budget) -> Result<()> {
    let mut meter = budget.meter();
    for dab in dabs {
        meter.spend(PER_POINT)?;
        let ([cx, cy, _], r) = (dab.place, dab.radius);
        let columns = Frame::span(cx - r, cx + r, frame.width);
        for y in Frame::span(cy - r, cy + r, frame.height) {
            meter.spend(PER_SAMPLE * columns.len() as u64)?;
            for x in columns.clone() {
                let [dx, dy] = [(x as f64 + 0.5 - cx) / r, (cy - (y as f64 + 0.5)) / r];
                if let Some(sample) = dab.at(dx, dy) {
                    frame.put(x, y, sample);
                }
            }
        }
    }
    Ok(())
}

impl Dab {
    /// What is seen of it at an offset right and up, in radii.
    fn at(&self, dx: f64, dy: f64) -> Option<Sample> {
        let depth = |height: f64| (self.place[2] + height * self.radius) as f32;
        let Some(normal) = self.normal else {
            let height = (1.0 - dx * dx - dy * dy).max(0.0).sqrt();
            return (dx * dx + dy * dy <= 1.0)
                .then(|| Sample::new(depth(height), [dx as f32, dy as f32, height as f32], self.colour));
        };
        let [nx, ny, nz] = normal.map(f64::from);
        // Of what is seen edge-on, a line is left.
        let across = nz.abs().max(0.05) * nz.signum();
        let height = -(nx * dx + ny * dy) / across;
        (dx * dx + dy * dy + height * height <= 1.0).then(|| Sample::new(depth(height), normal, self.colour))
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
    fn a_disc_seen_at_a_slant_is_narrow() {
        let slant = seen(Some([0.8, 0.0, 0.6]));
        let width = slant.samples[10 * slant.width..11 * slant.width].iter().filter(|s| s.is_something()).count();
        assert!((9..=10).contains(&width), "{width}");
        // Its right side is farther off.
        let row = &slant.samples[10 * slant.width..];
        assert!(row[7].depth > row[12].depth);
        assert!(seen(Some([0.0, 0.0, -1.0])).samples.iter().any(|s| s.behind));
    }
}
