//! Laying the pattern of a picture along curves.

use std::collections::BTreeMap;

use arabesque_core::{Error, Result, options::ParamSpec, suggest::did_you_mean};
use arabesque_ribbons::{Closing, RibbonParams, Width};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::{input::Input, job::parameters, size::Size};

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
    pub closing: Option<Closing>,
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

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

/// The parameters that `set` of a recipe for a ribbon knows; the others have keys of their own.
pub fn ribbon_options() -> Vec<ParamSpec> {
    RibbonParams::specs().into_iter().filter(|spec| !spec.own_option).collect()
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
    pub(crate) fn engine_params(&self) -> Result<RibbonParams> {
        let mut params =
            RibbonParams { step: self.step, stitch: self.stitch, relax: self.relax, ..RibbonParams::default() };
        match &self.width {
            None => {}
            Some(WidthSource::Constant(width)) => params.width = Width::Constant(*width),
            Some(WidthSource::Text(text)) => params.set("width", text)?,
        }
        if let Some(closing) = self.closing {
            params.closing = closing;
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

fn set(params: &mut RibbonParams, name: &str, value: &str) -> Result<()> {
    let names: Vec<&str> = ribbon_options().iter().map(|spec| spec.name).collect();
    if names.contains(&name) {
        return params.set(name, value);
    }
    let hint = did_you_mean(name, names.iter().copied());
    Err(Error::parameter("set", name, format!("one of {}{hint}", names.join(", "))))
}

#[cfg(test)]
mod tests {

    use super::*;

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
