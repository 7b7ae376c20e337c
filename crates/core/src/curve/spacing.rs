//! How far apart lines lie that fill an area or a volume evenly.

/// Distance of neighbouring lines that all run one way, `length` of them in a box of `measure`: in the plane, area over length.
pub fn parallel_line_spacing<const D: usize>(measure: f64, length: f64) -> f64 {
    (measure / length.max(f64::MIN_POSITIVE)).powf(1.0 / (D as f64 - 1.0))
}

/// Distance of neighbouring lines of a square or cubic net, which run along all coordinates: a net of lines `s` apart has a length
/// of `2 / s` for each unit of area, a cubic one `3 / s^2` for each unit of volume.
pub fn net_line_spacing<const D: usize>(measure: f64, length: f64) -> f64 {
    (D as f64 * measure / length.max(f64::MIN_POSITIVE)).powf(1.0 / (D as f64 - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_two_apart_are_found_two_apart() {
        // A box of side 10 holds 5 lines across a side, each 10 long.
        assert!((parallel_line_spacing::<2>(100.0, 50.0) - 2.0).abs() < 1e-12);
        assert!((net_line_spacing::<2>(100.0, 100.0) - 2.0).abs() < 1e-12);
        assert!((parallel_line_spacing::<3>(1000.0, 250.0) - 2.0).abs() < 1e-12);
        assert!((net_line_spacing::<3>(1000.0, 750.0) - 2.0).abs() < 1e-12);
        assert!(net_line_spacing::<2>(1.0, 0.0) > 1e300);
    }
}
