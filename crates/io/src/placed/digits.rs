//! Numbers that may come back: what is moved and moved back again has the digits that it had.

use serde_json::Number;

/// Share of the extent within which a number with few decimals is meant.
const MEANT: f64 = 1e-12;
/// Share of the extent to which any other number is written.
const KEPT: f64 = 1e-15;
/// Digits behind the first place of the extent that a number has at most when it is meant.
const FEW: f64 = 9.0;

/// A number with the fewest decimals that are meant by it, and with nearly all that it has otherwise; `extent` is how large numbers of
/// its kind are.
pub(crate) fn digits(value: f64, extent: f64) -> String {
    let extent = if extent > 0.0 && extent.is_finite() { 10_f64.powf(extent.log10().ceil()) } else { 1.0 };
    // Close together, the last bit of the number itself is coarser.
    let meant = (MEANT * extent).max(4.0 * f64::EPSILON * value.abs());
    let most = (FEW - extent.log10()).clamp(0.0, 15.0) as usize;
    let few = (0..=most).map(|n| format!("{value:.n$}")).find(|text| (parsed(text) - value).abs() <= meant);
    let text = few.unwrap_or_else(|| {
        let n = (-(KEPT * extent).log10()).clamp(0.0, 17.0) as usize;
        format!("{value:.n$}")
    });
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The same as JSON has it.
pub(crate) fn json_digits(value: f64, extent: f64) -> String {
    let value = parsed(&digits(value, extent));
    Number::from_f64(value).map_or_else(|| "0.0".to_owned(), |number| number.to_string())
}

fn parsed(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_digits_are_meant_where_they_are_near() {
        for (value, text) in [
            (12.345 + 0.1, "12.445"),
            (0.1 + 0.2, "0.3"),
            (-0.0, "0"),
            (1e-20, "0"),
            (300.0, "300"),
            (-17.25, "-17.25"),
        ] {
            assert_eq!(digits(value, 300.0), text);
        }
        assert_eq!(json_digits(3.0, 300.0), "3.0");
        assert_eq!(json_digits(34.556916, 300.0), "34.556916");
    }

    #[test]
    fn a_number_comes_back_after_a_turn_and_back() {
        let (sin, cos) = 0.7_f64.sin_cos();
        for k in 0..2000 {
            let [x, y] =
                [f64::from(k) * 0.137 - 90.0, 250.0 - f64::from(k * k % 977) * 0.251].map(|v| (v * 1e3).round() / 1e3);
            let there = [cos * x - sin * y, sin * x + cos * y].map(|v| parsed(&digits(v, 300.0)));
            let back = [cos * there[0] + sin * there[1], cos * there[1] - sin * there[0]];
            assert_eq!(back.map(|v| digits(v, 300.0)), [x, y].map(|v| digits(v, 300.0)));
        }
    }
}
