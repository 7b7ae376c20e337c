//! From what is seen to colours: light, its mean over the samples of a pixel, and the shares that a screen is given.

use super::{
    frame::Sample,
    palette::{lights, to_screen},
};

/// Directions towards the lights, as the picture has them, and how strong they are.
const KEY: ([f32; 3], [f32; 3]) = ([-0.48, 0.62, 0.62], [0.90, 0.85, 0.78]);
const FILL: ([f32; 3], [f32; 3]) = ([0.55, -0.48, 0.68], [0.14, 0.15, 0.18]);
/// Light from all around, above and below.
const SKY: [f32; 3] = [0.30, 0.33, 0.38];
const GROUND: [f32; 3] = [0.19, 0.175, 0.16];
/// How far light reaches around what it falls on.
const WRAP: f32 = 0.05;
/// How strong and how narrow the gleam is.
const GLEAM: f32 = 0.10;
const NARROW: i32 = 28;
/// How much of the light of the lamps a hollow keeps away, beside all of that from all around.
const SHADE: f32 = 0.62;
/// What is seen from behind, relative to its front.
const BEHIND: [f32; 3] = [0.66, 0.71, 0.80];
/// How pale what is farthest off becomes.
const HAZE: f32 = 0.10;

/// Light and how the picture is laid out in depth.
pub(super) struct Lamp {
    lights: [f32; 256],
    /// The share of a screen for steps of light.
    screen: Vec<u8>,
    /// Which way is up in space, as the picture has it.
    up: [f32; 3],
    /// Towards the two lights.
    towards: [[f32; 3]; 2],
    /// Half the way between the stronger light and the eye.
    half: [f32; 3],
    /// Farthest and nearest.
    depths: [f32; 2],
}

/// Steps of light.
const STEPS: usize = 4096;

impl Lamp {
    pub(super) fn new(up: [f32; 3], depths: [f32; 2]) -> Self {
        let [x, y, z] = KEY.0;
        let step = |k: usize| (to_screen(k as f64 / (STEPS - 1) as f64) * 255.0).round() as u8;
        let (towards, half) = ([unit(KEY.0), unit(FILL.0)], unit([x, y, z + 1.0]));
        Self { lights: lights(), screen: (0..STEPS).map(step).collect(), up, towards, half, depths }
    }

    /// Light from what is seen; `open` is how much of the space around it is free.
    pub(super) fn of(&self, sample: &Sample, open: f32) -> [f32; 3] {
        let n = sample.direction();
        let mut base = sample.colour.map(|byte| self.lights[byte as usize]);
        if sample.behind {
            base = std::array::from_fn(|k| base[k] * BEHIND[k]);
        }
        let lamp = |towards: [f32; 3], strength: [f32; 3]| {
            let falls = ((dot(n, towards) + WRAP) / (1.0 + WRAP)).max(0.0);
            strength.map(|s| s * falls)
        };
        let (key, fill) = (lamp(self.towards[0], KEY.1), lamp(self.towards[1], FILL.1));
        let above = dot(n, self.up) * 0.5 + 0.5;
        let shaded = 1.0 - SHADE * (1.0 - open);
        let gleam = GLEAM * dot(n, self.half).max(0.0).powi(NARROW) * shaded;
        let [far, near] = self.depths;
        let back = if near > far { ((near - sample.depth) / (near - far)).clamp(0.0, 1.0) } else { 0.0 };
        std::array::from_fn(|k| {
            let around = (GROUND[k] + (SKY[k] - GROUND[k]) * above) * open;
            let light = base[k] * (around + (key[k] + fill[k]) * shaded) + gleam;
            soft(light) * (1.0 - HAZE * back) + HAZE * back
        })
    }

    /// The pixel of the samples in it: their mean, with the share of those that are something as alpha.
    pub(super) fn pixel(&self, samples: &[Sample], open: f32) -> [u8; 4] {
        let mut sum = [0.0_f32; 3];
        let mut count = 0_u8;
        for sample in samples.iter().filter(|s| s.is_something()) {
            let light = self.of(sample, open);
            (0..3).for_each(|k| sum[k] += light[k]);
            count += 1;
        }
        if count == 0 {
            return [0; 4];
        }
        let [r, g, b] = sum.map(|light| self.to_byte(light / f32::from(count)));
        [r, g, b, (255.0 * f32::from(count) / samples.len() as f32).round() as u8]
    }

    /// A pixel on white.
    pub(super) fn on_white(&self, [r, g, b, alpha]: [u8; 4]) -> [u8; 4] {
        let share = f32::from(alpha) / 255.0;
        let [r, g, b] = [r, g, b].map(|byte| self.to_byte(self.lights[byte as usize] * share + 1.0 - share));
        [r, g, b, 255]
    }

    fn to_byte(&self, light: f32) -> u8 {
        self.screen[(light.clamp(0.0, 1.0) * (STEPS - 1) as f32).round() as usize]
    }
}

/// Light that comes near to the most a screen has without being cut off there.
fn soft(light: f32) -> f32 {
    const KNEE: f32 = 0.75;
    if light <= KNEE { light } else { KNEE + (1.0 - KNEE) * (1.0 - (-(light - KNEE) / (1.0 - KNEE)).exp()) }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp() -> Lamp {
        Lamp::new([0.0, 1.0, 0.0], [0.0, 0.0])
    }

    fn bright(normal: [f32; 3], open: f32) -> f32 {
        lamp().of(&Sample::new(0.0, normal, [200; 3]), open).iter().sum()
    }

    #[test]
    fn light_comes_from_the_upper_left_and_hollows_are_dark() {
        let [left, right] = [[-0.6, 0.5, 0.62], [0.6, -0.5, 0.62]];
        assert!(bright(left, 1.0) > 1.5 * bright(right, 1.0));
        assert!(bright(left, 1.0) > 1.3 * bright(left, 0.3));
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples_and_as_opaque_as_they_are_many() {
        let lamp = lamp();
        let [something, nothing] = [0.0, f32::NEG_INFINITY].map(|d| Sample::new(d, [0.0, 0.0, 1.0], [90; 3]));
        let half = lamp.pixel(&[something, something, nothing, nothing], 1.0);
        assert_eq!((half[3], half[..3].to_vec()), (128, lamp.pixel(&[something; 4], 1.0)[..3].to_vec()));
        assert_eq!(lamp.pixel(&[nothing; 4], 1.0), [0; 4]);
        assert_eq!(lamp.on_white([0; 4]), [255; 4]);
        assert_eq!(lamp.on_white([9, 8, 7, 255]), [9, 8, 7, 255]);
    }

    #[test]
    fn what_is_far_off_is_pale() {
        let lamp = Lamp::new([0.0, 1.0, 0.0], [0.0, 100.0]);
        let at = |depth: f32| lamp.of(&Sample::new(depth, [0.0, 0.0, 1.0], [20; 3]), 1.0)[0];
        assert!(at(0.0) > at(100.0) + 0.05);
    }
}
