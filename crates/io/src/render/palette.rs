//! Colours of what has none of its own.

use std::f64::consts::TAU;

/// Everything that is one thing.
pub(super) const CLAY: [u8; 3] = [222, 204, 182];

/// Part of a turn from one number to the next: any few of them in a row are far apart.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Where the turn begins.
const FIRST: f64 = 0.63;

/// The colour of a group or an element: quiet, about equally light, and far from those of the numbers near it.
pub(super) fn of_number(number: i32) -> [u8; 3] {
    let hue = (FIRST + GOLDEN * f64::from(number)).rem_euclid(1.0);
    // Every third one is darker, and every third one lighter.
    let lightness = [0.68, 0.58, 0.77][number.rem_euclid(3) as usize];
    oklch(lightness, 0.125, hue)
}

/// Lightness, chroma and hue of equal steps to the eye (OKLab), as sRGB; hue in turns.
fn oklch(lightness: f64, chroma: f64, hue: f64) -> [u8; 3] {
    let (a, b) = (chroma * (TAU * hue).cos(), chroma * (TAU * hue).sin());
    let [l, m, s] = [
        lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b,
        lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b,
        lightness - 0.089_484_177_5 * a - 1.291_485_548 * b,
    ]
    .map(|v| v.powi(3));
    let light = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701 * s,
    ];
    light.map(|v| (to_screen(v.clamp(0.0, 1.0)) * 255.0).round() as u8)
}

/// From light, which adds up, to the share that a screen is given.
pub(super) fn to_screen(light: f64) -> f64 {
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// The light of every byte that a screen is given.
pub(super) fn lights() -> [f32; 256] {
    std::array::from_fn(|byte| {
        let share = byte as f64 / 255.0;
        let light = if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) };
        light as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_look_different() {
        for number in -20..40 {
            let [a, b] = [number, number + 1].map(of_number);
            let apart: i32 = (0..3).map(|k| (i32::from(a[k]) - i32::from(b[k])).abs()).sum();
            assert!(apart > 60, "{number}: {a:?}, {b:?}");
        }
    }

    #[test]
    fn lights_are_those_of_the_screen() {
        let lights = lights();
        assert!((0..256).all(|k| (to_screen(f64::from(lights[k])) * 255.0 - k as f64).abs() < 0.01));
    }
}
