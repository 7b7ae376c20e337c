//! What is told of a result.

use schemars::JsonSchema;
use serde::Serialize;

use crate::verdict::{Family, Verdict, worst};

/// How good one result is.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Report {
    /// Fault of the whole, from 0 (like another part of the exemplar) to 1.
    pub fault: f64,
    /// The worst verdict of all measures.
    pub verdict: Verdict,
    /// The families, each with the fault of its worst measure.
    pub families: Vec<FamilyFault>,
    /// What was measured.
    pub measures: Vec<Measure>,
    /// The functions of spatial statistics of which some measures are figures, as curves.
    pub functions: Functions,
    /// The worst places, in the coordinates of the result.
    pub marks: Vec<Mark>,
    /// What was not measured, and why.
    pub notes: Vec<String>,
    /// Elements of the exemplar and of the result, those at the border included.
    pub elements: [usize; 2],
    /// Strokes of the exemplar and of the result.
    pub strokes: [usize; 2],
    /// Mean distance of elements or lines in the exemplar, in its units: what lengths without a unit are in.
    pub spacing: f64,
}

/// Fault of one family of measures.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FamilyFault {
    /// Which one.
    pub family: Family,
    /// Fault of its worst measure, from 0 to 1.
    pub fault: f64,
    /// Verdict of its worst measure.
    pub verdict: Verdict,
}

/// One figure of the result beside that of the exemplar.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Measure {
    /// What it is called.
    pub name: &'static str,
    /// What it belongs to.
    pub family: Family,
    /// What it is counted in: `spacings`, `share`, `ratio`, `per 100 elements`, and so on.
    pub unit: &'static str,
    /// The exemplar's own.
    pub exemplar: f64,
    /// What other parts of the same pattern would have at least; `None` where less is never worse.
    pub low: Option<f64>,
    /// What other parts of the same pattern would have at most; `None` where more is never worse.
    pub high: Option<f64>,
    /// The result's.
    pub result: f64,
    /// Where the result lies: within the natural range, within twice of it, beyond.
    pub verdict: Verdict,
    /// How far off: 0 as in the exemplar, 0.2 at the end of the natural range, 0.5 at twice of it, towards 1.
    pub fault: f64,
    /// What it means, in one sentence.
    pub means: &'static str,
    /// Which class, pair of classes or place it is about, where it is the worst of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
}

/// Curves, those of the exemplar first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Functions {
    /// Distance from places to ink, in spacings, by quantile.
    pub empty_space: Option<Curve>,
    /// Clearance to the nearest element, in spacings, by class and quantile.
    pub nearest: Vec<NamedCurve>,
    /// Pairs at a distance, in spacings, over what they would be at random, by pair of classes.
    pub pairs: Vec<NamedCurve>,
    /// Elements for each square (or cubic) spacing, by class.
    pub density: Vec<ClassDensity>,
}

/// A function of the exemplar and of the result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Curve {
    /// Where it is known: shares for quantiles, distances for pairs.
    pub at: Vec<f64>,
    /// Values of the exemplar.
    pub exemplar: Vec<f64>,
    /// Values of the result.
    pub result: Vec<f64>,
}

/// A function of one class, or of a pair.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NamedCurve {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// The function.
    #[serde(flatten)]
    pub curve: Curve,
}

/// How many elements of a class there are.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClassDensity {
    /// Its name.
    pub class: String,
    /// Elements for each square (or cubic) spacing, in the exemplar.
    pub exemplar: f64,
    /// The same in the result.
    pub result: f64,
}

/// What is wrong at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// A place farther from ink than any natural one.
    Hole,
    /// More ink around than naturally.
    Clump,
    /// Two elements on top of each other.
    Overlap,
    /// An element unlike any of the exemplar.
    Broken,
    /// An element turned, mirrored or scaled as none of the exemplar is.
    Turned,
    /// A stroke that ends where it should not.
    LooseEnd,
    /// A part that is the same as a part of the exemplar.
    Copy,
}

impl Fault {
    /// The family whose measures count it.
    pub fn family(self) -> Family {
        match self {
            Self::Hole | Self::Clump => Family::Evenness,
            Self::Overlap => Family::Overlaps,
            Self::Broken | Self::Turned => Family::Elements,
            Self::LooseEnd => Family::Strokes,
            Self::Copy => Family::Copies,
        }
    }

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hole => "hole",
            Self::Clump => "clump",
            Self::Overlap => "overlap",
            Self::Broken => "broken element",
            Self::Turned => "turned element",
            Self::LooseEnd => "loose end",
            Self::Copy => "copy",
        }
    }
}

/// One of the worst places.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Mark {
    /// What is wrong.
    pub fault: Fault,
    /// Where: the middle of it.
    pub at: Vec<f64>,
    /// Radius of the disc or ball that it takes.
    pub radius: f64,
    /// How bad, in words: `2.1 spacings from ink`.
    pub says: String,
    /// What it takes, where that is known better than by a disc: polygons.
    #[serde(skip)]
    pub outline: Vec<Vec<[f64; 2]>>,
}

impl Report {
    /// Sums up the measures.
    pub(crate) fn summed(mut self) -> Self {
        for family in Family::ALL {
            let members: Vec<&Measure> = self.measures.iter().filter(|m| m.family == family).collect();
            if members.is_empty() {
                continue;
            }
            let fault = members.iter().map(|m| m.fault).fold(0.0, f64::max);
            let verdict = worst(members.iter().map(|m| m.verdict));
            self.families.push(FamilyFault { family, fault, verdict });
        }
        self.verdict = worst(self.families.iter().map(|f| f.verdict));
        self.fault = whole(&self.families);
        self
    }
}

/// Fault of the whole: half of it the mean square of the families, half the worst one, for one fault spoils a page.
fn whole(families: &[FamilyFault]) -> f64 {
    let squares: f64 = families.iter().map(|f| f.fault * f.fault).sum();
    let worst = families.iter().map(|f| f.fault).fold(0.0, f64::max);
    0.5 * (squares / families.len().max(1) as f64).sqrt() + 0.5 * worst
}
