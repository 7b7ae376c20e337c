//! Quantiles of sorted values.

/// Shares at which functions are told as curves.
const CURVE: usize = 20;

/// The value below which a share `q` of sorted values lies; 0 where there are none.
pub(crate) fn quantile(sorted: &[f64], q: f64) -> f64 {
    let at = q * sorted.len().saturating_sub(1) as f64;
    let (low, share) = (at.floor() as usize, at.fract());
    let value = |k: usize| sorted.get(k).copied().unwrap_or(0.0);
    value(low) + if share > 0.0 { share * (value(low + 1) - value(low)) } else { 0.0 }
}

/// Shares at which functions are told.
pub(crate) fn shares() -> impl Iterator<Item = f64> {
    (1..=CURVE).map(|k| k as f64 / CURVE as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_between_values() {
        let sorted: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!((quantile(&sorted, 0.5), quantile(&sorted, 1.0), quantile(&sorted, 0.995)), (50.0, 100.0, 99.5));
        assert_eq!(quantile(&[], 0.5), 0.0);
    }
}
