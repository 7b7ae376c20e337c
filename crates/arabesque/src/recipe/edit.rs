//! What is changed of a result after its run.

use std::collections::BTreeMap;

use arabesque_core::{Error, Result};
use arabesque_io::{placed::Paint, svg::check_paint};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::recipe::format::Format;

/// Factors beyond which a scale is a mistake.
const SCALES: std::ops::RangeInclusive<f64> = 1e-4..=1e4;

/// A change of elements of a result, made after the run, and of all elements that are in places like theirs where it spreads. Either
/// elements are moved, turned, scaled, made another class or painted, or they are deleted, or others are inserted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// Numbers of the elements, as the result has them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub items: Vec<usize>,
    /// How far they are moved, in the units of the page.
    #[serde(default, rename = "move", skip_serializing_if = "Vec::is_empty")]
    pub shift: Vec<f64>,
    /// By how many degrees they are turned about their centres: on the page from x towards y (clockwise), in space about `axis`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<f64>,
    /// In space: the axis that they are turned about. Default: 0, 1, 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// By which factor they are scaled about their centres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// The class that they are made elements of: copies of the nearest one of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<String>,
    /// How they are painted: `fill`, `stroke`, `stroke-width`, `opacity`, `fill-opacity`, `stroke-opacity`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub set: BTreeMap<String, String>,
    /// Whether they are deleted. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub delete: bool,
    /// Elements that are inserted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub insert: Vec<Insertion>,
    /// How unlike the neighbourhoods of elements may be that get the same change, in mean spacings. Default: only the elements that are
    /// named are changed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub propagate: Option<f64>,
    /// Radius of the neighbourhoods, in mean spacings. Default: between the second and the third ring of neighbours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Whether elements of all classes may be alike, so that only places count. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub any_class: bool,
    /// Format of the file that was edited, whose digits decide. Default: that of the output, where it can be edited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub on: Option<Format>,
    /// Fingerprint of the elements that were there before: a run that makes others is noticed. Default: not checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
}

/// An element that is inserted: a copy of the nearest one of its class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Insertion {
    /// Its class.
    pub class: String,
    /// Where its centre is, in the units of the page.
    pub at: Vec<f64>,
}

impl Edit {
    /// A change of these elements that does nothing yet.
    pub fn of_items(items: impl Into<Vec<usize>>) -> Self {
        Self { items: items.into(), ..Self::default() }
    }

    /// Whether elements are changed that are there.
    pub(crate) fn changes_items(&self) -> bool {
        let moves = !self.shift.is_empty() || self.turn.is_some() || self.scale.is_some();
        moves || self.class.is_some() || !self.set.is_empty()
    }

    /// The paint that it sets.
    pub(crate) fn paint(&self) -> Vec<Paint> {
        let paint = |(property, value): (&String, &String)| Paint { property: property.clone(), value: value.clone() };
        self.set.iter().map(paint).collect()
    }

    /// Refuses what contradicts itself, and numbers that are none. `dimension` is that of the result.
    pub(crate) fn check(&self, dimension: usize) -> Result<()> {
        let does = [self.changes_items(), self.delete, !self.insert.is_empty()];
        if does.iter().filter(|does| **does).count() != 1 {
            let found = if does.contains(&true) { "several kinds of change" } else { "no change" };
            let expected = "one of: moving, turning, scaling, a class or paint; deleting; inserting";
            return Err(Error::parameter("edit", found, expected));
        }
        if self.items.is_empty() && (self.insert.is_empty() || self.propagate.is_some()) {
            return Err(Error::parameter("items", "none", "the numbers of the elements to change"));
        }
        let finite = |name: &str, list: &[f64]| match list.iter().find(|v| !v.is_finite()) {
            Some(v) => Err(Error::parameter(name, v, "numbers")),
            None => Ok(()),
        };
        let coordinates = |name: &str, list: &[f64]| {
            if list.len() != dimension {
                let expected = format!("{dimension} numbers, as the result has {dimension} dimensions");
                return Err(Error::parameter(name, format!("{} numbers", list.len()), expected));
            }
            finite(name, list)
        };
        if !self.shift.is_empty() {
            coordinates("move", &self.shift)?;
        }
        self.insert.iter().try_for_each(|insertion| coordinates("insert", &insertion.at))?;
        finite("turn", self.turn.as_slice())?;
        if let Some(scale) = self.scale.filter(|scale| !SCALES.contains(scale)) {
            return Err(Error::parameter("scale", scale, "a factor from 0.0001 to 10000"));
        }
        if let Some(axis) = self.axis {
            finite("axis", &axis)?;
            if dimension != 3 || self.turn.is_none() || axis == [0.0; 3] {
                return Err(Error::parameter("axis", format!("{axis:?}"), "a direction, with a turn in space"));
            }
        }
        if let Some(propagate) = self.propagate.filter(|t| !(t.is_finite() && *t >= 0.0)) {
            return Err(Error::parameter("propagate", propagate, "a number of mean spacings from 0"));
        }
        if (self.radius.is_some() || self.any_class) && self.propagate.is_none() {
            return Err(Error::parameter("radius or any_class", "given", "these only together with propagate"));
        }
        self.paint().iter().try_for_each(check_paint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_that_contradict_themselves_are_refused() {
        let of = Edit::of_items([1]);
        let insertion = Insertion { class: "a".into(), at: vec![1.0, 2.0] };
        let cases = [
            (of.clone(), "no change"),
            (Edit { delete: true, turn: Some(3.0), ..of.clone() }, "several kinds"),
            (Edit { delete: true, insert: vec![insertion.clone()], ..of.clone() }, "several kinds"),
            (Edit { delete: true, ..Edit::default() }, "items = none"),
            (Edit { insert: vec![insertion.clone()], propagate: Some(0.1), ..Edit::default() }, "items = none"),
            (Edit { shift: vec![1.0], ..of.clone() }, "2 numbers"),
            (Edit { shift: vec![1.0, f64::NAN], ..of.clone() }, "move = NaN"),
            (
                Edit { insert: vec![Insertion { at: vec![0.0; 3], ..insertion.clone() }], ..Edit::default() },
                "insert = 3",
            ),
            (Edit { turn: Some(f64::INFINITY), ..of.clone() }, "turn = inf"),
            (Edit { scale: Some(0.0), ..of.clone() }, "scale = 0"),
            (Edit { scale: Some(-1.0), ..of.clone() }, "scale = -1"),
            (Edit { scale: Some(f64::NAN), ..of.clone() }, "scale = NaN"),
            (Edit { turn: Some(1.0), axis: Some([0.0, 1.0, 0.0]), ..of.clone() }, "axis"),
            (Edit { delete: true, propagate: Some(-0.5), ..of.clone() }, "propagate = -0.5"),
            (Edit { delete: true, radius: Some(2.0), ..of.clone() }, "together with propagate"),
            (Edit { set: [("fill".into(), "url(#x)".into())].into(), ..of.clone() }, "a colour"),
        ];
        for (edit, expected) in cases {
            let message = edit.check(2).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        Edit { insert: vec![insertion], ..Edit::default() }.check(2).unwrap();
        Edit { shift: vec![1.0, 2.0], turn: Some(30.0), scale: Some(2.0), class: Some("b".into()), ..of }
            .check(2)
            .unwrap();
        Edit { turn: Some(1.0), axis: Some([1.0, 1.0, 0.0]), ..Edit::of_items([0]) }.check(3).unwrap();
    }
}
