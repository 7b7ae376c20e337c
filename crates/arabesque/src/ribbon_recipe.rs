//! What a recipe says of a ribbon.

use arabesque_core::{Error, Result, options::ParamSpec, suggest::did_you_mean};
use arabesque_ribbons::{Closing, RibbonParams, Width};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{FieldSource, Input, Recipe};

/// The pattern of a picture along curves. The exemplar of the recipe is the picture, its `size` the canvas (default: the page of the file
/// of curves), its `scale` user units per pixel of the exemplar, its `avoid` shapes and pictures where no ink may fall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RibbonRecipe {
    /// The file of curves: SVG for the plane, OBJ for curves in space.
    pub along: Input,
    /// Further exemplars, into which the pattern passes one after the other along each curve.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub then: Vec<Input>,
    /// Shares of the length, rising, at which the pattern passes from one exemplar into the next. Default: equal parts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<f64>,
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

/// The parameters that `set` of a recipe for a ribbon knows; the others have keys of their own.
pub fn ribbon_options() -> Vec<ParamSpec> {
    RibbonParams::specs().into_iter().filter(|spec| !spec.own_option).collect()
}

impl RibbonRecipe {
    /// A ribbon along the curves of a file with everything else at its default.
    pub fn new(along: Input) -> Self {
        Self {
            along,
            then: Vec::new(),
            changes: Vec::new(),
            width: None,
            step: None,
            first: None,
            start: None,
            end: None,
            closing: None,
            stitch: true,
            relax: false,
        }
    }

    /// The parameters of the engine; lengths in user units, `scale` in user units per pixel of the exemplar.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name in `set` or a value out of range.
    pub(crate) fn params(&self, recipe: &Recipe) -> Result<RibbonParams> {
        let mut params =
            RibbonParams { step: self.step, stitch: self.stitch, relax: self.relax, ..RibbonParams::default() };
        match &self.width {
            None => {}
            Some(WidthSource::Constant(width)) => params.width = Width::Constant(*width),
            Some(WidthSource::Text(text)) => params.set("width", text)?,
        }
        if self.closing == Some(ClosingRule::Exact) {
            params.closing = Closing::Exact;
        }
        match &recipe.scale {
            None => {}
            Some(FieldSource::Constant(scale)) => params.scale = *scale,
            Some(FieldSource::File(file)) => {
                return Err(Error::parameter(
                    "scale",
                    &file.file.path,
                    "a number: user units per pixel of the exemplar",
                ));
            }
        }
        for (name, value) in &recipe.set {
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
    use arabesque_ribbons::Search;

    use super::*;

    #[test]
    fn parameters_are_set_by_name() {
        let mut recipe = Recipe::new(Input::file("a.png"));
        let ribbon = RibbonRecipe::new(Input::file("c.svg"));
        for (name, value) in [("repetition", "2"), ("search", "exhaustive"), ("coarse", "2")] {
            recipe.set.insert(name.into(), value.into());
        }
        let params = ribbon.params(&recipe).unwrap();
        assert_eq!((params.repetition, params.search, params.coarse), (2.0, Search::Exhaustive, 2));
        recipe.set.insert("vareity".into(), "1".into());
        assert!(ribbon.params(&recipe).unwrap_err().to_string().contains("did you mean variety"));
        recipe.set.remove("vareity");
        recipe.set.insert("window".into(), "9".into());
        assert!(ribbon.params(&recipe).is_err());
        recipe.set.clear();
        recipe.set.insert("step".into(), "4".into());
        assert!(ribbon.params(&recipe).is_err(), "a step has a key of its own");
    }
}
