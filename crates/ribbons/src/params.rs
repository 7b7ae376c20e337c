//! Parameters, with defaults that work.

use arabesque_core::{Error, Result};

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

    fn check(&self) -> Result<()> {
        let widths: Vec<f64> = match self {
            Self::Exemplar => return Ok(()),
            Self::Constant(width) => vec![*width],
            Self::Profile(stations) => stations.iter().map(|s| s.1).collect(),
        };
        let wrong = widths.iter().find(|w| !(w.is_finite() && **w > 0.0));
        match wrong {
            Some(w) => Err(Error::parameter("width", w, "a positive number of user units")),
            None if widths.is_empty() => Err(Error::parameter("width", "", "at least one station")),
            None => Ok(()),
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

/// How a closed curve is closed [Zhou 2013 §1.5].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Closing {
    /// One pass; the best of the cycles among its paths, and where there is none, a second pass from the best start.
    #[default]
    Quick,
    /// The best of all cycles.
    Exact,
}

/// How each row of the dynamic programme is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// Exact, skipping pairs of columns that a lower bound rules out.
    #[default]
    Bounded,
    /// Every pair of columns in full.
    Exhaustive,
}

/// How a pattern is laid along a curve. Lengths are in user units of the canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Length of a piece along the curve; rounded so that whole pieces fill the curve. Default: a tenth of the height of the exemplar.
    pub step: Option<f64>,
    /// Width of the ribbon. Default: [`Width::Exemplar`].
    pub width: Width,
    /// User units an exemplar pixel, above 0. Default: 1.
    pub scale: f64,
    /// Weight of the slopes of alpha and brightness along the strip, beside the pixels themselves, when two edges are compared, 0 to 100.
    /// Default: 1; 0 compares pixels alone, as the paper does.
    pub context: f64,
    /// Strength of the penalty on showing a part of the exemplar again within [`Params::window`], 0 or more. Default: 1; 0 switches it off.
    pub repetition: f64,
    /// Where re-use is penalised, as a multiple of the exemplar's length, 0 to 4. Default: 1.
    pub window: f64,
    /// Strength of the random preference of one part of the exemplar over another, from piece to piece, 0 or more. Default: 1;
    /// 0 makes all seeds equal.
    pub variety: f64,
    /// Strength of the pull to the middle of the ribbon, 0 or more. Default: 1; 0 lets the pattern wander across the ribbon freely, as in
    /// the paper.
    pub centring: f64,
    /// How far the pattern may leave the middle of the ribbon, as a share of the exemplar's height, 0 or more. Default: 1/100, and farther
    /// where regions, folds and overlaps have to be avoided. The fewer the positions, the faster the search; 1 allows all, as in the paper.
    pub wander: Option<f64>,
    /// Whether neighbouring pieces are bent to meet [Zhou 2013 §3.2]. Default: true.
    pub stitch: bool,
    /// How closed curves are closed. Default: [`Closing::Quick`].
    pub closing: Closing,
    /// Whether the pattern may be cut where no position is valid, with a warning. Default: false, which makes it an error.
    pub relax: bool,
    /// Exemplar pixels that are averaged to one, along each side, for the search, 1 to 16. Default: 1.
    pub coarse: usize,
    /// How rows are computed. Default: [`Search::Bounded`].
    pub search: Search,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            step: None,
            width: Width::Exemplar,
            scale: 1.0,
            context: 1.0,
            repetition: 1.0,
            window: 1.0,
            variety: 1.0,
            centring: 1.0,
            wander: None,
            stitch: true,
            closing: Closing::Quick,
            relax: false,
            coarse: 1,
            search: Search::Bounded,
        }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is not.
    pub fn check(&self) -> Result<()> {
        let positive = |name, value: f64| {
            let right = value.is_finite() && value > 0.0;
            if right { Ok(()) } else { Err(Error::parameter(name, value, "a positive number")) }
        };
        let strength = |name, value: f64, most: f64| {
            let right = (0.0..=most).contains(&value);
            if right { Ok(()) } else { Err(Error::parameter(name, value, format!("a number from 0 to {most}"))) }
        };
        positive("scale", self.scale)?;
        self.step.map_or(Ok(()), |step| positive("step", step))?;
        self.width.check()?;
        strength("context", self.context, 100.0)?;
        strength("repetition", self.repetition, 1000.0)?;
        strength("window", self.window, 4.0)?;
        strength("variety", self.variety, 1000.0)?;
        strength("centring", self.centring, 1000.0)?;
        strength("wander", self.wander.unwrap_or(0.0), 1000.0)?;
        if !(1..=16).contains(&self.coarse) {
            return Err(Error::parameter("coarse", self.coarse, "a whole number from 1 to 16"));
        }
        Ok(())
    }
}
