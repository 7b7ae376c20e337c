//! Parameters of the engine: every component by name, so that an ablation is a command.

use arabesque_core::{Result, choices, options::Preset, params};

choices! {
    /// How output samples are paired with exemplar samples.
    pub enum Matching {
        /// Nearest pair first, every output sample gets a partner [Ma 2011 §3.2].
        Hard = "hard",
        /// Optimal assignment; a sample may be an outlier at a fixed cost [Tu 2020 §4.2.3].
        Robust = "robust",
    }
}

choices! {
    /// How the most similar neighbourhood is looked for.
    pub enum Search {
        /// Candidates from the matches of the neighbours and their similarity sets [Ma 2011 §4.2].
        KCoherence = "k-coherence",
        /// Propagation along the sample graph and random windows [Tu 2020 §4.3.3].
        PatchMatch = "patchmatch",
        /// Every exemplar sample.
        Exhaustive = "exhaustive",
    }
}

choices! {
    /// How the first state is laid out.
    pub enum Initialisation {
        /// Patches chosen to agree with what is already there [Tu 2020 §4.3.2].
        PatchCopy = "patch-copy",
        /// Patches chosen at random [Ma 2011 §4.1].
        RandomCopy = "random-copy",
        /// Single elements at random places.
        WhiteNoise = "white-noise",
    }
}

choices! {
    /// Whether elements are added and removed while the pattern is optimised.
    pub enum Existence {
        /// The number of elements stays as it was laid out [Ma 2011].
        Fixed = "fixed",
        /// Votes of the overlapping neighbourhoods add and remove elements [Tu 2020 §4.3.4 and appendix A].
        Voted = "voted",
    }
}

choices! {
    /// Whether an element may be exchanged for another one of its class.
    pub enum Attributes {
        /// Each element stays what it was laid out as.
        Kept = "kept",
        /// The vote nearest to all votes is taken [Ma 2011 eq. 5].
        Selected = "selected",
    }
}

choices! {
    /// How elements follow their samples.
    pub enum Deform {
        /// Turned and shifted as a whole.
        Rigid = "rigid",
        /// As rigid as possible, the samples as control points [Schaefer 2006].
        AsRigidAsPossible = "arap",
    }
}

choices! {
    /// Whether overlaps that the exemplar does not show are repaired at the end.
    pub enum Clearance {
        /// The pattern stays as it was optimised.
        Ignored = "ignored",
        /// Exact outlines are moved apart, exchanged or removed, unless they lie as those of the exemplar do: classes that
        /// touch there may touch, and those that overlap may overlap as deeply.
        Repaired = "repaired",
    }
}

choices! {
    /// Whether a component takes part.
    pub enum Switch {
        /// It is left out.
        Off = "off",
        /// It takes part.
        On = "on",
    }
}

choices! {
    /// Whether an exemplar that repeats is continued by its repeat.
    pub enum Repeats {
        /// Every exemplar is treated as irregular.
        Off = "off",
        /// What repeats is continued exactly, anything else by its neighbourhoods.
        Auto = "auto",
        /// An exemplar without a repeat, and a request that the repeat cannot serve, are refused.
        Exact = "exact",
    }
}

params! {
    /// Parameters of the engine.
    pub struct Params {
        /// Whether an exemplar that repeats is continued by its repeat.
        repeat "repeat": Repeats = Repeats::Auto;
        /// How samples are paired.
        matching "matching": Matching = Matching::Robust;
        /// How similar neighbourhoods are found.
        search "search": Search = Search::KCoherence;
        /// How the output is laid out first.
        initialisation "initialisation": Initialisation = Initialisation::PatchCopy;
        /// Whether elements are added and removed.
        existence "existence": Existence = Existence::Voted;
        /// Whether elements are exchanged for others of their class.
        attributes "attributes": Attributes = Attributes::Selected;
        /// How elements follow their samples.
        deform "deform": Deform = Deform::Rigid;
        /// Whether overlaps deeper than the exemplar's are repaired at the end, where that leaves no wider holes than it has.
        clearance "clearance": Clearance = Clearance::Repaired;
        /// Levels of the hierarchy.
        levels "levels": usize = 3, in 1..=5;
        /// Iterations of search and assignment per level, at most.
        iterations "iterations": usize = 7, in 0..=1000;
        /// Share by which an iteration must lower the energy for another one to follow.
        /// 0 for all iterations, as after white noise.
        rest "rest": f64 = 0.1, in 0.0..=1.0;
        /// Neighbourhood radius, the same at every level.
        radius "radius": Option<f64> = None, in 1e-9..=1e9, auto "chosen from the numbers of neighbours", unit "exemplar units";
        /// Samples in an average neighbourhood at the coarsest level.
        coarse_neighbours "coarse-neighbours": f64 = 20.0, in 3.0..=200.0;
        /// Samples in an average neighbourhood at the finest level.
        fine_neighbours "fine-neighbours": f64 = 10.0, in 3.0..=200.0;
        /// Samples per element at the finest level.
        samples "samples": Option<usize> = None, in 1..=64, auto "1 to 5 by the shape of the element";
        /// Members of a similarity set.
        /// In PatchMatch: random candidates in its place.
        coherence "coherence": usize = 4, in 0..=100;
        /// Cost of a missing element relative to a surplus one.
        /// 0 as in the papers.
        missing "missing": f64 = 1.0, in 0.0..=10.0;
        /// Cost of exemplar elements that would fall outside the domain, per element relative to a surplus one.
        /// Where elements of the exemplar keep to its border, they will keep to that of the domain [Ma 2011 eq. 6].
        boundary "boundary": f64 = 0.0, in 0.0..=10.0;
        /// Distance of curve samples at the finest level.
        spacing "spacing": Option<f64> = None, in 1e-9..=1e9, auto "chosen from the distance of neighbouring strokes", unit "exemplar units";
        /// Sampling distance of curves at the coarsest level relative to the finest.
        /// At 1 the levels differ in radius alone; the paper's are about 1.3 apart in all.
        coarsening "coarsening": f64 = 1.0, in 1.0..=8.0;
        /// Whether edges take part in comparing curve samples.
        /// [Tu 2020 eq. 5]
        edges "edges": Switch = Switch::On;
        /// Whether tangents decide which edges make one stroke.
        /// Otherwise the edges themselves do [Tu 2020 §4.4.2].
        orientations "orientations": Switch = Switch::On;
        /// Whether strokes take the exemplar's shape between samples.
        /// Otherwise a smooth line runs through the samples.
        shapes "shapes": Switch = Switch::On;
        /// Whether dangling ends that the exemplar would not show are joined or trimmed.
        mending "mending": Switch = Switch::On;
        /// Whether a start in disorder is grown anew from its best part.
        regrowth "regrowth": Switch = Switch::On;
        /// Whether holes and clumps that the exemplar does not have are evened out.
        even "even": Switch = Switch::On;
        /// Whether elements are shifted for that.
        even_shift "even-shift": Switch = Switch::On;
        /// Whether elements are exchanged for others of their class that suit the room.
        even_exchange "even-exchange": Switch = Switch::On;
        /// Whether elements are put into holes.
        even_fill "even-fill": Switch = Switch::On;
        /// Whether elements are taken out of clumps.
        even_thin "even-thin": Switch = Switch::On;
        /// Whether the share of ink around each place counts, beside gaps.
        even_share "even-share": Switch = Switch::On;
        /// Elements in a patch of the first layout.
        patch "patch": f64 = 14.0, in 1.0..=1000.0;
        /// Largest patch radius relative to the shorter side of the exemplar.
        /// Keeps copies short.
        patch_share "patch-share": f64 = 0.22, in 0.01..=1.0;
        /// Reluctance of the layout to go on copying where the neighbouring patch stopped.
        novelty "novelty": f64 = 0.6, in 0.0..=10.0;
        /// Pressure of the layout towards using every exemplar element equally often.
        balance "balance": f64 = 0.1, in 0.0..=10.0;
    }
}

impl Params {
    /// The presets.
    pub const PRESETS: &'static [Preset] = &[
        Preset { name: "default", help: "What works best." },
        Preset { name: "ma2011", help: "Discrete element textures as published [Ma 2011]." },
        Preset { name: "tu2020", help: "Continuous curve textures as published, for elements as well [Tu 2020]." },
    ];

    /// Parameters by the name of a preset.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Parameter`] for an unknown name.
    pub fn preset(name: &str) -> Result<Self> {
        let published = Self {
            repeat: Repeats::Off,
            missing: 0.0,
            novelty: 0.0,
            balance: 0.0,
            clearance: Clearance::Ignored,
            regrowth: Switch::Off,
            even: Switch::Off,
            rest: 0.0,
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
            _ => Err(Preset::unknown(name, Self::PRESETS)),
        }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::options::Kind;

    use super::*;

    #[test]
    fn every_value_can_be_read_back() {
        for preset in Params::PRESETS {
            let params = Params::preset(preset.name).unwrap();
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
        assert!(message.contains("did you mean matching?"), "{message}");
        let message = Params::default().set("search", "patchmatsh").unwrap_err().to_string();
        assert!(message.contains("did you mean patchmatch?"), "{message}");
    }

    #[test]
    fn values_out_of_range_are_refused() {
        for (name, value) in [("levels", "0"), ("levels", "x"), ("radius", "-1"), ("radius", "NaN"), ("samples", "65")]
        {
            assert!(Params::default().set(name, value).is_err(), "{name}={value}");
        }
        assert!(Params { missing: f64::NAN, ..Params::default() }.check().is_err());
    }

    /// The range that each parameter has always had: a recipe of an earlier version is read as before.
    #[test]
    fn ranges_end_where_they_are_told_to() {
        for spec in Params::specs() {
            let accepts = |value: f64| Params::default().set(spec.name, &value.to_string()).is_ok();
            let (min, max) = match spec.kind {
                Kind::Integer { min, max } => (min as f64, max as f64),
                Kind::Real { min, max } => (min, max),
                Kind::Choice(_) | Kind::Switch | Kind::Text(_) => continue,
            };
            assert!(accepts(min) && accepts(max), "{}", spec.name);
            assert!(!accepts(min - 1.0) && !accepts(max * 2.0), "{}", spec.name);
        }
    }

    #[test]
    fn the_told_default_is_the_default() {
        for spec in Params::specs() {
            let mut params = Params::preset("tu2020").unwrap();
            params.set(spec.name, &spec.default).unwrap();
            let value = |params: &Params| params.values().into_iter().find(|v| v.0 == spec.name).unwrap().1;
            assert_eq!(value(&params), value(&Params::default()), "{}", spec.name);
            let told = spec.default_text();
            assert_eq!(told.split(',').next(), Some(spec.default.as_str()));
            let is_chosen = spec.default == "auto" && !matches!(spec.kind, Kind::Choice(_));
            assert_eq!(is_chosen, told.contains(", "), "{told}");
        }
        assert_eq!(Params::specs().len(), 35);
    }
}
