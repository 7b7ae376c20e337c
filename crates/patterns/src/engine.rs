//! The loop: initialise, then level by level search and assign, then place.

use std::ops::ControlFlow;

use arabesque_core::{
    EnergyPoint, Exemplar, Matrix, Observer, Outcome, Placement, Progress, Request, Result, StopReason,
};

use crate::{
    attributes,
    canvas::{Canvas, Item},
    coverage::Coverage,
    existence::{self, Changes},
    extent::Extent,
    grow::{GrowParams, Grower},
    level::Level,
    library::Library,
    noise,
    params::{Attributes, Existence, Initialisation, Matching, Params},
    positions,
    samples::ElementSamples,
    search::{self, SearchParams},
    state::State,
    targets::class_targets,
};

/// An exemplar, analysed once, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    exemplar: Exemplar<D>,
    library: Library<D>,
    levels: Vec<Level<D>>,
    params: Params,
}

pub(crate) fn env(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// Items with their turns, as they are handed from level to level.
type Items<const D: usize> = Vec<(Item<D>, Matrix<D>)>;

impl<const D: usize> Prepared<D> {
    /// Analyses the exemplar.
    ///
    /// # Errors
    /// When a parameter is out of range or contradicts the exemplar.
    pub fn new(exemplar: &Exemplar<D>, params: &Params) -> Result<Self> {
        params.check()?;
        let library = Library::new(exemplar);
        let samples = ElementSamples::new(exemplar, params.samples);
        let levels = (0..params.levels)
            .map(|l| {
                let detail = if params.levels == 1 { 1.0 } else { l as f64 / (params.levels - 1) as f64 };
                let count = params.coarse_neighbours * (params.fine_neighbours / params.coarse_neighbours).powf(detail);
                let radius = params.radius.unwrap_or_else(|| library.radius_for(count));
                let slack = match params.matching {
                    Matching::Robust => library.outlier.iter().copied().fold(0.0, f64::max),
                    Matching::Hard => radius,
                };
                Level::new(exemplar, &library, &samples, detail, (radius, slack))
            })
            .collect();
        Ok(Self { exemplar: exemplar.clone(), library, levels, params: params.clone() })
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// When nothing can be placed under the constraints, or a limit is reached.
    pub fn run(&self, request: &Request<D>, observer: &mut dyn Observer<D>) -> Result<Outcome<D>> {
        let extent = Extent::new(request, &self.exemplar, &self.library.radius);
        let mut items = self.initialise(request, &extent);
        let mut trace = Vec::new();
        let mut stopped = StopReason::Finished;
        for level in 0..self.levels.len() {
            let (next, flow) = self.refine(level, items, request, &extent, observer, &mut trace);
            items = next;
            if self.params.existence == Existence::Voted {
                items = self.fill_holes(items, request, &extent);
            }
            if flow.is_break() {
                stopped = StopReason::Observer;
                break;
            }
        }
        let placements = items.iter().map(|(item, turn)| placement(&extent, item, turn)).collect();
        Ok(Outcome { placements, energy: trace, warnings: Vec::new(), stopped })
    }

    fn initialise(&self, request: &Request<D>, extent: &Extent<'_, D>) -> Items<D> {
        let mut canvas = self.canvas(request, extent);
        if self.params.initialisation == Initialisation::WhiteNoise {
            noise::scatter(&self.library, request, extent, &mut canvas);
        } else {
            let mut coverage = self.coverage(request, extent);
            Grower::new(&self.library, request, extent, self.grow_params()).fill(&mut canvas, &mut coverage);
        }
        canvas.items.into_iter().map(|item| (item, Matrix::identity())).collect()
    }

    /// Lays out anew what is emptier than anything in the exemplar.
    fn fill_holes(&self, items: Items<D>, request: &Request<D>, extent: &Extent<'_, D>) -> Items<D> {
        let mut canvas = self.canvas(request, extent);
        let mut coverage = self.coverage(request, extent);
        items.iter().for_each(|(item, _)| canvas.push(*item));
        let reach = env("HOLE", 0.9) * self.library.emptiness;
        coverage.cover_around(items.iter().map(|(item, _)| item.position), |p| {
            reach * request.fields.frame(p).spacing_scale
        });
        Grower::new(&self.library, request, extent, self.grow_params()).fill(&mut canvas, &mut coverage);
        let turns = items.iter().map(|(_, turn)| *turn).chain(std::iter::repeat(Matrix::identity()));
        canvas.items.into_iter().zip(turns).collect()
    }

    fn patch_radius(&self) -> f64 {
        let side = self.library.window.size().0.into_iter().fold(f64::INFINITY, f64::min);
        self.library.radius_for(self.params.patch).min(self.params.patch_share * side)
    }

    fn canvas(&self, request: &Request<D>, extent: &Extent<'_, D>) -> Canvas<D> {
        Canvas::new(&request.domain, extent.margin, 0.7 * self.patch_radius() * extent.largest_spacing_scale)
    }

    fn coverage(&self, request: &Request<D>, extent: &Extent<'_, D>) -> Coverage<D> {
        let cell = 0.3 * self.library.spacing * extent.smallest_spacing_scale;
        Coverage::new(&request.domain, extent.margin, cell)
    }

    fn grow_params(&self) -> GrowParams {
        let patch = self.patch_radius();
        GrowParams {
            patch,
            context: patch * env("CTX", 1.5),
            repeat: self.params.novelty,
            balance: self.params.balance,
            noise: env("NOISE", 0.02),
            room_open: env("ROPEN", 0.5),
            room_covered: env("RCOV", 0.75),
            anchors: if self.params.initialisation == Initialisation::RandomCopy { 0 } else { 3 },
        }
    }

    fn refine(
        &self,
        level: usize,
        items: Items<D>,
        request: &Request<D>,
        extent: &Extent<'_, D>,
        observer: &mut dyn Observer<D>,
        trace: &mut Vec<EnergyPoint>,
    ) -> (Items<D>, ControlFlow<()>) {
        let mut state = State::new(&self.library, &self.levels[level], request, extent, &items);
        let params = &self.params;
        let targets = class_targets(&self.library, request, extent);
        let mut flow = ControlFlow::Continue(());
        for iteration in 0..params.iterations {
            let step = (level * 10_000 + iteration) as u64;
            let search = SearchParams {
                search: params.search,
                matching: params.matching,
                missing: params.missing as f32,
                coherence: params.coherence,
                random: if iteration == 0 { 8 } else { 2 },
                step,
            };
            let searched = search::search(&mut state, &search);
            trace.push(EnergyPoint { level, iteration, energy: state.energy(), elements: state.count() });
            let done = (level as f64 + iteration as f64 / params.iterations as f64) / self.levels.len() as f64;
            let noisy = params.initialisation == Initialisation::WhiteNoise;
            let (low, high) = (if noisy { env("F0", 0.3) } else { 0.95 }, env("F1", 0.97));
            let floor = (low + (high - low) * env("FS", 1.5) * done).min(high);
            let moved = self.assign(&mut state, &targets, floor);
            flow = observer.step(&self.progress(level, iteration, &state), &|| snapshot(&state));
            if flow.is_break() || !moved || searched == 0 {
                break;
            }
        }
        let items = state.items.iter().filter(|i| i.alive).map(|i| (i.item, i.turn)).collect();
        (items, flow)
    }

    /// One assignment step. Returns whether anything changed.
    fn assign(&self, state: &mut State<'_, D>, targets: &[f64], floor: f64) -> bool {
        let changed = match self.params.attributes {
            Attributes::Selected => attributes::assign(state),
            Attributes::Kept => 0,
        };
        let position = positions::assign(state);
        let changes = match self.params.existence {
            Existence::Voted => existence::assign(state, targets, floor),
            Existence::Fixed => Changes::default(),
        };
        let mut position = position;
        position.extend(state.samples[position.len()..].iter().map(|s| s.position));
        state.follow_samples(&position);
        let moved = announce_moves(state);
        state.reindex();
        moved || changed > 0 || changes != Changes::default()
    }

    fn progress(&self, level: usize, iteration: usize, state: &State<'_, D>) -> Progress {
        let levels = self.levels.len();
        let within = (iteration + 1) as f64 / self.params.iterations.max(1) as f64;
        Progress {
            level,
            levels,
            iteration: iteration + 1,
            iterations: self.params.iterations,
            fraction: (level as f64 + within) / levels as f64,
            energy: Some(state.energy()),
            elements: state.count(),
        }
    }
}

/// Marks the samples that moved noticeably since their neighbours last looked. Returns whether any did.
fn announce_moves<const D: usize>(state: &mut State<'_, D>) -> bool {
    let noticeable = 0.01 * state.library.spacing * state.extent.smallest_spacing_scale;
    let mut any = false;
    for k in 0..state.samples.len() {
        let sample = &state.samples[k];
        let moved = state.domain().offset(sample.announced, sample.position).norm() > noticeable;
        if moved {
            let sample = &mut state.samples[k];
            sample.announced = sample.position;
            sample.dirty = true;
            any = true;
        }
    }
    any
}

fn snapshot<const D: usize>(state: &State<'_, D>) -> Vec<Placement<D>> {
    let alive = state.items.iter().filter(|i| i.alive);
    alive.map(|i| placement(state.extent, &i.item, &i.turn)).collect()
}

fn placement<const D: usize>(extent: &Extent<'_, D>, item: &Item<D>, turn: &Matrix<D>) -> Placement<D> {
    Placement {
        source: item.source as usize,
        transform: extent.turned(item.source, item.position, turn),
        control: Vec::new(),
        frozen: item.frozen.map(|f| f as usize),
    }
}
