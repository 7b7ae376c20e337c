//! How much of the space around what is seen other things fill.
//!
//! Around each place some places are looked at, on a spiral in the picture; each that is nearer to the eye takes away light by how far
//! it stands above the surface there, and the less the farther off it is. Neighbouring places look in other directions, and
//! the mean over a small square of them evens that out. Two reaches are looked at: what touches, and what forms hollows.

use arabesque_core::{Budget, Held, Result};
use rayon::prelude::*;

use super::frame::{FINE, Frame};

/// Looks from one place, for each reach.
const LOOKS: usize = 14;
/// Work of one look.
const PER_LOOK: u64 = 4;
/// Side of the square of directions.
const SQUARE: usize = 4;
/// Angle from one look to the next.
const GOLDEN_ANGLE: f32 = 2.399_963_2;
/// Cosines above the surface that count for nothing, so that flat things stay light.
const FLAT: f32 = 0.12;

/// How strongly filled space takes light away.
const STRENGTH: f32 = 3.0;
/// Least weight of what is seen far in front.
const RIM: f32 = 0.12;

/// What is seen in each pixel.
struct Coarse {
    width: usize,
    height: usize,
    places: Vec<Place>,
    _held: Held,
}

/// What is seen in one: its nearness in pixels, and its direction.
#[derive(Clone, Copy)]
struct Place {
    depth: f32,
    normal: [f32; 3],
}

/// How much light comes to each pixel, from 0 to 1, with what is looked at up to each of the `reaches`, in pixels.
pub(super) fn openness(frame: &Frame, reaches: [f32; 2], budget: &Budget) -> Result<Vec<f32>> {
    let coarse = Coarse::new(frame, budget)?;
    let (width, pixels) = (coarse.width, coarse.places.len());
    let (mut light, _held) = budget.list("light of the picture", pixels.saturating_mul(2))?;
    light.resize(pixels, 1.0_f32);
    let mut raw = vec![0.0; pixels];
    for reach in reaches {
        let spirals = spirals(reach);
        raw.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
            budget.spend(PER_LOOK * (LOOKS * width) as u64)?;
            for (x, hidden) in row.iter_mut().enumerate() {
                let number = ((x % SQUARE) * SQUARE + (y % SQUARE) * 7) % spirals.len();
                *hidden = coarse.hidden([x, y], &spirals[number], reach);
            }
            Ok(())
        })?;
        light.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
            budget.spend(PER_LOOK * (SQUARE * SQUARE * width) as u64)?;
            for (x, light) in row.iter_mut().enumerate() {
                if coarse.places[y * width + x].depth > f32::NEG_INFINITY {
                    *light *= 1.0 - coarse.even(&raw, x, y, reach).min(1.0);
                }
            }
            Ok(())
        })?;
        budget.spend(0)?;
    }
    Ok(light)
}

/// Where to look from a place, right and up, for each place of a square.
fn spirals(reach: f32) -> [[[i32; 2]; LOOKS]; SQUARE * SQUARE] {
    std::array::from_fn(|number| {
        let turn = number as f32 * (std::f32::consts::TAU / (SQUARE * SQUARE) as f32);
        std::array::from_fn(|look| {
            let far = reach * ((look as f32 + 0.5) / LOOKS as f32).sqrt();
            let (sin, cos) = (turn + GOLDEN_ANGLE * look as f32).sin_cos();
            [far * cos, far * sin].map(|v| v.round() as i32)
        })
    })
}

impl Coarse {
    fn new(frame: &Frame, budget: &Budget) -> Result<Self> {
        let [width, height] = [frame.width / FINE, frame.height / FINE];
        let nothing = Place { depth: f32::NEG_INFINITY, normal: [0.0; 3] };
        let (mut places, held) = budget.list("places of the picture", width.saturating_mul(height))?;
        places.resize(width * height, nothing);
        places.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
            budget.spend(PER_LOOK * frame.width as u64)?;
            for (x, place) in row.iter_mut().enumerate() {
                let samples = frame.of_pixel(x, y);
                let nearest = samples.into_iter().fold(samples[0], |a, b| if b.depth > a.depth { b } else { a });
                *place = Place { depth: nearest.depth / FINE as f32, normal: nearest.direction() };
            }
            Ok(())
        })?;
        budget.spend(0)?;
        Ok(Self { width, height, places, _held: held })
    }

    /// The share of the space around a place that is filled.
    fn hidden(&self, [x, y]: [usize; 2], looks: &[[i32; 2]; LOOKS], reach: f32) -> f32 {
        let at = y * self.width + x;
        let Place { depth, normal: n } = self.places[at];
        if depth == f32::NEG_INFINITY {
            return 0.0;
        }
        let mut sum = 0.0;
        for [dx, dy] in looks {
            let (Some(to_x), Some(to_y)) = (x.checked_add_signed(*dx as isize), y.checked_sub_signed(*dy as isize))
            else {
                continue;
            };
            if to_x >= self.width || to_y >= self.height {
                continue;
            }
            let there = self.places[to_y * self.width + to_x].depth;
            if there == f32::NEG_INFINITY {
                continue;
            }
            let v = [*dx as f32, *dy as f32, there - depth];
            let length = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if length == 0.0 {
                continue;
            }
            let above = (v[0] * n[0] + v[1] * n[1] + v[2] * n[2]) / length.sqrt() - FLAT;
            // However far behind something is, a narrow rim around what is in front of it is darker.
            let weight = 1.0 / (1.0 + length / (reach * reach));
            sum += above.max(0.0) * weight.max(RIM);
        }
        STRENGTH * sum / LOOKS as f32
    }

    /// The mean over a square of places that are about as near.
    fn even(&self, raw: &[f32], x: usize, y: usize, reach: f32) -> f32 {
        let depth = self.places[y * self.width + x].depth;
        let (mut sum, mut count) = (0.0, 0.0);
        let side = |at: usize, most: usize| at.saturating_sub(SQUARE / 2)..(at + SQUARE / 2).min(most);
        for j in side(y, self.height) {
            for i in side(x, self.width) {
                let at = j * self.width + i;
                if (self.places[at].depth - depth).abs() < 0.3 * reach {
                    sum += raw[at];
                    count += 1.0;
                }
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::frame::Sample;

    /// A floor, with a step of the given height across its right half.
    fn step(height: f32) -> Vec<f32> {
        let mut frame = Frame::empty([60, 40], &Budget::default()).unwrap();
        for y in 0..frame.height {
            for x in 0..frame.width {
                let depth = if x >= 60 { height } else { 0.0 };
                frame.whole().put(x, y, Sample::new(depth, [0.0, 0.0, 1.0], [0; 3]));
            }
        }
        openness(&frame, [6.0, 12.0], &Budget::default()).unwrap()
    }

    #[test]
    fn flat_things_are_light_and_the_foot_of_a_step_is_dark() {
        assert!(step(0.0).iter().all(|light| *light == 1.0));
        let light = step(24.0);
        let row = &light[20 * 60..21 * 60];
        assert!(row[28] < 0.8, "{row:?}");
        assert!(row[2] > 0.97 && row[31] > 0.97, "{row:?}");
    }

    #[test]
    fn nothing_is_not_dark() {
        let frame = Frame::empty([8, 8], &Budget::default()).unwrap();
        assert!(openness(&frame, [4.0, 8.0], &Budget::default()).unwrap().iter().all(|light| *light == 1.0));
    }
}
