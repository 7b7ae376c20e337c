//! Shares of colours as screens have them, and as light adds up.

/// From light to the share that a screen is given.
pub(crate) fn srgb(light: f64) -> f64 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 { light * 12.92 } else { (1.055 * (light.powf(1.0 / 2.4) - 1.0) + 1.0).min(1.0) }
}

/// From the share that a screen is given to light.
pub(crate) fn linear(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_undoes_the_other() {
        for k in 0..=255 {
            let share = f64::from(k) / 255.0;
            assert!((srgb(linear(share)) - share).abs() < 1e-6);
        }
        assert!((linear(0.5) - 0.214).abs() < 1e-3);
    }
}
