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

#[cfg(test)]
mod tests {
    use super::*;

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
