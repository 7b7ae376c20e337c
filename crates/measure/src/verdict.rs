//! Verdicts, and the families that measures belong to.

use schemars::JsonSchema;
use serde::Serialize;

/// Where a figure lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Within the natural range.
    #[default]
    Good,
    /// Beyond it, by as much again at most.
    Watch,
    /// Farther off.
    Bad,
}

impl Verdict {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Watch => "watch",
            Self::Bad => "bad",
        }
    }
}

/// The worst of several.
pub(crate) fn worst(verdicts: impl Iterator<Item = Verdict>) -> Verdict {
    verdicts.max().unwrap_or_default()
}

/// What a figure is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// Holes and clumps.
    Evenness,
    /// How many of each class, where.
    Density,
    /// Distances between elements.
    Distances,
    /// Elements on top of each other.
    Overlaps,
    /// Shape, direction and size of elements.
    Elements,
    /// Ends, junctions, length and bends of strokes.
    Strokes,
    /// What was taken over from the exemplar in one piece.
    Copies,
    /// What happens at the edge of the page.
    Border,
}

impl Family {
    /// All of them, in the order in which they are told.
    pub const ALL: [Self; 8] = [
        Self::Evenness,
        Self::Density,
        Self::Distances,
        Self::Overlaps,
        Self::Elements,
        Self::Strokes,
        Self::Copies,
        Self::Border,
    ];

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Evenness => "evenness",
            Self::Density => "density",
            Self::Distances => "distances",
            Self::Overlaps => "overlaps",
            Self::Elements => "elements",
            Self::Strokes => "strokes",
            Self::Copies => "copies",
            Self::Border => "border",
        }
    }
}
