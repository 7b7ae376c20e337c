//! The size of pictures that are drawn.

use arabesque_core::{Budget, Error, Limits, Result};

/// Most pixels along one side, which is as far as the renderer counts.
const MAX_SIDE: i16 = i16::MAX;

/// Width and height in whole pixels; `what` is called so in the message, and `advice` says how to get a smaller one.
///
/// # Errors
/// [`Error::Limit`] beyond [`arabesque_core::Limits::pixels`] in all or 32 767 along one side, and for what is not a number.
pub fn checked_size(what: &str, [width, height]: [f64; 2], budget: &Budget, advice: &str) -> Result<[u32; 2]> {
    if width * height <= budget.limits().pixels as f64 && width.max(height) <= f64::from(MAX_SIDE) {
        return Ok([width as u32, height as u32]);
    }
    // Sides that are too long stay so, whatever the limit.
    let is_too_long = width.max(height) > f64::from(MAX_SIDE) || width.is_nan() || height.is_nan();
    let raising = if is_too_long { String::new() } else { Limits::raising("pixels", width * height) };
    Err(Error::Limit {
        what: what.to_owned(),
        found: format!("{width} x {height} pixels"),
        limit: format!("{} pixels, {MAX_SIDE} per side", budget.limits().pixels),
        advice: format!("{advice}{raising}"),
    })
}

/// A picture that may be smaller than it was wanted.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Its file.
    pub bytes: Vec<u8>,
    /// Width and height, in pixels.
    pub size: [usize; 2],
    /// The same as wanted.
    pub wanted: [usize; 2],
}

/// Width and height, in the same proportion, of a picture of `most` pixels, where it would have more.
pub fn shrunk(size: [f64; 2], most: usize) -> [f64; 2] {
    let factor = (most as f64 / (size[0] * size[1])).sqrt();
    if factor < 1.0 { size.map(|side| (side * factor).floor().max(1.0)) } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_shrink_in_proportion() {
        assert_eq!(shrunk([400.0, 100.0], 10_000), [200.0, 50.0]);
        assert_eq!(shrunk([400.0, 100.0], 40_000), [400.0, 100.0]);
        assert_eq!(shrunk([9000.0, 1.0], 90), [900.0, 1.0]);
        assert!(shrunk([f64::NAN, 1.0], 90)[0].is_nan(), "which is refused later");
    }

    #[test]
    fn too_many_too_long_and_nan_are_refused() {
        let budget = Budget::new(Limits { pixels: 100, ..Limits::default() });
        assert_eq!(checked_size("size", [10.0, 10.0], &budget, "less").unwrap(), [10, 10]);
        for size in [[10.0, 11.0], [f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(matches!(checked_size("size", size, &budget, "less"), Err(Error::Limit { .. })), "{size:?}");
        }
        let advice = |size| checked_size("size", size, &budget, "ask for less").unwrap_err().to_string();
        assert!(advice([10.0, 11.0]).ends_with("; ask for less, or raise the limit with --limit pixels=110"));
        assert!(advice([40_000.0, 1.0]).ends_with("; ask for less"), "no limit makes it possible");
    }
}
