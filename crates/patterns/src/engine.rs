//! The loop: initialise, then level by level search and assign, then place.

use std::ops::ControlFlow;

use arabesque_core::{
    EnergyPoint, Error, Exemplar, Limits, Observer, Outcome, Placement, Progress, Request, Result, Role, StopReason,
    Vector, Warning,
};

use crate::{
    attributes,
    clearance::{self, ExemplarClearance},
    existence::{self, Changes},
    extent::Extent,
    finish,
    layout::{Items, Layout},
    level::Level,
    library::Library,
    matching::Prices,
    params::{Attributes, Existence, Initialisation, Matching, Params, Search},
    positions,
    samples::ElementSamples,
    search::{self, SearchParams},
    state::State,
    targets::class_targets,
};

/// Share of the progress that the first layout counts for.
const LAYOUT_SHARE: f64 = 0.2;

/// Fewest elements in the window of an exemplar from which a distribution can be learnt without a warning.
const FEW: usize = 12;

/// From white noise, elements are removed down to this share of their number at first: what is wrong everywhere is better thinned
/// out and grown again.
const NOISE_FLOOR: f64 = 0.3;

/// Elements are never removed below this share of their number at the end, and not at all below it after patch copy.
const FLOOR: f64 = 0.95;

/// Moves below this share of the mean spacing do not make the neighbours search again.
const NOTICEABLE: f64 = 0.01;

/// An exemplar, analysed once, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    exemplar: Exemplar<D>,
    library: Library<D>,
    clearance: Option<ExemplarClearance>,
    levels: Vec<Level<D>>,
    params: Params,
}

/// What one run works on.
struct Run<'a, const D: usize> {
    prepared: &'a Prepared<D>,
    request: &'a Request<D>,
    extent: &'a Extent<'a, D>,
    /// Elements of each class that the output should have.
    targets: Vec<f64>,
    /// Indices of the levels that are used.
    levels: Vec<usize>,
    trace: Vec<EnergyPoint>,
}

impl<const D: usize> Prepared<D> {
    /// Analyses the exemplar.
    ///
    /// # Errors
    /// [`Error::Parameter`] when a parameter is out of range or the radius larger than the exemplar; [`Error::Input`] when the exemplar
    /// shows fewer than two elements that may be copied, for then nothing tells how far apart they belong.
    pub fn new(exemplar: &Exemplar<D>, params: &Params) -> Result<Self> {
        params.check()?;
        if exemplar.elements.iter().filter(|e| e.role == Role::Source).count() < 2 {
            let problem = "one element only, expected at least two";
            let advice = "repeat the element a few times in the exemplar, so that it shows distances and directions";
            return Err(Error::input("exemplar", problem, advice));
        }
        let side = shortest(exemplar.window.size());
        if let Some(radius) = params.radius.filter(|r| *r > side) {
            return Err(Error::parameter(
                "radius",
                radius,
                format!("at most {side}, the shorter side of the exemplar"),
            ));
        }
        let library = Library::new(exemplar);
        let samples = ElementSamples::new(exemplar, params.samples);
        let levels = (0..params.levels).map(|l| level(exemplar, &library, &samples, params, l)).collect();
        Ok(Self {
            exemplar: exemplar.clone(),
            library,
            clearance: clearance::measure(exemplar),
            levels,
            params: params.clone(),
        })
    }

    /// Neighbourhood radius of each level, coarsest first, in the exemplar's units.
    pub fn radii(&self) -> Vec<f64> {
        self.levels.iter().map(|level| level.radius).collect()
    }

    /// Number of samples of each exemplar element at the finest level.
    pub fn samples_per_element(&self) -> Vec<usize> {
        self.levels.last().map_or_else(Vec::new, |level| level.parts.iter().map(Vec::len).collect())
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a frozen element with an unknown source; [`Error::Limit`] when the output would be too large;
    /// [`Error::NoResult`] when nothing fits into the domain.
    pub fn run(&self, request: &Request<D>, observer: &mut dyn Observer<D>) -> Result<Outcome<D>> {
        let extent = Extent::new(request, &self.exemplar, &self.library.radius);
        let targets = class_targets(&self.library, request, &extent);
        self.check_request(request, targets.iter().sum())?;
        let (levels, mut warnings) = self.usable_levels(request, &extent);
        let mut run = Run { prepared: self, request, extent: &extent, targets, levels, trace: Vec::new() };
        let (mut placements, flow) = run.synthesise(observer);
        warnings.extend(finish::mend(&mut placements, self.clearance.as_ref(), (request, &extent), &self.params));
        if placements.is_empty() {
            return Err(Error::no_result(
                "no element fits into the domain",
                "make the domain larger, lower the scale, or allow elements to cross its border",
            ));
        }
        let stopped = if flow.is_break() { StopReason::Observer } else { StopReason::Finished };
        Ok(Outcome { placements, curves: Vec::new(), energy: run.trace, warnings, stopped })
    }

    fn check_request(&self, request: &Request<D>, expected: f64) -> Result<()> {
        let limit = Limits::default().output_elements;
        if expected.is_nan() || expected > limit as f64 {
            return Err(Error::Limit {
                what: "elements of the result".into(),
                found: format!("about {expected:.0}"),
                limit: limit.to_string(),
                advice: "fill a smaller domain, or raise the scale".into(),
            });
        }
        let known = self.exemplar.elements.len();
        match request.frozen.iter().find(|p| p.source >= known) {
            Some(p) => {
                Err(Error::parameter("frozen source", p.source, format!("below {known}, the number of elements")))
            }
            None => Ok(()),
        }
    }

    /// Levels whose neighbourhoods fit into the domain, and what to say about the rest.
    fn usable_levels(&self, request: &Request<D>, extent: &Extent<'_, D>) -> (Vec<usize>, Vec<Warning>) {
        let mut warnings = Vec::new();
        let inside = self.exemplar.elements.iter().filter(|e| self.exemplar.window.contains(e.centre)).count();
        if inside < FEW {
            warnings.push(Warning::new(
                format!("the exemplar shows only {inside} elements"),
                format!("draw {FEW} or more, so that the output need not repeat the few arrangements there are"),
            ));
        }
        let room = request.domain.period().map_or(f64::INFINITY, |p| 0.5 * shortest(p) / extent.largest_spacing_scale);
        let fits: Vec<_> = (0..self.levels.len()).filter(|&l| self.levels[l].radius <= room).collect();
        if fits.len() < self.levels.len() {
            warnings.push(Warning::new(
                format!("the tile is too small for {} of {} levels", self.levels.len() - fits.len(), self.levels.len()),
                "make the tile larger, or set a smaller radius",
            ));
        }
        (fits, warnings)
    }
}

fn shortest<const D: usize>(v: Vector<D>) -> f64 {
    v.0.into_iter().fold(f64::INFINITY, f64::min)
}

fn level<const D: usize>(
    exemplar: &Exemplar<D>,
    library: &Library<D>,
    samples: &ElementSamples<D>,
    params: &Params,
    number: usize,
) -> Level<D> {
    let detail = if params.levels == 1 { 1.0 } else { number as f64 / (params.levels - 1) as f64 };
    let count = params.coarse_neighbours * (params.fine_neighbours / params.coarse_neighbours).powf(detail);
    let radius = params.radius.unwrap_or_else(|| library.radius_for(count).min(shortest(exemplar.window.size())));
    let slack = match params.matching {
        Matching::Robust => library.outlier.iter().copied().fold(0.0, f64::max),
        Matching::Hard => radius,
    };
    let mut level = Level::new(library, samples, detail, (radius, slack));
    if params.search == Search::KCoherence {
        level.alike = search::similarity_sets(&level, library, params);
    }
    level
}

impl<const D: usize> Run<'_, D> {
    /// Everything up to the placements, in the state in which the observer left them.
    fn synthesise(&mut self, observer: &mut dyn Observer<D>) -> (Vec<Placement<D>>, ControlFlow<()>) {
        let layout = Layout {
            library: &self.prepared.library,
            params: &self.prepared.params,
            request: self.request,
            extent: self.extent,
        };
        let (mut items, mut flow) = layout.initialise(&mut |items, done| self.report_layout(observer, items, done));
        let mut bent = None;
        for k in 0..self.levels.len() {
            if flow.is_break() {
                break;
            }
            (items, bent, flow) = self.refine(k, &items, observer);
            if self.prepared.params.existence == Existence::Voted && flow.is_continue() {
                items = layout.fill_holes(&items);
            }
        }
        let mut placements = finish::placements(&items, self.request, self.extent);
        for (placement, control) in placements.iter_mut().zip(bent.into_iter().flatten()) {
            placement.control = control;
        }
        (placements, flow)
    }

    fn report_layout(
        &self,
        observer: &mut dyn Observer<D>,
        items: &[crate::canvas::Item<D>],
        done: f64,
    ) -> ControlFlow<()> {
        let progress = Progress {
            level: 0,
            levels: self.levels.len(),
            iteration: 0,
            iterations: self.prepared.params.iterations,
            fraction: LAYOUT_SHARE * done,
            energy: None,
            elements: items.len(),
        };
        let preview = || {
            let items: Items<D> = items.iter().map(|&item| (item, arabesque_core::Matrix::identity())).collect();
            finish::placements(&items, self.request, self.extent)
        };
        observer.step(&progress, &preview)
    }

    /// Search and assign at one level. Also gives the bends of the items, where they are bent.
    fn refine(
        &mut self,
        k: usize,
        items: &Items<D>,
        observer: &mut dyn Observer<D>,
    ) -> (Items<D>, Option<Vec<finish::Bend<D>>>, ControlFlow<()>) {
        let prepared = self.prepared;
        let (params, level) = (&prepared.params, &prepared.levels[self.levels[k]]);
        let mut state = State::new(&prepared.library, level, self.request, self.extent, (items, params.deform));
        let mut flow = ControlFlow::Continue(());
        for iteration in 0..params.iterations {
            let searched = search::search(&mut state, &self.search_params(k, iteration));
            self.trace.push(EnergyPoint { level: k, iteration, energy: state.energy(), elements: state.count() });
            let changed = self.assign(&mut state, self.floor(k, iteration));
            flow = observer.step(&self.progress(k, iteration, &state), &|| self.snapshot(&state));
            if flow.is_break() || !changed || searched == 0 {
                break;
            }
        }
        let items = living(&state);
        let bends = finish::bends(&state);
        (items, bends, flow)
    }

    fn search_params(&self, k: usize, iteration: usize) -> SearchParams {
        let params = &self.prepared.params;
        SearchParams {
            search: params.search,
            matching: params.matching,
            prices: Prices { missing: params.missing as f32, outside: params.boundary as f32 },
            coherence: params.coherence,
            random: if iteration == 0 { 8 } else { 2 },
            rounds: match (params.search, iteration) {
                (Search::PatchMatch, 0) => 5,
                (Search::PatchMatch, _) => 2,
                _ => 1,
            },
            step: (k * 10_000 + iteration) as u64,
        }
    }

    /// Share of the target numbers below which no element is removed.
    fn floor(&self, k: usize, iteration: usize) -> f64 {
        if self.prepared.params.initialisation != Initialisation::WhiteNoise {
            return FLOOR;
        }
        let done = (k as f64 + iteration as f64 / self.prepared.params.iterations as f64) / self.levels.len() as f64;
        (NOISE_FLOOR + done).min(FLOOR)
    }

    /// One assignment step: attributes, positions, existence. Returns whether anything changed.
    fn assign(&self, state: &mut State<'_, D>, floor: f64) -> bool {
        let exchanged = match self.prepared.params.attributes {
            Attributes::Selected => attributes::assign(state),
            Attributes::Kept => 0,
        };
        let mut position = positions::assign(state);
        let changes = match self.prepared.params.existence {
            Existence::Voted => existence::assign(state, &self.targets, floor),
            Existence::Fixed => Changes::default(),
        };
        position.extend(state.samples[position.len()..].iter().map(|s| s.position));
        state.follow_samples(&position);
        let moved = state.announce_moves(NOTICEABLE * state.library.spacing * self.extent.smallest_spacing_scale);
        state.reindex();
        moved || exchanged > 0 || changes != Changes::default()
    }

    fn progress(&self, k: usize, iteration: usize, state: &State<'_, D>) -> Progress {
        let (levels, iterations) = (self.levels.len(), self.prepared.params.iterations);
        let within = (iteration + 1) as f64 / iterations.max(1) as f64;
        Progress {
            level: k,
            levels,
            iteration: iteration + 1,
            iterations,
            fraction: LAYOUT_SHARE + (1.0 - LAYOUT_SHARE) * (k as f64 + within) / levels as f64,
            energy: Some(state.energy()),
            elements: state.count(),
        }
    }

    fn snapshot(&self, state: &State<'_, D>) -> Vec<Placement<D>> {
        let mut placements = finish::placements(&living(state), self.request, self.extent);
        for (placement, control) in placements.iter_mut().zip(finish::bends(state).into_iter().flatten()) {
            placement.control = control;
        }
        placements
    }
}

fn living<const D: usize>(state: &State<'_, D>) -> Items<D> {
    state.items.iter().filter(|live| live.alive).map(|live| (live.item, live.turn)).collect()
}
