//! Durations as people write them: `90`, `1m30s`, `0.5s`, `250ms`, `2h`.

use std::time::Duration;

/// Reads a duration; a plain number is seconds.
pub(crate) fn parse(text: &str) -> Result<Duration, String> {
    let fail = || format!("\"{text}\" is not a duration; write seconds such as 90, or 1m30s, 250ms, 2h");
    let seconds = match text.trim().parse::<f64>() {
        Ok(seconds) => seconds,
        Err(_) => sum(text.trim()).ok_or_else(fail)?,
    };
    if seconds > 0.0 { Duration::try_from_secs_f64(seconds).map_err(|_| fail()) } else { Err(fail()) }
}

/// Adds up pairs of number and unit.
fn sum(mut text: &str) -> Option<f64> {
    let mut total = 0.0;
    while !text.is_empty() {
        let number = text.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let (value, rest) = text.split_at(number);
        let unit = rest.find(|c: char| c.is_ascii_digit() || c == '.').unwrap_or(rest.len());
        let (unit, rest) = rest.split_at(unit);
        let factor = match unit.trim() {
            "ms" => 1e-3,
            "s" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            _ => return None,
        };
        total += value.parse::<f64>().ok()? * factor;
        text = rest;
    }
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_and_without_units() {
        for (text, seconds) in [("90", 90.0), ("1m30s", 90.0), ("0.5s", 0.5), ("250ms", 0.25), ("2h", 7200.0)] {
            assert_eq!(parse(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "0", "-1", "nan", "inf", "1x", "s", "1e300"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
