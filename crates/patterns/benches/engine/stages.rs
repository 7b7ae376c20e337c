//! The stages of the engine one by one, each from the state in which a run meets it first.

use arabesque_core::{Bounds, Domain, Drawn, Exemplar, Placement, Request, Vector};
use divan::Bencher;

use crate::{
    border::Extent,
    curves::{
        draw::{chains::chains, shape},
        repair::mend::mend,
        votes::{edge_votes::collect_votes, edges, tangents},
    },
    exemplar::setting::Setting,
    finish::placements,
    layout::{Draft, Layout},
    optimise::{
        existence,
        matching::{Matcher, Prices, Row, Surroundings},
        positions,
        search::{self, SearchParams},
        targets::class_targets,
    },
    output::state::State,
    params::{Deform, Matching, Params, Switch},
    prepared::Prepared,
};

/// A stage that is timed on its own.
#[derive(Clone, Copy)]
pub(crate) enum Stage {
    /// Patches, from nothing.
    Layout,
    /// The best match of every sample.
    Search,
    /// One pairing of neighbourhoods for every sample.
    Matching,
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

/// Samples of the finest level that the exemplar shows, per area.
fn density(setting: &Setting<2>) -> f64 {
    let level = &setting.level;
    let inside = level.position.iter().filter(|p| setting.library.view.contains(**p)).count();
    inside as f64 / setting.library.view.measure()
}

/// A square page for about `n` samples at the finest level.
pub(crate) fn page(prepared: &Prepared<2>, n: usize) -> Request<2> {
    let setting = prepared.settings.last().expect("there is a level");
    let side = (n as f64 / density(setting)).sqrt();
    Request::new(Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(side))))
}

/// Times one stage for about `n` samples.
pub(crate) fn time(bencher: Bencher, exemplar: &Exemplar<2>, n: usize, stage: Stage) {
    let params = Params::default();
    let prepared = Prepared::new(exemplar, &params).expect("the exemplar can be analysed");
    let request = page(&prepared, n);
    let setting = prepared.settings.last().expect("there is a level");
    let (library, level) = (&*setting.library, &setting.level);
    let extent = Extent::new(&request, &setting.exemplar, &library.radius, level.base);
    let targets = class_targets(library, &request, &extent, level.base);
    let layout = Layout { library, params: &params, request: &request, extent: &extent, base: level.base };
    let lay_out = || layout.initialise(Draft::default(), &mut |_, _| std::ops::ControlFlow::Continue(())).0;
    if let Stage::Layout = stage {
        return bencher.bench_local(lay_out);
    }
    let mut state = State::new(library, level, &request, &extent, (&lay_out(), Deform::Rigid));
    edges::link_sources(&mut state);
    let first = search_params(&params);
    if let Stage::Search = stage {
        return bencher
            .with_inputs(|| state.clone())
            .bench_local_values(|mut state| (search::search(&mut state, &first), state));
    }
    search::search(&mut state, &first);
    timed_after_search(bencher, &state, &targets, stage);
}

fn timed_after_search(bencher: Bencher, state: &State<'_, 2>, targets: &[f64], stage: Stage) {
    if let Stage::Matching = stage {
        return matching(bencher, state);
    }
    let fresh = bencher.with_inputs(|| state.clone());
    match stage {
        Stage::Layout | Stage::Search | Stage::Matching => {}
        Stage::Solve => fresh.bench_local_refs(|state| positions::assign(state)),
        Stage::Existence => fresh.bench_local_values(|mut state| (existence::assign(&mut state, targets, 0.95), state)),
        Stage::Edges => fresh.bench_local_values(|mut state| (edges::assign(&mut state), state)),
        // The first layout knows its edges.
        Stage::Orientations => fresh.bench_local_values(|mut state| {
            tangents::assign(&mut state);
            state
        }),
        Stage::Reconstruct => fresh.bench_local_values(reconstruct),
    }
}

fn reconstruct(mut state: State<'_, 2>) -> (Vec<Placement<2>>, Vec<Drawn<2>>) {
    let items = state.items.iter().filter(|live| live.alive).map(|live| (live.item, live.turn)).collect();
    let placements = placements::placements(&items, state.request, state.extent, state.level.base);
    if state.level.net.is_none() {
        return (placements, Vec::new());
    }
    let votes = collect_votes(&state);
    mend(&mut state, &votes);
    state.reindex();
    let chains = chains(&state, &votes, Params::default().orientations == Switch::On);
    let position = shape::polish(&state, &chains);
    state.samples.iter_mut().zip(position).for_each(|(sample, p)| sample.position = p);
    (placements, shape::strokes(&state, &chains))
}

/// As many pairings as the state has samples, on one thread: neighbourhoods of the exemplar, each with the next of its kind.
fn matching(bencher: Bencher, state: &State<'_, 2>) {
    let prices = Prices { missing: 1.0, outside: 0.0 };
    let mut matcher = Matcher::new(state.level, state.library, Matching::Robust, prices);
    let level = state.level;
    let around: Vec<_> = (0..level.position.len() as u32).map(|i| surroundings(state, i)).collect();
    let next = |i: usize| {
        let alike = &level.of_key[level.key[i] as usize];
        alike[(i + 1) % alike.len()]
    };
    bencher.bench_local(|| {
        let one = |k: usize| matcher.cost(&around[k % around.len()], next(k % around.len()), f32::INFINITY, &|_| true);
        (0..state.living.len()).map(one).sum::<f32>()
    });
}

/// The neighbourhood of an exemplar sample, as if it were one of the output.
fn surroundings(state: &State<'_, 2>, i: u32) -> Surroundings<2> {
    let level = state.level;
    let row = |near: &crate::exemplar::level::Near<2>| Row {
        sample: near.sample,
        key: level.key[near.sample as usize],
        source: level.element[near.sample as usize],
        offset: Vector(near.offset.map(f64::from)),
        weight: near.weight,
        frozen: false,
        star: level.stars[near.sample as usize],
    };
    let rows = level.neighbours(i).iter().filter(|n| n.weight > 0.0).map(row).collect();
    Surroundings { source: level.element[i as usize], star: level.stars[i as usize], rows }
}

/// The first step of a run at its coarsest level.
fn search_params(params: &Params) -> SearchParams {
    SearchParams {
        search: params.search,
        matching: params.matching,
        prices: Prices { missing: params.missing as f32, outside: params.boundary as f32 },
        coherence: params.coherence,
        random: 8,
        rounds: 1,
        step: 0,
    }
}

/// One thread, unless `RAYON_NUM_THREADS` says otherwise.
pub(crate) fn set_threads() {
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");
    }
}
