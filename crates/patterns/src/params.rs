//! Parameters of the engine: every component by name, so that an ablation is a command.

use arabesque_core::{Error, Result};

/// Declares an enum whose variants have names on the command line.
macro_rules! named {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$doc])* $variant,)+ }

        impl $name {
            /// Names of the variants on the command line.
            pub const NAMES: &'static [&'static str] = &[$($text,)+];

            /// Name of this variant on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }

            fn parse(option: &str, value: &str) -> Result<Self> {
                match value {
                    $($text => Ok(Self::$variant),)+
                    _ => Err(unknown(option, value, Self::NAMES)),
                }
            }
        }
    };
}

named! {
    /// How output samples are paired with exemplar samples.
    Matching {
        /// Nearest pair first, every output sample gets a partner [Ma 2011 §3.2].
        Hard = "hard",
        /// Optimal assignment; a sample may be an outlier at a fixed cost [Tu 2020 §4.2.3].
        Robust = "robust",
    }
}

named! {
    /// How the most similar neighbourhood is looked for.
    Search {
        /// Candidates from the matches of the neighbours and their similarity sets [Ma 2011 §4.2].
        KCoherence = "k-coherence",
        /// Propagation along the sample graph and random windows [Tu 2020 §4.3.3].
        PatchMatch = "patchmatch",
        /// Every exemplar sample.
        Exhaustive = "exhaustive",
    }
}

named! {
    /// How the first state is laid out.
    Initialisation {
        /// Patches chosen to agree with what is already there [Tu 2020 §4.3.2].
        PatchCopy = "patch-copy",
        /// Patches chosen at random [Ma 2011 §4.1].
        RandomCopy = "random-copy",
        /// Single elements at random places.
        WhiteNoise = "white-noise",
    }
}

named! {
    /// Whether elements are added and removed while the pattern is optimised.
    Existence {
        /// The number of elements stays as it was laid out [Ma 2011].
        Fixed = "fixed",
        /// Votes of the overlapping neighbourhoods add and remove elements [Tu 2020 §4.3.4 and appendix A].
        Voted = "voted",
    }
}

named! {
    /// Whether an element may be exchanged for another one of its class.
    Attributes {
        /// Each element stays what it was laid out as.
        Kept = "kept",
        /// The vote nearest to all votes is taken [Ma 2011 eq. 5].
        Selected = "selected",
    }
}

named! {
    /// How elements follow their samples.
    Deform {
        /// Turned and shifted as a whole.
        Rigid = "rigid",
        /// As rigid as possible, the samples as control points [Schaefer 2006].
        AsRigidAsPossible = "arap",
    }
}

named! {
    /// Whether overlaps that the exemplar does not show are repaired at the end.
    Clearance {
        /// The pattern stays as it was optimised.
        Ignored = "ignored",
        /// Exact outlines are moved apart, exchanged or removed.
        Repaired = "repaired",
    }
}

named! {
    /// Whether a component takes part.
    Switch {
        /// It is left out.
        Off = "off",
        /// It takes part.
        On = "on",
    }
}

/// Parameters of the engine.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Pairing of samples. Default: robust.
    pub matching: Matching,
    /// Search strategy. Default: k-coherence.
    pub search: Search,
    /// First state. Default: patch copy.
    pub initialisation: Initialisation,
    /// Adding and removing. Default: voted.
    pub existence: Existence,
    /// Exchanging elements. Default: selected.
    pub attributes: Attributes,
    /// Bending of elements. Default: rigid.
    pub deform: Deform,
    /// Overlap repair. Default: repaired.
    pub clearance: Clearance,
    /// Levels of the hierarchy, 1 to 5. Default: 3.
    pub levels: usize,
    /// Search and assignment iterations a level, 0 to 1000. Default: 7.
    pub iterations: usize,
    /// Neighbourhood radius at every level, in the exemplar's units, positive; `None`, the default, picks it from the numbers of neighbours.
    pub radius: Option<f64>,
    /// Samples in an average neighbourhood at the coarsest level, 3 to 200. Default: 20.
    pub coarse_neighbours: f64,
    /// Samples in an average neighbourhood at the finest level, 3 to 200. Default: 10.
    pub fine_neighbours: f64,
    /// Samples of an element at the finest level, 1 to 64; `None`, the default, picks 1 to 5 from its shape.
    pub samples: Option<usize>,
    /// Members of a similarity set, and random candidates in its place in PatchMatch, 0 to 100. Default: 4.
    pub coherence: usize,
    /// Cost of a missing element relative to that of a surplus one, 0 to 10; 0 as in the papers. Default: 1.
    pub missing: f64,
    /// Cost of an exemplar neighbourhood that would reach out of the domain, per element outside relative to a surplus one, 0 to 10: where
    /// elements of the exemplar keep to its border, they will keep to that of the domain [Ma 2011 eq. 6]. Default: 0.
    pub boundary: f64,
    /// Sampling distance of curves at the finest level, exemplar units; `None` picks it from the distance of neighbouring strokes.
    pub spacing: Option<f64>,
    /// Sampling distance of curves at the coarsest level relative to the finest, 1 to 8. Default: 1, the levels differ in radius alone; the
    /// paper's are about 1.3 apart in all.
    pub coarsening: f64,
    /// Whether edge sets take part in the comparison of curve samples [Tu 2020 eq. 5]. Default: on.
    pub edges: Switch,
    /// Whether assigned tangents decide which edges make one stroke, rather than the edges themselves [Tu 2020 §4.4.2]. Default: on.
    pub orientations: Switch,
    /// Whether each stretch of an output stroke takes the shape of the exemplar, rather than a smooth line through its samples. Default: on.
    pub shapes: Switch,
    /// Whether ends that the exemplar would not show are joined or trimmed. Default: on.
    pub mending: Switch,
    /// Whether a layout that the coarsest level could not bring into order is grown anew from its largest part in order. Default: on.
    pub regrowth: Switch,
    /// Elements in a patch of the first layout, 1 to 1000. Default: 14.
    pub patch: f64,
    /// Largest radius of such a patch, relative to the shorter side of the exemplar, 0.01 to 1: keeps copies short. Default: 0.22.
    pub patch_share: f64,
    /// Reluctance of the layout to go on copying where the neighbouring patch stopped, 0 to 10. Default: 0.6.
    pub novelty: f64,
    /// Pressure of the layout towards using every exemplar element equally often, 0 to 10. Default: 0.1.
    pub balance: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            matching: Matching::Robust,
            search: Search::KCoherence,
            initialisation: Initialisation::PatchCopy,
            existence: Existence::Voted,
            attributes: Attributes::Selected,
            deform: Deform::Rigid,
            clearance: Clearance::Repaired,
            levels: 3,
            iterations: 7,
            radius: None,
            coarse_neighbours: 20.0,
            fine_neighbours: 10.0,
            samples: None,
            coherence: 4,
            missing: 1.0,
            boundary: 0.0,
            spacing: None,
            coarsening: 1.0,
            edges: Switch::On,
            orientations: Switch::On,
            shapes: Switch::On,
            mending: Switch::On,
            regrowth: Switch::On,
            patch: 14.0,
            patch_share: 0.22,
            novelty: 0.6,
            balance: 0.1,
        }
    }
}

/// One parameter, described for help texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OptionInfo {
    /// Name as in `--set name=value`.
    pub name: &'static str,
    /// Allowed values.
    pub values: &'static str,
    /// One sentence, with the default.
    pub help: &'static str,
}

/// A parameter: its description, how to set it, and how to read it back.
struct Knob {
    info: OptionInfo,
    set: fn(&mut Params, &str, &str) -> Result<()>,
    get: fn(&Params) -> String,
}

macro_rules! knob {
    ($field:ident, $name:literal, $values:literal, $help:literal, $parse:expr, $show:expr) => {
        Knob {
            info: OptionInfo { name: $name, values: $values, help: $help },
            set: |params, name, value| {
                params.$field = $parse(name, value)?;
                Ok(())
            },
            get: |params| $show(&params.$field),
        }
    };
}

const KNOBS: &[Knob] = &[
    knob!(
        matching,
        "matching",
        "hard, robust",
        "How samples are paired. Default: robust.",
        Matching::parse,
        |v: &Matching| v.name().into()
    ),
    knob!(
        search,
        "search",
        "k-coherence, patchmatch, exhaustive",
        "How similar neighbourhoods are found. Default: k-coherence.",
        Search::parse,
        |v: &Search| v.name().into()
    ),
    knob!(
        initialisation,
        "initialisation",
        "patch-copy, random-copy, white-noise",
        "How the output is laid out first. Default: patch-copy.",
        Initialisation::parse,
        |v: &Initialisation| v.name().into()
    ),
    knob!(
        existence,
        "existence",
        "fixed, voted",
        "Whether elements are added and removed. Default: voted.",
        Existence::parse,
        |v: &Existence| v.name().into()
    ),
    knob!(
        attributes,
        "attributes",
        "kept, selected",
        "Whether elements are exchanged for others of their class. Default: selected.",
        Attributes::parse,
        |v: &Attributes| v.name().into()
    ),
    knob!(
        deform,
        "deform",
        "rigid, arap",
        "How elements follow their samples. Default: rigid.",
        Deform::parse,
        |v: &Deform| v.name().into()
    ),
    knob!(
        clearance,
        "clearance",
        "ignored, repaired",
        "Whether overlaps are repaired at the end. Default: repaired.",
        Clearance::parse,
        |v: &Clearance| v.name().into()
    ),
    knob!(
        levels,
        "levels",
        "1 to 5",
        "Levels of the hierarchy. Default: 3.",
        |n: &str, v: &str| whole(n, v, 1, 5),
        usize::to_string
    ),
    knob!(
        iterations,
        "iterations",
        "0 to 1000",
        "Iterations a level. Default: 7.",
        |n: &str, v: &str| whole(n, v, 0, 1000),
        usize::to_string
    ),
    knob!(
        radius,
        "radius",
        "auto, or a length in the exemplar's units",
        "Neighbourhood radius. Default: auto.",
        |n: &str, v: &str| optional(n, v, |n, v| real(n, v, 1e-9, 1e9)),
        shown::<f64>
    ),
    knob!(
        coarse_neighbours,
        "coarse-neighbours",
        "3 to 200",
        "Neighbours at the coarsest level. Default: 20.",
        |n: &str, v: &str| real(n, v, 3.0, 200.0),
        f64::to_string
    ),
    knob!(
        fine_neighbours,
        "fine-neighbours",
        "3 to 200",
        "Neighbours at the finest level. Default: 10.",
        |n: &str, v: &str| real(n, v, 3.0, 200.0),
        f64::to_string
    ),
    knob!(
        samples,
        "samples",
        "auto, or 1 to 64",
        "Samples an element. Default: auto.",
        |n: &str, v: &str| optional(n, v, |n, v| whole(n, v, 1, 64)),
        shown::<usize>
    ),
    knob!(
        coherence,
        "coherence",
        "0 to 100",
        "Members of a similarity set. Default: 4.",
        |n: &str, v: &str| whole(n, v, 0, 100),
        usize::to_string
    ),
    knob!(
        missing,
        "missing",
        "0 to 10",
        "Cost of a missing element relative to a surplus one. Default: 1.",
        |n: &str, v: &str| real(n, v, 0.0, 10.0),
        f64::to_string
    ),
    knob!(
        boundary,
        "boundary",
        "0 to 10",
        "Cost of exemplar elements that would fall outside the domain. Default: 0.",
        |n: &str, v: &str| real(n, v, 0.0, 10.0),
        f64::to_string
    ),
    knob!(
        spacing,
        "spacing",
        "auto, or a length in the exemplar's units",
        "Distance of curve samples at the finest level. Default: auto.",
        |n: &str, v: &str| optional(n, v, |n, v| real(n, v, 1e-9, 1e9)),
        shown::<f64>
    ),
    knob!(
        coarsening,
        "coarsening",
        "1 to 8",
        "Sampling distance of curves at the coarsest level relative to the finest. Default: 1.",
        |n: &str, v: &str| real(n, v, 1.0, 8.0),
        f64::to_string
    ),
    knob!(
        edges,
        "edges",
        "off, on",
        "Whether edges take part in comparing curve samples. Default: on.",
        Switch::parse,
        |v: &Switch| v.name().into()
    ),
    knob!(
        orientations,
        "orientations",
        "off, on",
        "Whether tangents decide which edges make one stroke. Default: on.",
        Switch::parse,
        |v: &Switch| v.name().into()
    ),
    knob!(
        shapes,
        "shapes",
        "off, on",
        "Whether strokes take the exemplar's shape between samples. Default: on.",
        Switch::parse,
        |v: &Switch| v.name().into()
    ),
    knob!(
        mending,
        "mending",
        "off, on",
        "Whether dangling ends are joined or trimmed. Default: on.",
        Switch::parse,
        |v: &Switch| v.name().into()
    ),
    knob!(
        regrowth,
        "regrowth",
        "off, on",
        "Whether a start in disorder is grown anew from its best part. Default: on.",
        Switch::parse,
        |v: &Switch| v.name().into()
    ),
    knob!(
        patch,
        "patch",
        "1 to 1000",
        "Elements in a patch of the first layout. Default: 14.",
        |n: &str, v: &str| real(n, v, 1.0, 1000.0),
        f64::to_string
    ),
    knob!(
        patch_share,
        "patch-share",
        "0.01 to 1",
        "Largest patch radius relative to the exemplar. Default: 0.22.",
        |n: &str, v: &str| real(n, v, 0.01, 1.0),
        f64::to_string
    ),
    knob!(
        novelty,
        "novelty",
        "0 to 10",
        "Reluctance to copy on across patches. Default: 0.6.",
        |n: &str, v: &str| real(n, v, 0.0, 10.0),
        f64::to_string
    ),
    knob!(
        balance,
        "balance",
        "0 to 10",
        "Pressure to use all exemplar elements equally. Default: 0.1.",
        |n: &str, v: &str| real(n, v, 0.0, 10.0),
        f64::to_string
    ),
];

/// [`Params::options`], gathered once at compile time.
const OPTIONS: [OptionInfo; KNOBS.len()] = {
    let mut all = [KNOBS[0].info; KNOBS.len()];
    let mut k = 0;
    while k < KNOBS.len() {
        all[k] = KNOBS[k].info;
        k += 1;
    }
    all
};

impl Params {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "ma2011", "tu2020"];

    /// Parameters by the name of a preset: `default`; `ma2011`, discrete element textures as published; `tu2020`, continuous curve
    /// textures as published, for elements.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name.
    pub fn preset(name: &str) -> Result<Self> {
        let published = Self {
            missing: 0.0,
            novelty: 0.0,
            balance: 0.0,
            clearance: Clearance::Ignored,
            regrowth: Switch::Off,
            ..Self::default()
        };
        match name {
            "default" => Ok(Self::default()),
            "ma2011" => Ok(Self {
                matching: Matching::Hard,
                existence: Existence::Fixed,
                initialisation: Initialisation::RandomCopy,
                levels: 1,
                iterations: 10,
                boundary: 1.0,
                edges: Switch::Off,
                shapes: Switch::Off,
                mending: Switch::Off,
                ..published
            }),
            "tu2020" => Ok(Self {
                search: Search::PatchMatch,
                coarse_neighbours: 30.0,
                fine_neighbours: 20.0,
                coarsening: 1.3,
                shapes: Switch::Off,
                mending: Switch::Off,
                ..published
            }),
            _ => Err(unknown("preset", name, Self::PRESETS)),
        }
    }

    /// Every parameter that [`Params::set`] knows.
    pub fn options() -> &'static [OptionInfo] {
        &OPTIONS
    }

    /// Sets one parameter by name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name, with the nearest known one, or for a value out of range.
    pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
        match KNOBS.iter().find(|knob| knob.info.name == name) {
            Some(knob) => (knob.set)(self, name, value),
            None => {
                let names: Vec<_> = OPTIONS.iter().map(|o| o.name).collect();
                Err(unknown("set", name, &names))
            }
        }
    }

    /// Name and value of every parameter, such that [`Params::set`] with them gives these parameters again.
    pub fn values(&self) -> Vec<(&'static str, String)> {
        KNOBS.iter().map(|knob| (knob.info.name, (knob.get)(self))).collect()
    }

    /// Checks the ranges of all parameters.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first one out of range.
    pub fn check(&self) -> Result<()> {
        let mut copy = Self::default();
        self.values().iter().try_for_each(|(name, value)| copy.set(name, value))
    }
}

fn unknown(option: &str, value: &str, known: &[&str]) -> Error {
    let nearest = known.iter().min_by_key(|name| edit_distance(name, value)).filter(|n| edit_distance(n, value) <= 3);
    let list = known.join(", ");
    let hint = nearest.map_or_else(|| format!("one of {list}"), |n| format!("one of {list}; did you mean `{n}`?"));
    Error::parameter(option, value, hint)
}

/// Insertions, deletions and replacements that turn one word into the other.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

fn whole(name: &str, value: &str, low: usize, high: usize) -> Result<usize> {
    let range = || Error::parameter(name, value, format!("a whole number from {low} to {high}"));
    let number: usize = value.parse().map_err(|_| range())?;
    if (low..=high).contains(&number) { Ok(number) } else { Err(range()) }
}

fn real(name: &str, value: &str, low: f64, high: f64) -> Result<f64> {
    let range = || Error::parameter(name, value, format!("a number from {low} to {high}"));
    let number: f64 = value.parse().map_err(|_| range())?;
    if (low..=high).contains(&number) { Ok(number) } else { Err(range()) }
}

fn optional<T>(name: &str, value: &str, parse: impl Fn(&str, &str) -> Result<T>) -> Result<Option<T>> {
    if value == "auto" { Ok(None) } else { parse(name, value).map(Some) }
}

fn shown<T: ToString>(value: &Option<T>) -> String {
    value.as_ref().map_or_else(|| "auto".into(), T::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_can_be_read_back() {
        for name in Params::PRESETS {
            let params = Params::preset(name).unwrap();
            let mut copy = Params::default();
            for (name, value) in params.values() {
                copy.set(name, &value).unwrap();
            }
            assert_eq!(copy, params);
        }
    }

    #[test]
    fn a_mistyped_name_is_answered_with_the_nearest() {
        let message = Params::default().set("matchin", "hard").unwrap_err().to_string();
        assert!(message.contains("did you mean `matching`"), "{message}");
        let message = Params::default().set("search", "patchmatsh").unwrap_err().to_string();
        assert!(message.contains("did you mean `patchmatch`"), "{message}");
    }

    #[test]
    fn values_out_of_range_are_refused() {
        for (name, value) in [("levels", "0"), ("levels", "x"), ("radius", "-1"), ("radius", "NaN"), ("samples", "65")]
        {
            assert!(Params::default().set(name, value).is_err(), "{name}={value}");
        }
        assert!(Params { missing: f64::NAN, ..Params::default() }.check().is_err());
    }
}
