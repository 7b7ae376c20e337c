//! Parameters, with defaults that work.

use arabesque_core::{
    choices,
    options::{Kind, ParamValue},
    params,
};

/// Length of a piece where none is given, in heights of the exemplar.
pub(crate) const STEP: f64 = 0.1;
/// How far the pattern leaves the middle where nothing is in its way and no distance is given, in heights of the exemplar.
pub(crate) const WANDER: f64 = 0.01;

/// How wide the ribbon is, in user units: the room across the curve in which the pattern may lie.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Width {
    /// As wide as the exemplar is high.
    #[default]
    Exemplar,
    /// The same all along.
    Constant(f64),
    /// Widths at shares of the length in [0, 1], in rising order, linear in between and constant beyond.
    Profile(Vec<(f64, f64)>),
}

impl Width {
    /// The width at `share` of the length for an exemplar that is `height` user units high.
    pub(crate) fn at(&self, share: f64, height: f64) -> f64 {
        match self {
            Self::Exemplar => height,
            Self::Constant(width) => *width,
            Self::Profile(stations) => interpolated(stations, share),
        }
    }
}

/// Written as `exemplar`, `30`, `20..40` from start to end, or `0:20,0.5:40,1:20` at shares of the length.
impl ParamValue for Width {
    fn kind(_: Option<(f64, f64)>) -> Kind {
        Kind::Text(
            "exemplar, a positive number of user units, 20..40 from start to end, or widths at rising shares of the length such as \
             0:20,0.5:40,1:20",
        )
    }

    fn parse(text: &str, _: &Kind) -> Option<Self> {
        let text = text.trim();
        let pair = |text: &str, by: &str| {
            let (a, b) = text.split_once(by)?;
            Some((a.trim().parse::<f64>().ok()?, b.trim().parse::<f64>().ok()?))
        };
        let width = if text == "exemplar" {
            Self::Exemplar
        } else if let Ok(width) = text.parse() {
            Self::Constant(width)
        } else if let Some((from, to)) = pair(text, "..") {
            Self::Profile(vec![(0.0, from), (1.0, to)])
        } else {
            Self::Profile(text.split(',').map(|station| pair(station, ":")).collect::<Option<_>>()?)
        };
        width.is_valid().then_some(width)
    }

    fn show(&self) -> String {
        match self {
            Self::Exemplar => "exemplar".to_owned(),
            Self::Constant(width) => width.to_string(),
            Self::Profile(stations) => {
                stations.iter().map(|(share, width)| format!("{share}:{width}")).collect::<Vec<_>>().join(",")
            }
        }
    }
}

impl Width {
    fn is_valid(&self) -> bool {
        let positive = |width: &f64| width.is_finite() && *width > 0.0;
        match self {
            Self::Exemplar => true,
            Self::Constant(width) => positive(width),
            Self::Profile(stations) => {
                let rising = stations.windows(2).all(|w| w[0].0 < w[1].0);
                !stations.is_empty()
                    && rising
                    && stations.iter().all(|(share, width)| (0.0..=1.0).contains(share) && positive(width))
            }
        }
    }
}

fn interpolated(stations: &[(f64, f64)], share: f64) -> f64 {
    let after = stations.partition_point(|s| s.0 <= share);
    let (Some(a), Some(b)) = (stations.get(after.wrapping_sub(1)), stations.get(after)) else {
        return stations[after.min(stations.len() - 1)].1;
    };
    a.1 + (b.1 - a.1) * (share - a.0) / (b.0 - a.0)
}

choices! {
    /// How a closed curve is closed [Zhou 2013 §1.5].
    pub enum Closing {
        /// One pass; the best of the cycles among its paths, and where there is none, a second pass from the best start.
        Quick = "quick",
        /// The best of all cycles.
        Exact = "exact",
    }
}

choices! {
    /// How each row of the dynamic programme is computed.
    pub enum Search {
        /// Exact, skipping pairs of columns that a lower bound rules out.
        Bounded = "bounded",
        /// Every pair of columns in full.
        Exhaustive = "exhaustive",
    }
}

params! {
    /// How a pattern is laid along a curve. Lengths are in user units of the canvas.
    pub struct RibbonParams {
        /// Length of a piece along the curve; rounded so that whole pieces fill the curve.
        step "step": Option<f64> = None, in f64::MIN_POSITIVE..=f64::MAX, auto "0.1 heights of the exemplar", unit "user units", own_option true;
        /// Width of the ribbon: the room across the curve in which the pattern may lie.
        width "width": Width = Width::Exemplar, unit "user units", own_option true;
        /// Size of a pixel of the exemplar.
        scale "scale": f64 = 1.0, in f64::MIN_POSITIVE..=f64::MAX, unit "user units", own_option true;
        /// Weight of slopes along the strip, beside the pixels themselves, when two edges are compared.
        /// Slopes are those of alpha and brightness; 0 compares pixels alone, as the paper does.
        context "context": f64 = 1.0, in 0.0..=100.0;
        /// Strength of the penalty on showing a part of the exemplar again within the window.
        /// 0 switches it off.
        repetition "repetition": f64 = 1.0, in 0.0..=1000.0;
        /// Where showing a part again is penalised.
        window "window": f64 = 1.0, in 0.0..=4.0, unit "lengths of the exemplar";
        /// Strength of the random preference of one part over another, from piece to piece; 0 makes all seeds equal.
        variety "variety": f64 = 1.0, in 0.0..=1000.0;
        /// Strength of the pull to the middle of the ribbon; 0 lets the pattern wander across it freely.
        /// 0 as in the paper.
        centring "centring": f64 = 1.0, in 0.0..=1000.0;
        /// How far the pattern may leave the middle of the ribbon; less is faster.
        /// The fewer the positions, the faster the search; 1 allows all, as in the paper.
        wander "wander": Option<f64> = None, in 0.0..=1000.0, auto "0.01 heights of the exemplar, and farther where something is to be avoided", unit "heights of the exemplar";
        /// Whether neighbouring pieces are bent to meet.
        /// [Zhou 2013 §3.2]
        stitch "stitch": bool = true, own_option true;
        /// How closed curves are closed.
        closing "closing": Closing = Closing::Quick, own_option true;
        /// Whether the pattern may be cut where no position is valid.
        /// There is a warning then; without it, that is an error.
        relax "relax": bool = false, own_option true;
        /// Pixels of the exemplar that are averaged to one, along each side, for the search.
        coarse "coarse": usize = 1, in 1..=16;
        /// Whether pairs of columns that a lower bound rules out are skipped; the result is the same.
        search "search": Search = Search::Bounded;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_constant_or_vary() {
        let read = |text: &str| Width::parse(text, &Width::kind(None));
        assert_eq!(read("30"), Some(Width::Constant(30.0)));
        assert_eq!(read("20..40"), Some(Width::Profile(vec![(0.0, 20.0), (1.0, 40.0)])));
        assert_eq!(read("0:20, 0.5:40,1:20"), Some(Width::Profile(vec![(0.0, 20.0), (0.5, 40.0), (1.0, 20.0)])));
        for text in ["", "x", "0", "20..", "0:20,0:30", "0.5:20,0.2:30", "0:20,2:30", "0:", "nan:5,1:2", "0..5"] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn the_told_default_is_the_default() {
        let other = RibbonParams {
            step: Some(3.0),
            width: Width::Constant(7.0),
            scale: 2.0,
            context: 0.5,
            repetition: 2.0,
            window: 2.0,
            variety: 2.0,
            centring: 2.0,
            wander: Some(1.0),
            stitch: false,
            closing: Closing::Exact,
            relax: true,
            coarse: 2,
            search: Search::Exhaustive,
        };
        let mut params = other.clone();
        for (spec, (_, value)) in RibbonParams::specs().iter().zip(other.values()) {
            assert_ne!(spec.default, value, "{}", spec.name);
            params.set(spec.name, &spec.default).unwrap();
        }
        assert_eq!(params, RibbonParams::default());
        for (name, value) in other.values() {
            params.set(name, &value).unwrap();
        }
        assert_eq!(params, other);
    }

    #[test]
    fn what_auto_stands_for_is_what_the_engine_takes() {
        let told = |name: &str| {
            let spec = RibbonParams::specs().into_iter().find(|spec| spec.name == name).unwrap();
            spec.auto.unwrap().split(' ').next().unwrap().parse::<f64>().unwrap()
        };
        assert_eq!((told("step"), told("wander")), (STEP, WANDER));
    }

    #[test]
    fn values_out_of_range_are_refused() {
        for (name, value) in [("step", "0"), ("scale", "inf"), ("window", "4.1"), ("coarse", "17"), ("wander", "nan")] {
            assert!(RibbonParams::default().set(name, value).is_err(), "{name}={value}");
        }
        assert!(RibbonParams { width: Width::Profile(Vec::new()), ..RibbonParams::default() }.check().is_err());
    }
}
