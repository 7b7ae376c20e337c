//! The natural range of a figure, and where a result lies in it.
//!
//! A figure `f` of the whole exemplar and of parts of it tells how far other parts of the same pattern differ. A part that is a share
//! `s` of the whole has `f` off by `v (1/s - 1)` in the mean square, where `v` is the variance for a window as large as the exemplar;
//! a result `k` times as large as the exemplar is then off by `v (1 + 1/k)`. The range is two and a half standard deviations wide on either
//! side, within bounds that each figure states, since few parts tell a variance only roughly.

use crate::{
    report::Measure,
    verdict::{Family, Verdict},
};

/// Standard deviations of the natural range.
const WIDTH: f64 = 2.5;

/// On which side a figure can be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Both,
    Above,
    Below,
}

/// What is known of a figure beforehand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rule {
    pub(crate) name: &'static str,
    pub(crate) family: Family,
    pub(crate) unit: &'static str,
    pub(crate) means: &'static str,
    pub(crate) side: Side,
    /// Least half width of the natural range.
    pub(crate) least: f64,
    /// Most half width of it.
    pub(crate) most: f64,
}

/// A figure of the exemplar, of its parts with their shares of it, and how many times as large the result is.
#[derive(Clone, Debug)]
pub(crate) struct Natural {
    pub(crate) whole: f64,
    pub(crate) parts: Vec<(f64, f64)>,
    pub(crate) times: f64,
}

impl Natural {
    /// Standard deviation of the difference between exemplar and result.
    fn deviation(&self) -> f64 {
        let known = self.parts.iter().filter(|(value, share)| value.is_finite() && *share < 1.0 && *share > 0.0);
        let squares: Vec<f64> = known.map(|(v, s)| (v - self.whole).powi(2) / (1.0 / s - 1.0)).collect();
        let variance = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        (variance * (1.0 + 1.0 / self.times.max(1e-3))).sqrt()
    }
}

impl Rule {
    /// The figure of a result against that of the exemplar.
    pub(crate) fn judge(&self, natural: &Natural, result: f64) -> Measure {
        let half = (WIDTH * natural.deviation()).max(self.least).min(self.most.max(self.least));
        self.judge_within(natural.whole, half, result)
    }

    /// The same with a known half width of the natural range.
    pub(crate) fn judge_within(&self, exemplar: f64, half: f64, result: f64) -> Measure {
        let off = match self.side {
            Side::Both => (result - exemplar).abs(),
            Side::Above => (result - exemplar).max(0.0),
            Side::Below => (exemplar - result).max(0.0),
        };
        let off = off / half.max(f64::MIN_POSITIVE);
        let verdict = match off {
            off if off <= 1.0 => Verdict::Good,
            off if off <= 2.0 => Verdict::Watch,
            _ => Verdict::Bad,
        };
        Measure {
            name: self.name,
            family: self.family,
            unit: self.unit,
            exemplar,
            low: (self.side != Side::Above).then_some(exemplar - half),
            high: (self.side != Side::Below).then_some(exemplar + half),
            result,
            verdict,
            fault: off * off / (off * off + 4.0),
            means: self.means,
            about: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE: Rule = Rule {
        name: "figure",
        family: Family::Evenness,
        unit: "ratio",
        means: "Tests.",
        side: Side::Above,
        least: 0.1,
        most: 0.5,
    };

    #[test]
    fn a_range_is_as_wide_as_parts_differ_and_no_narrower_or_wider_than_the_rule_says() {
        let natural = |off: f64| Natural { whole: 1.0, parts: vec![(1.0 + off, 0.5), (1.0 - off, 0.5)], times: 1.0 };
        let high = |off: f64| RULE.judge(&natural(off), 1.0).high.unwrap() - 1.0;
        assert!((high(0.08) - 2.5 * 0.08 * 2_f64.sqrt()).abs() < 1e-9, "halves are off as wholes are");
        assert_eq!((high(0.0), high(9.0)), (1.1 - 1.0, 0.5));
        let larger = Natural { times: 1e9, ..natural(0.08) };
        assert!((RULE.judge(&larger, 1.0).high.unwrap() - 1.2).abs() < 1e-6, "a huge page has no noise of its own");
    }

    #[test]
    fn verdicts_follow_the_range_on_the_side_that_matters() {
        let verdict = |side, result| Rule { side, ..RULE }.judge_within(1.0, 0.1, result).verdict;
        assert_eq!(verdict(Side::Above, 1.05), Verdict::Good);
        assert_eq!(verdict(Side::Above, 1.15), Verdict::Watch);
        assert_eq!(verdict(Side::Above, 1.25), Verdict::Bad);
        assert_eq!(verdict(Side::Above, 0.1), Verdict::Good);
        assert_eq!(verdict(Side::Both, 0.1), Verdict::Bad);
        assert_eq!(verdict(Side::Below, 0.85), Verdict::Watch);
        let fault = |result| RULE.judge_within(1.0, 0.1, result).fault;
        assert!((fault(1.1) - 0.2).abs() < 1e-9 && (fault(1.2) - 0.5).abs() < 1e-9 && fault(1.0) == 0.0);
    }
}
