//! Numbers as text: few digits, and the same bytes everywhere.

use std::fmt::Write as _;

/// How many decimals are worth writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimals(usize);

/// Powers of ten, by their exponents.
const POWERS: [u64; 10] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

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
        let mut text = String::new();
        self.push(&mut text, value);
        text
    }

    /// Appends `value` to a text as [`Decimals::format`] writes it.
    pub fn push(self, text: &mut String, value: f64) {
        match self.counted(value) {
            Some((count, is_negative)) => self.push_count(text, count, is_negative),
            None => self.push_exactly(text, value),
        }
    }

    /// How often the last decimal goes into `value`, and whether it is below 0; nothing where a float does not tell for sure.
    fn counted(self, value: f64) -> Option<(u64, bool)> {
        let scaled = value.abs() * *POWERS.get(self.0)? as f64;
        let down = scaled.floor();
        let rest = scaled - down;
        // The product is off by less than 1e-7 below 1e9, and a half is rounded by the last bit of the value itself.
        let is_sure = scaled < 1e9 && (rest - 0.5).abs() > 1e-6;
        is_sure.then(|| (down as u64 + u64::from(rest > 0.5), value < 0.0))
    }

    fn push_count(self, text: &mut String, count: u64, is_negative: bool) {
        if is_negative && count > 0 {
            text.push('-');
        }
        let unit = POWERS[self.0];
        let (whole, mut rest) = (count / unit, count % unit);
        // Writing to a string never fails.
        let _ = write!(text, "{whole}");
        if rest > 0 {
            let mut width = self.0;
            while rest.is_multiple_of(10) {
                rest /= 10;
                width -= 1;
            }
            let _ = write!(text, ".{rest:0width$}");
        }
    }

    fn push_exactly(self, text: &mut String, value: f64) {
        let start = text.len();
        let _ = write!(text, "{value:.*}", self.0);
        if text[start..].contains('.') {
            text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
        }
        if &text[start..] == "-0" {
            text.replace_range(start.., "0");
        }
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
    fn short_cuts_write_what_exact_rounding_writes() {
        let exactly = |d: Decimals, value: f64| {
            let mut text = String::from("L");
            d.push_exactly(&mut text, value);
            text
        };
        let mut value = 0.379_128_4_f64;
        for n in 0..20_000 {
            // The logistic map visits everything in between 0 and 1.
            value = 3.999 * value * (1.0 - value);
            let size = 10_f64.powi(n % 16 - 5);
            for d in (0..=10).map(Decimals) {
                for v in [value * size, -value * size, (value * size).round() * 0.5] {
                    assert_eq!(format!("L{}", d.format(v)), exactly(d, v), "{v} with {d:?}");
                }
            }
        }
        for v in [0.0, -0.0, 0.5, -0.5, 1.5, 2.5, 1e300, f64::NAN, f64::INFINITY, 0.0005, 0.9995, 999.9995, -1e-9] {
            for d in (0..=12).map(Decimals) {
                assert_eq!(format!("L{}", d.format(v)), exactly(d, v), "{v} with {d:?}");
            }
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
