//! The exponential function where it is wanted often and not to the last bit.

/// `exp(x)` for `x` of at most 0, with a relative error below 3e-7; 0 below -87.
#[inline]
pub(crate) fn exp(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    let t = x * std::f32::consts::LOG2_E;
    // Rounds to the nearest: the argument is negative and small enough for an integer.
    let whole = (t - 0.5) as i32 as f32;
    // The rest of the argument in two parts, so that little is lost.
    let f = (x - whole * 0.693_359_4) + whole * 2.121_944_4e-4;
    let p = 1.987_569_1e-4_f32;
    let p = p * f + 1.398_199_9e-3;
    let p = p * f + 8.333_452e-3;
    let p = p * f + 4.166_579_6e-2;
    let p = p * f + 1.666_666_5e-1;
    let p = p * f + 0.5;
    let y = p * f * f + f + 1.0;
    y * f32::from_bits(((whole as i32 + 127) << 23) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_exponential() {
        for n in 0..20_000 {
            let x = -86.0 * n as f32 / 20_000.0;
            let exact = f64::from(x).exp();
            assert!((f64::from(exp(x)) - exact).abs() <= 3e-7 * exact, "{x}");
        }
        assert_eq!((exp(0.0), exp(-100.0)), (1.0, 0.0));
    }
}
