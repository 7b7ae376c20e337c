//! One run: initialise, then level by level search and assign, then place and draw.

use std::cell::OnceCell;

use arabesque_core::{Drawn, EnergyPoint, Error, Matrix, Numbered, Progress, Request, Result, Snapshot, Vector, Watch};

use crate::{
    border::Extent,
    curves::{
        draw::resample,
        repair::mend,
        strokes,
        votes::{
            edge_votes::{self, Votes},
            edges, tangents,
        },
    },
    dimension::Dimension,
    ending::{heard, last_touches},
    evenness::Evenness,
    exemplar::level_exemplar::LevelExemplar,
    finish::placements,
    frozen,
    layout::{Layout, grains},
    optimise::{
        attributes, between,
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

/// Iterations of a level before it may be at rest, of elements and where there are strokes, at the coarsest level and then: strokes join
/// while the energy hardly falls.
const SETTLING: (usize, [usize; 2]) = (1, [3, 2]);

/// Moves below this share of the mean spacing do not make the neighbours search again.
const NOTICEABLE: f64 = 0.06;

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
    /// How even the exemplar is; `None` where the page is left as it is.
    pub(crate) evenness: Option<&'a Evenness<D>>,
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

/// What there was when a run was cut short, and why.
struct CutShort<'s, const D: usize> {
    state: State<'s, D>,
    votes: Votes,
    error: Error,
}

/// What a run made, and what cut it short, if anything did.
pub(crate) struct Made<const D: usize> {
    pub(crate) snapshot: Snapshot<D>,
    pub(crate) cut_short: Option<Error>,
}

impl<const D: usize> Run<'_, D>
where
    Vector<D>: Dimension<D>,
{
    /// Everything up to the clearance check: where the run is cut short, the best so far.
    ///
    /// # Errors
    /// When it is cut short before there is anything.
    pub(crate) fn synthesise(
        &self,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<Made<D>> {
        let from_noise = self.params.initialisation == Initialisation::WhiteNoise;
        let first = if from_noise { self.contexts.first() } else { self.contexts.last() };
        let Some(context) = first else { return Ok(Made { snapshot: Snapshot::default(), cut_short: None }) };
        let frozen = frozen::draft(self.request, context.sampled)?;
        let layout = self.layout(context);
        let (laid_out, ended) = layout.initialise(frozen, &mut |items, share| {
            let progress = self.laid_out(items.len(), share);
            heard(watch.step(&progress, &|| self.layout_preview(context, items)), &progress)
        });
        let coarsened = match ended {
            Ok(()) if from_noise => Ok(laid_out.clone()),
            Ok(()) => self.coarsened(&laid_out),
            Err(error) => Err(error),
        };
        let mut done = match coarsened {
            Ok(draft) => Finished { draft, bends: None, curves: Vec::new() },
            Err(error) => {
                let state = self.state(context, &laid_out);
                return self.best_so_far(CutShort { state, votes: Votes::default(), error });
            }
        };
        for k in 0..self.contexts.len() {
            match self.level(k, &done.draft, trace, watch) {
                Ok(finished) => done = finished,
                Err(cut) => return self.best_so_far(*cut),
            }
        }
        Ok(Made { snapshot: self.result(&done, self.contexts.last()), cut_short: None })
    }

    /// A layout of the finest level, as the coarsest one sees it: patches agree best where they are sampled most
    /// densely.
    fn coarsened(&self, draft: &Draft<D>) -> Result<Draft<D>> {
        let (Some(finest), Some(coarsest)) = (self.contexts.last(), self.contexts.first()) else {
            return Ok(draft.clone());
        };
        let mut state = self.state(finest, draft);
        edges::link_sources(&mut state)?;
        match &coarsest.sampled.level.net {
            Some(net)
                if self.contexts.len() > 1 && !std::ptr::eq(&**net, state.level.net.as_deref().unwrap_or(net)) =>
            {
                let chains = strokes::chains(self.params, &mut state)?;
                let frozen = frozen::draft(self.request, coarsest.sampled)?;
                resample::resample(&state, &chains, net, coarsest.sampled.level.base, frozen)
            }
            _ => Ok(draft.clone()),
        }
    }

    /// The result of a run that was cut short: its strokes mended and fitted where that is done at once, else as they
    /// are.
    fn best_so_far(&self, cut: CutShort<'_, D>) -> Result<Made<D>> {
        let CutShort { mut state, votes, error } = cut;
        if !matches!(error, Error::Stopped { .. } | Error::Limit { .. }) {
            return Err(error);
        }
        let frozen = state.items().iter().filter(|live| live.item.frozen.is_some()).count();
        if state.count() == frozen {
            return Err(error);
        }
        state.drop_dead_links();
        if votes.candidates.is_empty() {
            // No step has joined samples yet.
            state.budget = self.request.budget.fresh();
            edges::link_sources(&mut state)?;
        }
        let curves = match strokes::strokes(self.params, state.on(last_touches(&self.request.budget))) {
            Err(Error::Limit { .. }) => strokes::plain(self.params, &state.on(self.request.budget.fresh()), &votes)?,
            curves => curves?,
        };
        let base = state.level.base;
        let items = living(&state).into_iter().filter(|(item, _)| item.source < base).collect();
        let bends = placements::bends(&state);
        let context = self.contexts.iter().find(|context| std::ptr::eq(&context.sampled.level, state.level));
        let done = Finished { draft: Draft { items, links: Vec::new() }, bends, curves };
        Ok(Made { snapshot: self.result(&done, context), cut_short: Some(error) })
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

    fn result(&self, done: &Finished<D>, context: Option<&LevelContext<'_, D>>) -> Snapshot<D> {
        let Some(context) = context else { return Snapshot::default() };
        let mut placements =
            placements::placements(&done.draft.items, self.request, context.extent, context.sampled.level.base);
        for (placement, control) in placements.iter_mut().zip(done.bends.iter().flatten()) {
            placement.control.clone_from(control);
        }
        Snapshot { placements, curves: done.curves.clone(), ..Snapshot::default() }
    }

    /// What is told before overlaps are mended.
    pub(crate) fn mending(&self, snapshot: &Snapshot<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<()> {
        let count = snapshot.placements.len();
        let stage = "mending overlaps".into();
        let progress = Progress { stage, done: 0, total: 1, fraction: 1.0, energy: None, count };
        heard(watch.step(&progress, &|| snapshot.clone()), &progress)
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

    fn has_strokes(&self) -> bool {
        self.contexts.iter().any(|context| context.sampled.level.net.is_some())
    }

    fn search_params(&self, k: usize, iteration: usize) -> SearchParams {
        let params = self.params;
        let done = iteration % self.iterations.max(1);
        let first = done == 0;
        SearchParams {
            search: params.search,
            matching: params.matching,
            prices: Prices { missing: params.missing as f32, outside: params.boundary as f32 },
            coherence: params.coherence,
            random: match (params.search, first) {
                (_, true) => 8,
                (Search::KCoherence, false) => 0,
                (_, false) => 2,
            },
            rounds: match (params.search, first) {
                (Search::PatchMatch, true) => 5,
                (Search::PatchMatch, false) => 2,
                _ => 1,
            },
            thorough: first || params.search != Search::KCoherence || self.has_strokes(),
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
        Snapshot { placements, curves: self.preview_strokes(&state), ..Snapshot::default() }
    }

    fn state<'s>(&'s self, context: &LevelContext<'s, D>, draft: &Draft<D>) -> State<'s, D> {
        State::new(context.sampled, self.request, context.extent, self.params.deform, draft)
    }

    /// Search and assign at one level, then mend and hand over to the next.
    fn level<'s>(
        &'s self,
        k: usize,
        draft: &Draft<D>,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> std::result::Result<Finished<D>, Box<CutShort<'s, D>>> {
        let mut state = self.state(&self.contexts[k], draft);
        let mut votes = Votes::default();
        let worked = self.work(k, &mut state, &mut votes, trace, watch);
        match worked.and_then(|()| self.finish(k, &mut state)) {
            Ok(finished) => Ok(finished),
            Err(error) => Err(Box::new(CutShort { state, votes, error })),
        }
    }

    /// What is done at one level. An error leaves the state as it was before the step that was cut short.
    fn work<'s>(
        &'s self,
        k: usize,
        state: &mut State<'s, D>,
        votes: &mut Votes,
        trace: &mut Vec<EnergyPoint>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<()> {
        let context = &self.contexts[k];
        edges::link_sources(state)?;
        if k > 0 {
            // Handing over takes as long as iterations do, and strokes have come out finer.
            let progress = self.progress(k, 0, state);
            heard(watch.step(&progress, &|| self.snapshot(context, state)), &progress)?;
        }
        let mut steps = Steps { k, before: 0, votes, trace };
        self.refine(&mut steps, state, watch)?;
        if k == 0 && self.may_regrow() {
            self.regrow(&mut steps, state, watch)?;
        }
        // Elements are put into holes once more when the page is evened out; at finer levels, what is put there comes and goes.
        let has_holes = k == 0 || self.has_strokes() || self.evenness.is_none();
        if has_holes && self.params.existence == Existence::Voted {
            self.layout(context).fill_holes(state)?;
            edges::link_sources(state)?;
        }
        if k + 1 == self.contexts.len() {
            self.even_out(k, state, watch)?;
        }
        Ok(())
    }

    /// Mends holes and clumps that the exemplar does not have. An error leaves the state as far as it has come.
    fn even_out(&self, k: usize, state: &mut State<'_, D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<()> {
        let (context, Some(evenness)) = (&self.contexts[k], self.evenness) else { return Ok(()) };
        let known = Progress { stage: "evening out".into(), ..self.progress(k, self.iterations, state) };
        let curves = OnceCell::new();
        let (evened, ended) = evenness.even_out(state, context.targets, self.params, &mut |items| {
            let progress = Progress { count: items.len(), ..known.clone() };
            let preview = || {
                let placements = placements::placements(items, self.request, context.extent, state.level.base);
                let curves = curves.get_or_init(|| self.preview_strokes(state)).clone();
                Snapshot { placements, curves, ..Snapshot::default() }
            };
            heard(watch.step(&progress, &preview), &progress)
        })?;
        evened.write_back(state);
        ended
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
        steps: &mut Steps<'_>,
        state: &mut State<'s, D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<()> {
        let (Some(nucleus), Some(context)) = (grains::nucleus(state), self.contexts.first()) else {
            return Ok(());
        };
        let known = self.progress(0, self.iterations, state);
        let frozen = frozen::draft(self.request, context.sampled)?;
        let (draft, ended) = self.layout(context).regrow(frozen, &nucleus.items, &mut |items, _| {
            let progress = Progress { count: items.len(), ..known.clone() };
            heard(watch.step(&progress, &|| self.layout_preview(context, items)), &progress)
        });
        // A page that is grown in part is worse than one in disorder.
        ended?;
        let mut grown = self.state(context, &draft);
        edges::link_sources(&mut grown)?;
        *state = grown;
        *steps.votes = Votes::default();
        steps.before = self.iterations;
        self.refine(steps, state, watch)
    }

    /// Iterations at one level.
    fn refine(
        &self,
        steps: &mut Steps<'_>,
        state: &mut State<'_, D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<()> {
        let k = steps.k;
        // What starts in disorder gains and loses elements for a while, and its strokes join when the energy has long come to rest.
        let is_ordered = self.params.initialisation != Initialisation::WhiteNoise;
        let settling = if self.has_strokes() { SETTLING.1[k.min(1)] } else { SETTLING.0 };
        let rest = if is_ordered && self.params.rest > 0.0 { self.params.rest } else { f64::NEG_INFINITY };
        let mut before = f64::INFINITY;
        for iteration in steps.before..steps.before + self.iterations {
            let searched = search::search(state, &self.search_params(k, iteration))?;
            let energy = state.energy();
            steps.trace.push(EnergyPoint { level: k, iteration, energy, elements: state.count() });
            let changed = self.assign(state, &self.contexts[k], self.floor(k, iteration), steps.votes)?;
            let progress = self.progress(k, iteration + 1, state);
            heard(watch.step(&progress, &|| self.snapshot(&self.contexts[k], state)), &progress)?;
            let is_at_rest = iteration >= steps.before + settling && energy > (1.0 - rest) * before;
            if !changed || searched == 0 || is_at_rest {
                break;
            }
            before = energy;
        }
        Ok(())
    }

    /// One assignment step: attributes, positions, existence, edges, tangents. Returns whether anything changed.
    fn assign(
        &self,
        state: &mut State<'_, D>,
        context: &LevelContext<'_, D>,
        floor: f64,
        votes: &mut Votes,
    ) -> Result<bool> {
        let exchanged = match self.params.attributes {
            Attributes::Selected => attributes::assign(state)?,
            Attributes::Kept => 0,
        };
        let mut position = positions::assign(state)?;
        let changes = match self.params.existence {
            Existence::Voted => existence::assign(state, context.targets, floor)?,
            Existence::Fixed => Changes::default(),
        };
        position.extend(state.samples().iter().skip(position.len()).map(|s| s.position));
        state.follow_samples(&position);
        let joined;
        (*votes, joined) = edges::assign(state)?;
        tangents::assign(state)?;
        between::step(state)?;
        let moved = state.announce_moves(NOTICEABLE * state.library.spacing * context.extent.smallest_spacing_scale);
        state.reindex();
        Ok(moved || exchanged + joined > 0 || changes != Changes::default())
    }

    /// What a level leaves: elements and, for the next level, denser samples along its strokes; after the last level,
    /// the strokes.
    fn finish(&self, k: usize, state: &mut State<'_, D>) -> Result<Finished<D>> {
        let base = state.level.base;
        let bends = placements::bends(state);
        let next = self.contexts.get(k + 1);
        let finer = next.and_then(|next| next.sampled.level.net.as_deref().map(|net| (next, net)));
        let Some((next, net)) = finer else {
            let items = living(state).into_iter().filter(|(item, _)| next.is_some() || item.source < base).collect();
            let curves = if next.is_some() { Vec::new() } else { strokes::strokes(self.params, state.clone())? };
            return Ok(Finished { draft: Draft { items, links: Vec::new() }, bends, curves });
        };
        if std::ptr::eq(net, state.level.net.as_deref().unwrap_or(net)) {
            return Ok(Finished { draft: self.as_it_is(state)?, bends, curves: Vec::new() });
        }
        let chains = strokes::chains(self.params, state)?;
        let frozen = frozen::draft(self.request, next.sampled)?;
        let draft = resample::resample(state, &chains, net, next.sampled.level.base, frozen)?;
        Ok(Finished { draft, bends, curves: Vec::new() })
    }

    /// Everything that lives, for a level with the same samples.
    fn as_it_is(&self, state: &mut State<'_, D>) -> Result<Draft<D>> {
        if self.params.mending == Switch::On {
            let votes = edge_votes::collect_votes(state)?;
            mend::mend(state, &votes)?;
        }
        let mut number = Numbered::filled(u32::MAX, state.items().len());
        let living_items = (0..state.items().len()).filter(|&i| state.items()[i].alive);
        living_items.zip(0..).for_each(|(i, n)| number[i] = n);
        let item = |s: u32| number[state.sample(s).item];
        let pairs = state.samples().numbers().flat_map(|s| state.links_of(s).iter().map(move |&o| (s, o)));
        let links = pairs.filter(|(s, o)| s < o).map(|(s, o)| (item(s), item(o))).collect();
        Ok(Draft { items: living(state), links })
    }

    /// The strokes for a preview, on an account of its own: how often somebody looks must not change the result. None
    /// where somebody asks to stop.
    fn preview_strokes(&self, state: &State<'_, D>) -> Vec<Drawn<D>> {
        strokes::strokes(self.params, state.on(self.request.budget.fresh())).unwrap_or_default()
    }

    fn snapshot(&self, context: &LevelContext<'_, D>, state: &State<'_, D>) -> Snapshot<D> {
        let base = state.level.base;
        let mut placements = placements::placements(&living(state), self.request, context.extent, base);
        for (placement, control) in placements.iter_mut().zip(placements::bends(state).into_iter().flatten()) {
            placement.control = control;
        }
        Snapshot { placements, curves: self.preview_strokes(state), ..Snapshot::default() }
    }
}

/// How far a level is, and what is kept of its steps.
struct Steps<'a> {
    k: usize,
    /// Iterations that were done before.
    before: usize,
    /// The votes of the last step.
    votes: &'a mut Votes,
    trace: &'a mut Vec<EnergyPoint>,
}

fn living<const D: usize>(state: &State<'_, D>) -> Vec<(Item<D>, Matrix<D>)> {
    state.items().iter().filter(|live| live.alive).map(|live| (live.item, live.turn)).collect()
}
