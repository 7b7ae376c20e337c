//! What the user should know of a reconstruction, counted part by part and told once.

use arabesque_core::{Warning, rounded};

/// What was noticed.
#[derive(Clone, Debug, Default)]
pub(super) struct Notes {
    /// Points whose normals were estimated, since there were none.
    pub(super) estimated: usize,
    /// Parts that do not hang together, among those.
    pub(super) pieces: usize,
    /// Normals without a direction.
    pub(super) mended: usize,
    /// Points whose normals contradicted those around and were turned.
    pub(super) turned: usize,
    /// The largest share of contradictions that was left as it is.
    pub(super) contradictions: f64,
    /// Points that lie alone and were left out.
    pub(super) outliers: usize,
    /// Points inside of a solid that others surround, left out.
    pub(super) buried: usize,
    /// Parts with too few points, by name.
    pub(super) too_few: Vec<String>,
    /// Parts without any surface, by name.
    pub(super) empty: Vec<String>,
    /// Small pieces of surface that were left out.
    pub(super) crumbs: usize,
    /// The usual side of a cell and the largest that was taken instead, to stay within the memory.
    pub(super) coarser: Option<(f64, f64)>,
}

impl Notes {
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let mut tell = |holds: bool, message: String, advice: &str| {
            if holds {
                warnings.push(Warning::new(message, advice));
            }
        };
        let many = |n: usize, one: &str, more: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {more}") };
        tell(
            self.estimated > 0,
            format!("the normals of {} were estimated from their places", many(self.estimated, "point", "points")),
            "give normals where a surface faces the wrong side or bridges a gap",
        );
        tell(
            self.pieces > 1 && self.estimated > 0,
            format!("the points make {} pieces that do not touch; each was turned outwards by itself", self.pieces),
            "give normals if a piece is turned inside out",
        );
        tell(
            self.mended > 0,
            format!(
                "{} without a direction; it was taken from the points around",
                many(self.mended, "normal", "normals")
            ),
            "give each point a normal of length 1",
        );
        tell(
            self.turned > 0,
            format!(
                "normals contradicted one another: {} turned to the side of those around",
                many(self.turned, "was", "were")
            ),
            "set normals=given to take them as they are",
        );
        tell(
            self.contradictions > 0.05,
            format!(
                "{:.0} per cent of the normals lead to the other side than those beside them",
                100.0 * self.contradictions
            ),
            "set normals=estimated to turn them to one side",
        );
        tell(
            self.outliers > 0,
            format!("{} far from the others left out", many(self.outliers, "point was", "points were")),
            "remove them from the points, or set a larger kernel to keep them",
        );
        tell(
            self.buried > 0,
            format!("{} inside of what the others surround left out", many(self.buried, "point was", "points were")),
            "give things that pass through one another groups of their own to keep them apart",
        );
        let list = |names: &[String]| match names {
            [a, b, c, _, ..] => format!("{a}, {b}, {c} and {} more", names.len() - 3),
            _ => names.join(", "),
        };
        tell(
            !self.too_few.is_empty(),
            format!("too few points for a surface: {}", list(&self.too_few)),
            "give each part at least 4 points, or make one surface of all with parts=one",
        );
        tell(
            !self.empty.is_empty(),
            format!("no surface passes between the points of {}", list(&self.empty)),
            "check their normals or radii, or set a smaller cell",
        );
        tell(
            self.crumbs > 0,
            format!(
                "{} smaller than a few points left out",
                many(self.crumbs, "piece of surface was", "pieces of surface were")
            ),
            "set a larger kernel to join them to the rest",
        );
        let (usual, cell) = self.coarser.unwrap_or_default();
        tell(
            self.coarser.is_some(),
            format!(
                "cells of {} instead of {}: those of so many points would take too much memory",
                rounded(cell),
                rounded(usual)
            ),
            "set the size of the cells, and raise the limit with --limit memory=N where that is needed",
        );
        warnings
    }
}
