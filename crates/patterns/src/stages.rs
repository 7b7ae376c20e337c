//! The stages of the engine one by one, each from the state in which a run meets it first: what the benchmarks time. No
//! part of the interface, and subject to change without notice.

use arabesque_core::{Bounds, Budget, Domain, Exemplar, Numbered, Outcome, Placement, Request, Unobserved, Vector};

use crate::{
    border::Extent,
    curves::{
        draw::{chains::chains, shape},
        repair::mend::mend,
        votes::{edge_votes::collect_votes, edges, tangents},
    },
    exemplar::{level::Near, level_exemplar::LevelExemplar},
    finish::{
        clearance::{self, ExemplarClearance},
        placements,
    },
    layout::Layout,
    optimise::{
        assignment::Assignment,
        existence,
        matching::{Matcher, Prices, Row, Surroundings},
        positions,
        search::{self, SearchParams},
        targets::class_targets,
    },
    output::{draft::Draft, state::State},
    params::{Deform, Matching, Params, Switch},
    prepared::Prepared,
};

/// Benchmarks are no larger than the default limits allow.
const ENOUGH: &str = "the budget suffices";

/// A stage that is timed on its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The best match of every sample.
    Search,
    /// Positions of all samples: the sparse system, set up and solved.
    Solve,
    /// Votes for what is there, and for what is missing.
    Existence,
    /// Votes for edges, and their assignment.
    Edges,
    /// Tangents of every sample.
    Orientations,
    /// Samples to elements, before overlaps are mended; edges to strokes: mended, chained, drawn.
    Reconstruct,
}

/// An exemplar, and a page to be filled from it.
#[derive(Debug)]
pub struct Setup {
    prepared: Prepared<2>,
    request: Request<2>,
}

/// What all stages work on.
#[expect(missing_debug_implementations, reason = "for benchmarks alone")]
pub struct Bench<'a> {
    layout: Layout<'a, 2>,
    targets: &'a Numbered<f64>,
    fresh: State<'a, 2>,
    searched: State<'a, 2>,
}

/// The output, about to enter a stage.
#[expect(missing_debug_implementations, reason = "for benchmarks alone")]
pub struct Output<'a> {
    state: State<'a, 2>,
    targets: &'a Numbered<f64>,
}

/// Neighbourhoods of the exemplar, each with one of its kind.
#[expect(missing_debug_implementations, reason = "for benchmarks alone")]
pub struct Pairings<'a> {
    matcher: Matcher<'a, 2>,
    pairs: Vec<(Surroundings<2>, u32)>,
    count: usize,
}

impl Setup {
    /// A square page for about `n` samples at the finest level, with default parameters.
    ///
    /// # Panics
    /// When the exemplar cannot be analysed.
    pub fn new(exemplar: &Exemplar<2>, n: usize) -> Self {
        let prepared = Prepared::new(
            exemplar.clone(),
            &Params { repeat: crate::Repeats::Off, ..Params::default() },
            &Budget::default(),
        )
        .expect("the exemplar can be analysed");
        let side = (n as f64 / density(finest(&prepared))).sqrt();
        let request = Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(side))));
        Self { prepared, request }
    }

    /// A whole run.
    ///
    /// # Panics
    /// When the page cannot be filled.
    pub fn fill(&self) -> Outcome<2> {
        self.prepared.run(&self.request, &mut Unobserved).expect("the page can be filled")
    }

    /// Lays out the page, searches once, and hands both states over.
    pub fn with<R>(&self, time: impl FnOnce(&Bench<'_>) -> R) -> R {
        let (request, sampled) = (&self.request, finest(&self.prepared));
        let (library, level) = (&*sampled.library, &sampled.level);
        let extent = Extent::new(request, &sampled.exemplar, library, level.base).expect(ENOUGH);
        let targets = class_targets(library, request, &extent, level.base).expect(ENOUGH);
        let layout = Layout { library, params: &self.prepared.params, request, extent: &extent, base: level.base };
        let mut fresh = State::new(sampled, request, &extent, Deform::Rigid, &lay_out(&layout));
        edges::link_sources(&mut fresh).expect(ENOUGH);
        let mut searched = fresh.clone();
        search::search(&mut searched, &first_search(&self.prepared.params)).expect(ENOUGH);
        time(&Bench { layout, targets: &targets, fresh, searched })
    }
}

impl<'a> Bench<'a> {
    /// The first layout: patches, from nothing. Returns the number of items.
    pub fn lay_out(&self) -> usize {
        lay_out(&self.layout).items.len()
    }

    /// The output as it enters a stage.
    pub fn before(&self, stage: Stage) -> Output<'a> {
        let state = if stage == Stage::Search { &self.fresh } else { &self.searched };
        Output { state: state.clone(), targets: self.targets }
    }

    /// As many pairings of neighbourhoods as the output has samples.
    pub fn pairings(&self) -> Pairings<'a> {
        let (state, level) = (&self.searched, self.searched.level);
        let prices = Prices { missing: 1.0, outside: 0.0 };
        let next = |i: usize| {
            let alike = &level.of_key[level.key[i]];
            alike[(i + 1) % alike.len()]
        };
        Pairings {
            matcher: Matcher::new(level, state.library, &level.stars, Matching::Robust, prices),
            pairs: (0..level.position.len()).map(|i| (surroundings(state, i as u32), next(i))).collect(),
            count: state.living().len(),
        }
    }
}

impl Output<'_> {
    /// Takes the output through a stage.
    pub fn run(&mut self, stage: Stage) {
        let state = &mut self.state;
        match stage {
            Stage::Search => _ = search::search(state, &first_search(&Params::default())).expect(ENOUGH),
            Stage::Solve => _ = std::hint::black_box(positions::assign(state).expect(ENOUGH)),
            Stage::Existence => _ = existence::assign(state, self.targets, 0.95).expect(ENOUGH),
            Stage::Edges => _ = edges::assign(state).expect(ENOUGH),
            // The first layout knows its edges.
            Stage::Orientations => tangents::assign(state).expect(ENOUGH),
            Stage::Reconstruct => reconstruct(state),
        }
    }
}

impl Pairings<'_> {
    /// Computes all of them, on one thread. Returns the sum of their costs.
    pub fn run(&mut self) -> f32 {
        let budget = Budget::default();
        let mut meter = budget.meter();
        let pair = |k: usize| {
            let (around, other) = &self.pairs[k % self.pairs.len()];
            self.matcher.cost(around, *other, f32::INFINITY, &|_| true, &mut meter).expect(ENOUGH)
        };
        (0..self.count).map(pair).sum()
    }
}

/// The pairing of two sets of samples.
#[derive(Debug, Default)]
pub struct Pairing(Assignment);

impl Pairing {
    /// The cheapest pairing of every row with a column of its own; `cost` by rows.
    pub fn full(&mut self, rows: usize, columns: usize, cost: &[f32]) -> f32 {
        self.0.solve(rows, columns, cost)
    }

    /// The cheapest pairing where row `r` may stay alone at `outlier[r]`.
    pub fn with_outliers(&mut self, rows: usize, columns: usize, cost: &[f32], outlier: &[f32]) -> f32 {
        self.0.solve_with_outliers(rows, columns, cost, outlier)
    }

    /// Nearest pair first.
    pub fn greedy(&mut self, rows: usize, columns: usize, cost: &[f32]) -> f32 {
        self.0.greedy(rows, columns, cost)
    }
}

/// What an exemplar allows of overlaps.
#[derive(Debug)]
pub struct Clearing(Option<ExemplarClearance>);

impl Clearing {
    /// Measures an exemplar.
    pub fn new(exemplar: &Exemplar<2>) -> Self {
        Self(clearance::measure(exemplar, &Budget::default()).expect(ENOUGH))
    }

    /// Takes overlaps apart. Returns how many pairs there were.
    pub fn repair(&self, request: &Request<2>, placements: &mut Vec<Placement<2>>) -> usize {
        clearance::repair(self.0.as_ref(), request, placements, &Budget::default()).expect(ENOUGH).pairs
    }
}

fn finest(prepared: &Prepared<2>) -> &LevelExemplar<2> {
    let irregular = prepared.irregular(&Budget::default()).expect("the exemplar was analysed");
    irregular.levels.last().expect("there is a level")
}

/// Samples of the finest level that the exemplar shows, per area.
fn density(sampled: &LevelExemplar<2>) -> f64 {
    let inside = sampled.level.position.iter().filter(|p| sampled.library.view.contains(**p)).count();
    inside as f64 / sampled.library.view.measure()
}

fn lay_out(layout: &Layout<'_, 2>) -> Draft<2> {
    layout.initialise(Draft::default(), &mut |_, _| Ok(())).0
}

fn reconstruct(state: &mut State<'_, 2>) {
    let items = state.items().iter().filter(|live| live.alive).map(|live| (live.item, live.turn)).collect();
    std::hint::black_box(placements::placements(&items, state.request, state.extent, state.level.base));
    if state.level.net.is_none() {
        return;
    }
    let votes = collect_votes(state).expect(ENOUGH);
    mend(state, &votes).expect(ENOUGH);
    state.reindex();
    let chains = chains(state, &votes, Params::default().orientations == Switch::On).expect(ENOUGH);
    let position = shape::polish(state, &chains).expect(ENOUGH);
    state.set_positions(position);
    std::hint::black_box(shape::strokes(state, &chains).expect(ENOUGH));
}

/// The neighbourhood of an exemplar sample, as if it were one of the output.
fn surroundings(state: &State<'_, 2>, i: u32) -> Surroundings<2> {
    let level = state.level;
    let row = |near: &Near<2>| Row {
        sample: near.sample,
        key: level.key[near.sample],
        source: level.element[near.sample],
        offset: Vector(near.offset.map(f64::from)),
        weight: near.weight,
        frozen: false,
    };
    let rows = level.neighbours(i).iter().filter(|n| n.weight > 0.0).map(row).collect();
    Surroundings { sample: i, source: level.element[i], rows }
}

/// The first step of a run at its coarsest level.
fn first_search(params: &Params) -> SearchParams {
    SearchParams {
        search: params.search,
        matching: params.matching,
        prices: Prices { missing: params.missing as f32, outside: params.boundary as f32 },
        coherence: params.coherence,
        random: 8,
        thorough: true,
        rounds: 1,
        step: 0,
    }
}
