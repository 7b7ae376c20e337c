//! Parameters of the engine.

use arabesque_core::{Error, Result};

/// How output samples are paired with exemplar samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matching {
    /// Nearest pair first, every output sample gets a partner [Ma 2011 §3.2].
    Hard,
    /// Optimal assignment; an output sample may be an outlier at a fixed cost [Tu 2020 §4.2.3].
    Robust,
}

/// How the most similar neighbourhood is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Candidates from the matches of the neighbours and their similarity sets [Ma 2011 §4.2].
    KCoherence,
    /// Propagation along the sample graph and random windows [Tu 2020 §4.3.3].
    PatchMatch,
    /// Every exemplar sample.
    Exhaustive,
}

/// How the first state is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initialisation {
    /// Patches chosen to agree with what is already there [Tu 2020 §4.3.2].
    PatchCopy,
    /// Patches chosen at random [Ma 2011 §4.1].
    RandomCopy,
    /// Single elements at random places.
    WhiteNoise,
}

/// Whether elements are added and removed while the pattern is optimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existence {
    /// The number of elements stays as it was laid out [Ma 2011].
    Fixed,
    /// Votes of the overlapping neighbourhoods add and remove elements [Tu 2020 §4.3.4 and appendix A].
    Voted,
}

/// How elements follow their samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deform {
    /// Turned and shifted as a whole.
    Rigid,
    /// As rigid as possible, the samples as control points.
    AsRigidAsPossible,
}

/// Parameters of the engine. Lengths without a unit are in mean element spacings.
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
    /// Bending of elements. Default: rigid.
    pub deform: Deform,
    /// Levels of the hierarchy, 1 to 5. Default: 3.
    pub levels: usize,
    /// Search and assignment iterations a level, 0 to 1000. Default: 7.
    pub iterations: usize,
    /// Neighbourhood radius in the exemplar's units; `None` picks it from the number of neighbours.
    pub radius: Option<f64>,
    /// Samples an element; `None` picks 1 to 5 from its shape.
    pub samples: Option<usize>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            matching: Matching::Robust,
            search: Search::KCoherence,
            initialisation: Initialisation::PatchCopy,
            existence: Existence::Voted,
            deform: Deform::Rigid,
            levels: 3,
            iterations: 7,
            radius: None,
            samples: None,
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

impl Params {
    /// Names of the presets.
    pub const PRESETS: &'static [&'static str] = &["default", "ma2011", "tu2020"];

    /// Parameters by the name of a preset.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name.
    pub fn preset(name: &str) -> Result<Self> {
        match name {
            "default" => Ok(Self::default()),
            "ma2011" => Ok(Self {
                matching: Matching::Hard,
                existence: Existence::Fixed,
                initialisation: Initialisation::RandomCopy,
                levels: 1,
                iterations: 10,
                ..Self::default()
            }),
            "noise" => Ok(Self { initialisation: Initialisation::WhiteNoise, ..Self::default() }),
            "tu2020" => Ok(Self { search: Search::PatchMatch, ..Self::default() }),
            _ => Err(Error::parameter("preset", name, "default, ma2011 or tu2020")),
        }
    }

    /// Every parameter that [`Params::set`] knows.
    pub fn options() -> &'static [OptionInfo] {
        &[]
    }

    /// Sets one parameter by name.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name, with the nearest known one, or for a value out of range.
    pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
        Err(Error::parameter("set", format!("{name}={value}"), "a known parameter"))
    }
}
