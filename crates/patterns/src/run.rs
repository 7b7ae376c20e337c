//! One run: initialise, then level by level search and assign, then place and draw.

use std::ops::ControlFlow;

use arabesque_core::{Drawn, EnergyPoint, Matrix, Numbered, Progress, Request, Snapshot, Vector, Watch};

use crate::{
    border::Extent,
    curves::{
        draw::{
            chains::{self, Chain},
            resample, shape,
        },
        repair::mend,
        votes::{edge_votes, edges, tangents},
    },
    dimension::Dimension,
    exemplar::level_exemplar::LevelExemplar,
    finish::placements,
    frozen,
    layout::{Layout, grains},
    optimise::{
        attributes,
        existence::{self, Changes},
        matching::Prices,
        positions,
        search::{self, SearchParams},
    },
    output::{
        draft::{Draft, Item},
        state::State,
    },
    params::{Attributes, Existence, Initialisation, Params, Search, Switch},
};

/// Share of the progress that the first layout counts for.
const LAYOUT_SHARE: f64 = 0.2;

/// From white noise, elements are removed down to this share of their number at first: what is wrong everywhere is
/// better thinned out and grown again.
const NOISE_FLOOR: f64 = 0.3;

/// Elements are never removed below this share of their number at the end, and not at all below it after patch copy.
const FLOOR: f64 = 0.95;

/// Moves below this share of the mean spacing do not make the neighbours search again.
const NOTICEABLE: f64 = 0.01;

/// The same where there are curves, whose samples are never quite still.
const NOTICEABLE_STROKES: f64 = 0.04;

/// A level, with what it means for the request.
pub(crate) struct LevelContext<'a, const D: usize> {
    pub(crate) sampled: &'a LevelExemplar<D>,
    pub(crate) extent: &'a Extent<'a, D>,
    /// Elements of each class that the output should have.
    pub(crate) targets: &'a Numbered<f64>,
}

/// What one run works on.
pub(crate) struct Run<'a, const D: usize> {
    pub(crate) params: &'a Params,
    pub(crate) request: &'a Request<D>,
    /// The levels that are used, coarsest first.
    pub(crate) contexts: Vec<LevelContext<'a, D>>,
    /// Iterations per level.
    pub(crate) iterations: usize,
}

/// A level as it ended.
struct Finished<const D: usize> {
    /// What the next level starts from, or after the last one, the elements.
    draft: Draft<D>,
    bends: Option<Vec<placements::Bend<D>>>,
    curves: Vec<Drawn<D>>,
}

impl<const D: usize> Run<'_, D>
where
    Vector<D>: Dimension<D>,
{
    /// Everything up to the clearance check, in the state in which the watch left it.
    pub(crate) fn synthesise(
        &self,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> (Snapshot<D>, ControlFlow<()>) {
        let mut flow = ControlFlow::Continue(());
        let mut done = Finished { draft: Draft::default(), bends: None, curves: Vec::new() };
        let from_noise = self.params.initialisation == Initialisation::WhiteNoise;
        if let Some(context) = if from_noise { self.contexts.first() } else { self.contexts.last() } {
            let frozen = frozen::draft(self.request, context.sampled);
            let layout = self.layout(context);
            (done.draft, flow) = layout.initialise(frozen, &mut |items, share| {
                watch.step(&self.laid_out(items.len(), share), &|| self.layout_preview(context, items))
            });
            if !from_noise {
                done.draft = self.coarsened(&done.draft);
            }
        }
        for k in 0..self.contexts.len() {
            if flow.is_break() && k > 0 {
                break;
            }
            (done, flow) = self.level(k, &done.draft, flow, trace, watch);
        }
        (self.result(&done), flow)
    }

    /// A layout of the finest level, as the coarsest one sees it: patches agree best where they are sampled most
    /// densely.
    fn coarsened(&self, draft: &Draft<D>) -> Draft<D> {
        let (Some(finest), Some(coarsest)) = (self.contexts.last(), self.contexts.first()) else {
            return draft.clone();
        };
        let mut state = self.state(finest, draft);
        edges::link_sources(&mut state);
        match &coarsest.sampled.level.net {
            Some(net)
                if self.contexts.len() > 1 && !std::ptr::eq(&**net, state.level.net.as_deref().unwrap_or(net)) =>
            {
                let chains = self.chains(&mut state);
                let frozen = frozen::draft(self.request, coarsest.sampled);
                resample::resample(&state, &chains, net, coarsest.sampled.level.base, frozen)
            }
            _ => draft.clone(),
        }
    }

    fn layout<'s>(&'s self, context: &LevelContext<'s, D>) -> Layout<'s, D> {
        Layout {
            library: &context.sampled.library,
            params: self.params,
            request: self.request,
            extent: context.extent,
            base: context.sampled.level.base,
        }
    }

    fn result(&self, done: &Finished<D>) -> Snapshot<D> {
        let Some(context) = self.contexts.last() else { return Snapshot::default() };
        let mut placements =
            placements::placements(&done.draft.items, self.request, context.extent, context.sampled.level.base);
        for (placement, control) in placements.iter_mut().zip(done.bends.iter().flatten()) {
            placement.control.clone_from(control);
        }
        Snapshot { placements, curves: done.curves.clone(), ..Snapshot::default() }
    }

    fn laid_out(&self, elements: usize, share: f64) -> Progress {
        Progress {
            stage: "laying out".into(),
            done: (100.0 * share) as usize,
            total: 100,
            fraction: LAYOUT_SHARE * share,
            energy: None,
            count: elements,
        }
    }

    fn search_params(&self, k: usize, iteration: usize) -> SearchParams {
        let params = self.params;
        let first = iteration.is_multiple_of(self.iterations);
        SearchParams {
            search: params.search,
            matching: params.matching,
            prices: Prices { missing: params.missing as f32, outside: params.boundary as f32 },
            coherence: params.coherence,
            random: if first { 8 } else { 2 },
            rounds: match (params.search, first) {
                (Search::PatchMatch, true) => 5,
                (Search::PatchMatch, false) => 2,
                _ => 1,
            },
            step: (k * 10_000 + iteration) as u64,
        }
    }

    /// Share of the target numbers below which no element is removed.
    fn floor(&self, k: usize, iteration: usize) -> f64 {
        if self.params.initialisation != Initialisation::WhiteNoise {
            return FLOOR;
        }
        let done = (k as f64 + iteration as f64 / self.iterations.max(1) as f64) / self.contexts.len() as f64;
        (NOISE_FLOOR + done).min(FLOOR)
    }

    /// After `done` iterations at level `k`.
    fn progress(&self, k: usize, done: usize, state: &State<'_, D>) -> Progress {
        let (levels, expected) = (self.contexts.len(), self.iterations.max(1));
        let within = (done as f64 / expected as f64).min(1.0);
        Progress {
            stage: format!("level {} of {levels}", k + 1).into(),
            done,
            // A second round on the same level is more than was expected.
            total: self.iterations * done.div_ceil(expected).max(1),
            fraction: (LAYOUT_SHARE + (1.0 - LAYOUT_SHARE) * (k as f64 + within) / levels as f64).min(1.0),
            energy: (done > 0).then(|| state.energy()),
            count: state.count(),
        }
    }

    /// The elements alone: strokes are not known before the samples are joined.
    fn layout_preview(&self, context: &LevelContext<'_, D>, items: &[Item<D>]) -> Snapshot<D> {
        let items = items.iter().map(|&item| (item, Matrix::identity())).collect();
        let placements = placements::placements(&items, self.request, context.extent, context.sampled.level.base);
        let state = self.state(context, &Draft { items, links: Vec::new() });
        Snapshot { placements, curves: self.strokes(state), ..Snapshot::default() }
    }

    fn state<'s>(&'s self, context: &LevelContext<'s, D>, draft: &Draft<D>) -> State<'s, D> {
        State::new(context.sampled, self.request, context.extent, self.params.deform, draft)
    }

    /// Search and assign at one level, then mend and hand over to the next.
    fn level(
        &self,
        k: usize,
        draft: &Draft<D>,
        mut flow: ControlFlow<()>,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> (Finished<D>, ControlFlow<()>) {
        let context = &self.contexts[k];
        let mut state = self.state(context, draft);
        edges::link_sources(&mut state);
        if k > 0 && flow.is_continue() {
            // Handing over takes as long as iterations do, and strokes have come out finer.
            flow = watch.step(&self.progress(k, 0, &state), &|| self.snapshot(context, &state));
        }
        if flow.is_continue() {
            flow = self.refine(k, 0, &mut state, trace, watch);
        }
        if k == 0 && flow.is_continue() && self.may_regrow() {
            flow = self.regrow(&mut state, trace, watch);
        }
        let params = self.params;
        if params.existence == Existence::Voted && flow.is_continue() {
            self.layout(context).fill_holes(&mut state);
            edges::link_sources(&mut state);
        }
        (self.finish(k, state, flow), flow)
    }

    /// Patches that agree with one another are as much order as there is to find; any other start may have ended in
    /// disorder.
    fn may_regrow(&self) -> bool {
        let params = self.params;
        params.regrowth == Switch::On && params.initialisation != Initialisation::PatchCopy && self.iterations > 0
    }

    /// Grows a coarsest level anew that ended in disorder, and refines it once more.
    fn regrow<'s>(
        &'s self,
        state: &mut State<'s, D>,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> ControlFlow<()> {
        let (Some(nucleus), Some(context)) = (grains::nucleus(state), self.contexts.first()) else {
            return ControlFlow::Continue(());
        };
        let known = self.progress(0, self.iterations, state);
        let frozen = frozen::draft(self.request, context.sampled);
        let (draft, flow) = self.layout(context).regrow(frozen, &nucleus.items, &mut |items, _| {
            watch.step(&Progress { count: items.len(), ..known.clone() }, &|| self.layout_preview(context, items))
        });
        *state = self.state(context, &draft);
        edges::link_sources(state);
        flow?;
        self.refine(0, self.iterations, state, trace, watch)
    }

    /// Iterations at level `k`; `before` is how many there were already.
    fn refine(
        &self,
        k: usize,
        before: usize,
        state: &mut State<'_, D>,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> ControlFlow<()> {
        for iteration in before..before + self.iterations {
            let searched = search::search(state, &self.search_params(k, iteration));
            trace.push(EnergyPoint { level: k, iteration, energy: state.energy(), elements: state.count() });
            let changed = self.assign(state, &self.contexts[k], self.floor(k, iteration));
            watch.step(&self.progress(k, iteration + 1, state), &|| self.snapshot(&self.contexts[k], state))?;
            if !changed || searched == 0 {
                break;
            }
        }
        ControlFlow::Continue(())
    }

    /// One assignment step: attributes, positions, existence, edges, tangents. Returns whether anything changed.
    fn assign(&self, state: &mut State<'_, D>, context: &LevelContext<'_, D>, floor: f64) -> bool {
        let exchanged = match self.params.attributes {
            Attributes::Selected => attributes::assign(state),
            Attributes::Kept => 0,
        };
        let mut position = positions::assign(state);
        let changes = match self.params.existence {
            Existence::Voted => existence::assign(state, context.targets, floor),
            Existence::Fixed => Changes::default(),
        };
        position.extend(state.samples().iter().skip(position.len()).map(|s| s.position));
        state.follow_samples(&position);
        let (_, joined) = edges::assign(state);
        tangents::assign(state);
        let noticeable = if state.level.net.is_some() { NOTICEABLE_STROKES } else { NOTICEABLE };
        let moved = state.announce_moves(noticeable * state.library.spacing * context.extent.smallest_spacing_scale);
        state.reindex();
        moved || exchanged + joined > 0 || changes != Changes::default()
    }

    /// What a level leaves: elements and, for the next level, denser samples along its strokes; after the last level,
    /// the strokes.
    fn finish(&self, k: usize, mut state: State<'_, D>, flow: ControlFlow<()>) -> Finished<D> {
        let base = state.level.base;
        let bends = placements::bends(&state);
        let next = self.contexts.get(k + 1).filter(|_| flow.is_continue());
        let finer = next.and_then(|next| next.sampled.level.net.as_deref().map(|net| (next, net)));
        let Some((next, net)) = finer else {
            let items = living(&state).into_iter().filter(|(item, _)| next.is_some() || item.source < base).collect();
            let curves = if next.is_some() { Vec::new() } else { self.strokes(state) };
            return Finished { draft: Draft { items, links: Vec::new() }, bends, curves };
        };
        if std::ptr::eq(net, state.level.net.as_deref().unwrap_or(net)) {
            return Finished { draft: self.as_it_is(state), bends, curves: Vec::new() };
        }
        let chains = self.chains(&mut state);
        let frozen = frozen::draft(self.request, next.sampled);
        let draft = resample::resample(&state, &chains, net, next.sampled.level.base, frozen);
        Finished { draft, bends, curves: Vec::new() }
    }

    /// Everything that lives, for a level with the same samples.
    fn as_it_is(&self, mut state: State<'_, D>) -> Draft<D> {
        if self.params.mending == Switch::On {
            let votes = edge_votes::collect_votes(&state);
            mend::mend(&mut state, &votes);
        }
        let mut number = Numbered::filled(u32::MAX, state.items().len());
        let living_items = (0..state.items().len()).filter(|&i| state.items()[i].alive);
        living_items.zip(0..).for_each(|(i, n)| number[i] = n);
        let item = |s: u32| number[state.sample(s).item];
        let pairs = state.samples().numbers().flat_map(|s| state.links_of(s).iter().map(move |&o| (s, o)));
        let links = pairs.filter(|(s, o)| s < o).map(|(s, o)| (item(s), item(o))).collect();
        Draft { items: living(&state), links }
    }

    /// The strokes of a state: mended, chained, and the samples moved to where the exemplar's shapes fit best.
    fn chains(&self, state: &mut State<'_, D>) -> Vec<Chain> {
        let params = self.params;
        let votes = edge_votes::collect_votes(state);
        if params.mending == Switch::On {
            mend::mend(state, &votes);
            state.reindex();
        }
        let chains = chains::chains(state, &votes, params.orientations == Switch::On);
        if params.shapes == Switch::On {
            let position = shape::polish(state, &chains);
            state.set_positions(position);
        }
        chains
    }

    fn strokes(&self, mut state: State<'_, D>) -> Vec<Drawn<D>> {
        if state.level.net.is_none() {
            return Vec::new();
        }
        let chains = self.chains(&mut state);
        shape::strokes(&state, &chains)
    }

    fn snapshot(&self, context: &LevelContext<'_, D>, state: &State<'_, D>) -> Snapshot<D> {
        let base = state.level.base;
        let mut placements = placements::placements(&living(state), self.request, context.extent, base);
        for (placement, control) in placements.iter_mut().zip(placements::bends(state).into_iter().flatten()) {
            placement.control = control;
        }
        Snapshot { placements, curves: self.strokes(state.clone()), ..Snapshot::default() }
    }
}

fn living<const D: usize>(state: &State<'_, D>) -> Vec<(Item<D>, Matrix<D>)> {
    state.items().iter().filter(|live| live.alive).map(|live| (live.item, live.turn)).collect()
}
