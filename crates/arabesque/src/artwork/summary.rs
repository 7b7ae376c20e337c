//! How much of what there is in an artwork.

use std::collections::BTreeMap;

use arabesque_core::{Exemplar, Outcome};
use serde::Serialize;

/// How much of what there is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Number of elements.
    pub elements: usize,
    /// How many of each class.
    pub classes: BTreeMap<String, usize>,
    /// Number of strokes.
    pub curves: usize,
    /// How many of each style.
    pub styles: BTreeMap<String, usize>,
    /// Number of filled areas that run through the result.
    #[serde(skip_serializing_if = "is_zero")]
    pub areas: usize,
    /// Number of points of a structure.
    #[serde(skip_serializing_if = "is_zero")]
    pub points: usize,
    /// Number of triangles of a surface.
    #[serde(skip_serializing_if = "is_zero")]
    pub triangles: usize,
    /// Width and height of the seamless tile that was made, in the units of the exemplar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tile: Option<[f64; 2]>,
    /// Of ribbons alone.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub ribbons: Option<RibbonSummary>,
    /// Of reliefs alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reliefs: Option<ReliefSummary>,
    /// Of physics alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub physics: Option<PhysicsSummary>,
    /// The last mean energy, in squared mean spacings, where the method has one.
    pub energy: Option<f64>,
}

/// What ribbons are made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RibbonSummary {
    /// Ribbons that have a piece.
    pub ribbons: usize,
    /// Pieces of all of them.
    pub pieces: usize,
    /// Their cost together, in 8-bit colour steps.
    pub cost: f64,
}

/// What elements did when they were left to come to rest, as their colliders touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PhysicsSummary {
    /// Steps until all was at rest.
    pub steps: usize,
    /// Pairs of elements that were in one another by more than a hundredth of an element's size, before.
    pub overlaps_before: usize,
    /// The same, after.
    pub overlaps: usize,
    /// How deep elements were in one another at most, before, in the units of the exemplar.
    pub deepest_before: f64,
    /// The same, after.
    pub deepest: f64,
    /// Elements that lay on nothing, over others or not, before.
    pub floating_before: usize,
    /// The same, after.
    pub floating: usize,
}

/// How the patches of a relief went together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ReliefSummary {
    /// Patches that were laid.
    pub patches: usize,
    /// Times that a patch would have folded and was bent again with fewer pairs.
    pub folds: usize,
    /// Patches that did not fit well and were passed over for the next best.
    pub passed: usize,
    /// Patches that were laid without being bent, because no pairs could be made.
    pub unbent: usize,
    /// Points where patches meet.
    pub overlapped: usize,
    /// Of these, points that were blended along their normals.
    pub by_ray: usize,
    /// Points that were blended by projection, because no ray met the surface.
    pub by_projection: usize,
    /// Points beside what was there already that nothing leads to.
    pub seams: usize,
    /// Points that were there already from which nothing goes on.
    pub cracks: usize,
    /// Points along seams that lay too close to another and were left out.
    pub merged: usize,
}

impl Summary {
    /// Of elements and strokes.
    pub(crate) fn of<const D: usize>(exemplar: &Exemplar<D>, outcome: &Outcome<D>) -> Self {
        let classes = outcome.placements.iter().map(|p| &exemplar.classes[exemplar.elements[p.source].class].name);
        let styles = outcome.curves.iter().map(|c| &exemplar.styles[exemplar.curves[c.source].style].name);
        Self {
            elements: outcome.placements.len(),
            classes: counts(classes),
            curves: outcome.curves.len(),
            styles: counts(styles),
            areas: outcome.areas.len(),
            points: 0,
            triangles: 0,
            tile: None,
            ribbons: None,
            reliefs: None,
            physics: None,
            energy: outcome.energy.last().map(|e| e.energy),
        }
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

fn counts<'a>(names: impl Iterator<Item = &'a String>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name.clone()).or_insert(0) += 1;
    }
    counts
}
