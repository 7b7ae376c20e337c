//! Laying the pattern of a picture along curves.

use std::collections::BTreeMap;

use arabesque_core::{Error, Result};
use arabesque_ribbons::{Closing, Params, Search, Width};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    nearest,
    recipe::{input::Input, parameters, size::Size},
};

/// The pattern of a picture along curves. The exemplar of the recipe is the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ribbon {
    /// The file of curves: SVG for the plane, OBJ for curves in space.
    pub along: Input,
    /// Further exemplars, into which the pattern passes one after the other along each curve.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub then: Vec<Input>,
    /// Shares of the length, rising, at which the pattern passes from one exemplar into the next. Default: equal parts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<f64>,
    /// Width and height of the canvas, from the origin. Default: the page of the file of curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Size>,
    /// User units per pixel of the exemplar, or per unit of an exemplar that is a drawing. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Width of the ribbon in user units: a number, `20..40` from start to end, or `0:20,0.5:40,1:20` at shares of the length. Default: as
    /// wide as the exemplar is high.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<WidthSource>,
    /// Length of a piece in user units. Default: a tenth of the height of the exemplar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Pixel of the exemplar at which the first piece begins: column, and row, which may lie above the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<[i64; 2]>,
    /// Columns of the first exemplar that begin an open curve, and are used nowhere else: the first of them, and the one after the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<[usize; 2]>,
    /// Columns of the last exemplar that end an open curve, and are used nowhere else: the first of them, and the one after the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<[usize; 2]>,
    /// How closed curves are closed. Default: quick.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closing: Option<ClosingRule>,
    /// Whether neighbouring pieces are bent to meet. Default: true.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub stitch: bool,
    /// Whether the pattern may be cut where no part of the exemplar is valid. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub relax: bool,
    /// Shapes, and pictures whose dark opaque pixels count, where no ink may fall.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub avoid: Vec<Input>,
    /// Single parameters by name, as `--set` has them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "parameters::plain_values")]
    #[schemars(schema_with = "parameters::of_ribbons")]
    pub params: BTreeMap<String, String>,
}

/// Width of a ribbon, as people write it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum WidthSource {
    /// The same all along.
    Constant(f64),
    /// `20..40` or `0:20,0.5:40,1:20`.
    Text(String),
}

/// How a closed curve is closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ClosingRule {
    /// The best of the cycles that one pass finds.
    Quick,
    /// The best of all cycles; takes longer.
    Exact,
}

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

/// A parameter that `--set` knows.
#[derive(Clone, Copy, Debug)]
pub struct RibbonOption {
    /// Its name.
    pub name: &'static str,
    /// What it may be, and its default.
    pub values: &'static str,
    /// What it does.
    pub help: &'static str,
    set: fn(&mut Params, &str) -> Option<()>,
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok()
}

/// Every parameter that `set` of a recipe for a ribbon knows.
pub const RIBBON_OPTIONS: &[RibbonOption] = &[
    RibbonOption {
        name: "repetition",
        values: "0 to 1000, default 1",
        help: "strength of the penalty on showing a part of the exemplar again within the window",
        set: |p, t| number(t).map(|v| p.repetition = v),
    },
    RibbonOption {
        name: "window",
        values: "0 to 4, default 1",
        help: "where re-use is penalised, in lengths of the exemplar",
        set: |p, t| number(t).map(|v| p.window = v),
    },
    RibbonOption {
        name: "variety",
        values: "0 to 1000, default 1",
        help: "strength of the random preference of one part over another; 0 makes all seeds equal",
        set: |p, t| number(t).map(|v| p.variety = v),
    },
    RibbonOption {
        name: "centring",
        values: "0 to 1000, default 1",
        help: "strength of the pull to the middle of the ribbon; 0 lets the pattern wander across it freely",
        set: |p, t| number(t).map(|v| p.centring = v),
    },
    RibbonOption {
        name: "wander",
        values: "0 to 1000, default 1/32, and no limit near what is avoided",
        help: "how far the pattern may leave the middle of the ribbon, in heights of the exemplar; less is faster",
        set: |p, t| number(t).map(|v| p.wander = Some(v)),
    },
    RibbonOption {
        name: "context",
        values: "0 to 100, default 1",
        help: "weight of slopes along the strip, beside the pixels themselves, when two edges are compared",
        set: |p, t| number(t).map(|v| p.context = v),
    },
    RibbonOption {
        name: "coarse",
        values: "1 to 16, default 1",
        help: "pixels of the exemplar that are averaged to one, along each side, for the search",
        set: |p, t| t.parse().ok().map(|v| p.coarse = v),
    },
    RibbonOption {
        name: "search",
        values: "bounded or exhaustive, default bounded",
        help: "whether pairs of columns that a lower bound rules out are skipped; the result is the same",
        set: |p, t| {
            p.search = match t {
                "bounded" => Search::Bounded,
                "exhaustive" => Search::Exhaustive,
                _ => return None,
            };
            Some(())
        },
    },
];

fn set(params: &mut Params, name: &str, value: &str) -> Result<()> {
    let Some(option) = RIBBON_OPTIONS.iter().find(|o| o.name == name) else {
        let names: Vec<&str> = RIBBON_OPTIONS.iter().map(|o| o.name).collect();
        let hint = nearest(name, names.iter().copied()).map(|n| format!("; did you mean {n}?")).unwrap_or_default();
        return Err(Error::parameter(name, value, format!("a parameter of ribbons: {}{hint}", names.join(", "))));
    };
    (option.set)(params, value.trim()).ok_or_else(|| Error::parameter(name, value, option.values))
}

impl Ribbon {
    /// A ribbon along the curves of a file with everything else at its default.
    pub fn new(along: Input) -> Self {
        Self {
            along,
            then: Vec::new(),
            changes: Vec::new(),
            size: None,
            scale: None,
            width: None,
            step: None,
            first: None,
            start: None,
            end: None,
            closing: None,
            stitch: true,
            relax: false,
            avoid: Vec::new(),
            params: BTreeMap::new(),
        }
    }

    pub(super) fn prepared_part(&self) -> Self {
        Self {
            along: Input::default(),
            changes: Vec::new(),
            size: None,
            first: None,
            avoid: Vec::new(),
            ..self.clone()
        }
    }

    /// The parameters of the engine; lengths in user units, `scale` in user units per pixel of the exemplar.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name in `params` or a value out of range.
    pub(crate) fn engine_params(&self) -> Result<Params> {
        let mut params = Params {
            step: self.step,
            width: self.width.as_ref().map_or(Ok(Width::Exemplar), width)?,
            stitch: self.stitch,
            relax: self.relax,
            ..Params::default()
        };
        if self.closing == Some(ClosingRule::Exact) {
            params.closing = Closing::Exact;
        }
        if let Some(scale) = self.scale {
            params.scale = scale;
        }
        for (name, value) in &self.params {
            set(&mut params, name, value)?;
        }
        params.check()?;
        Ok(params)
    }
}

/// The width in a text such as `30`, `20..40` or `0:20,0.5:40,1:20`.
fn width(source: &WidthSource) -> Result<Width> {
    let text = match source {
        WidthSource::Constant(width) => return Ok(Width::Constant(*width)),
        WidthSource::Text(text) => text.trim(),
    };
    let fail = || {
        let expected = "a number of user units, 20..40 from start to end, or widths at rising shares of the length such as 0:20,0.5:40,1:20";
        Error::parameter("width", format!("\"{text}\""), expected)
    };
    if let Ok(width) = text.parse() {
        return Ok(Width::Constant(width));
    }
    let pair = |text: &str, by: &str| {
        let (a, b) = text.split_once(by)?;
        Some((a.trim().parse::<f64>().ok()?, b.trim().parse::<f64>().ok()?))
    };
    if let Some((from, to)) = pair(text, "..") {
        return Ok(Width::Profile(vec![(0.0, from), (1.0, to)]));
    }
    let stations = text.split(',').map(|station| pair(station, ":")).collect::<Option<Vec<_>>>().ok_or_else(fail)?;
    let rising = stations.windows(2).all(|w| w[0].0 < w[1].0) && stations.iter().all(|s| (0.0..=1.0).contains(&s.0));
    if rising { Ok(Width::Profile(stations)) } else { Err(fail()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_constant_or_vary() {
        let read = |text: &str| width(&WidthSource::Text(text.into()));
        assert_eq!(read("30").unwrap(), Width::Constant(30.0));
        assert_eq!(read("20..40").unwrap(), Width::Profile(vec![(0.0, 20.0), (1.0, 40.0)]));
        assert_eq!(read("0:20, 0.5:40,1:20").unwrap(), Width::Profile(vec![(0.0, 20.0), (0.5, 40.0), (1.0, 20.0)]));
        for text in ["", "x", "20..", "0:20,0:30", "0.5:20,0.2:30", "0:20,2:30", "0:", "nan:5,1:2"] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn parameters_are_set_by_name() {
        let mut ribbon = Ribbon::new(Input::file("c.svg"));
        for (name, value) in [("repetition", "2"), ("search", "exhaustive"), ("coarse", "2")] {
            ribbon.params.insert(name.into(), value.into());
        }
        let params = ribbon.engine_params().unwrap();
        assert_eq!((params.repetition, params.coarse), (2.0, 2));
        ribbon.params.insert("vareity".into(), "1".into());
        assert!(ribbon.engine_params().unwrap_err().to_string().contains("did you mean"));
        ribbon.params.remove("vareity");
        ribbon.params.insert("window".into(), "9".into());
        assert!(ribbon.engine_params().is_err());
    }
}
