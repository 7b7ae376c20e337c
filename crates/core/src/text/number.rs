//! Numbers as text: few digits, and the same bytes everywhere.

/// How many decimals are worth writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimals(usize);

impl Decimals {
    /// Six significant digits of a length `extent`: 3 decimals for a page of 720 units, 6 for one of 1 unit.
    /// An extent that is not a positive number counts as 1.
    pub fn for_extent(extent: f64) -> Self {
        let magnitude = if extent > 0.0 && extent.is_finite() { extent.log10().ceil() } else { 0.0 };
        Self((6.0 - magnitude).clamp(0.0, 15.0) as usize)
    }

    /// `count` decimals more: for factors that a coordinate is multiplied by.
    #[must_use]
    pub fn plus(self, count: usize) -> Self {
        Self((self.0 + count).min(15))
    }

    /// One unit of the last decimal.
    pub fn step(self) -> f64 {
        10_f64.powi(-(self.0 as i32))
    }

    /// `count` decimals fewer: for the points of lines, which no one sees as sharply as the edges of shapes.
    #[must_use]
    pub fn minus(self, count: usize) -> Self {
        Self(self.0.saturating_sub(count))
    }

    /// `value` rounded to these decimals, without trailing zeros and without `-0`.
    pub fn format(self, value: f64) -> String {
        let mut text = format!("{value:.*}", self.0);
        if text.contains('.') {
            text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
        }
        if text == "-0" { "0".to_owned() } else { text }
    }

    /// `value` rounded to these decimals.
    pub fn round(self, value: f64) -> f64 {
        let factor = 10_f64.powi(self.0 as i32);
        let rounded = (value * factor).round() / factor;
        if rounded == 0.0 { 0.0 } else { rounded }
    }
}

/// A number as messages show it: four significant digits, with an exponent where it is very large or small.
pub fn rounded(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() || value == 0.0 {
        return value.to_string();
    }
    if !(1e-4..1e7).contains(&magnitude) {
        let text = format!("{value:.3e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'));
    }
    Decimals((3 - magnitude.log10().floor() as i32).clamp(0, 8) as usize).format(value)
}

/// Longest run of digits that messages show.
const DIGITS: usize = 20;

/// Longest value that messages show, in characters.
const LONGEST: usize = 80;

/// A value as messages show it: long numbers in it with an exponent, and the middle of long texts left out.
pub(crate) fn abridged(value: &str) -> String {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let mut text = String::with_capacity(value.len().min(4 * LONGEST));
    let mut rest = value;
    while let Some(start) = rest.find(is_digit) {
        let (before, from) = rest.split_at(start);
        let (run, after) = from.split_at(from.find(|c| !is_digit(c)).unwrap_or(from.len()));
        text.push_str(before);
        match run.parse::<f64>() {
            Ok(number) if run.len() > DIGITS && number.is_finite() && !after.starts_with(['e', 'E']) => {
                text.push_str(&rounded(number));
            }
            _ => text.push_str(run),
        }
        rest = after;
    }
    text.push_str(rest);
    let count = text.chars().count();
    if count <= LONGEST {
        return text;
    }
    let head = text.chars().take(LONGEST / 2);
    let tail = text.chars().skip(count - LONGEST / 4);
    format!("{}...{} ({count} characters)", head.collect::<String>(), tail.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_values_are_cut() {
        assert_eq!(abridged(&1e308_f64.to_string()), "1e308");
        assert_eq!(abridged(&format!("{},0,{}", -1e300_f64, 1e-300_f64)), "-1e300,0,1e-300");
        assert_eq!(abridged("0.30000000000000004"), "0.30000000000000004");
        assert_eq!(abridged("#c0392b"), "#c0392b");
        let long = abridged(&"a".repeat(5000));
        assert!(long.starts_with("aaaa") && long.ends_with("a (5000 characters)") && long.len() < 100, "{long}");
        assert!(abridged(&"9".repeat(5000)).len() < 100);
        assert_eq!(abridged(&"é".repeat(80)), "é".repeat(80));
    }

    #[test]
    fn people_get_four_digits() {
        let cases = [
            (533.333_333_333_333_4, "533.3"),
            (0.1 + 0.2, "0.3"),
            (-12.345_678, "-12.35"),
            (1_234_567.8, "1234568"),
            (12_345_678.9, "1.235e7"),
            (1e9, "1e9"),
            (0.000_012_345, "1.234e-5"),
            (0.001_234_5, "0.001234"),
            (0.0, "0"),
            (f64::INFINITY, "inf"),
        ];
        for (value, text) in cases {
            assert_eq!(rounded(value), text);
        }
    }

    #[test]
    fn a_page_of_720_units_gets_thousandths() {
        let d = Decimals::for_extent(720.0);
        assert_eq!(d.format(12.345_678), "12.346");
        assert_eq!(d.format(12.0), "12");
        assert_eq!(d.format(-0.000_01), "0");
        assert_eq!(d.format(100.0), "100");
    }

    #[test]
    fn small_and_large_pages_get_six_digits() {
        assert_eq!(Decimals::for_extent(1.0).format(0.123_456_789), "0.123457");
        assert_eq!(Decimals::for_extent(2e7).format(12_345_678.9), "12345679");
        assert_eq!(Decimals::for_extent(f64::NAN).format(0.5), "0.5");
    }
}
