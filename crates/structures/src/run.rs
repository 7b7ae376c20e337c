//! The multi-scale loop [Roveri 2015, algorithm 1].

use std::ops::ControlFlow;

use arabesque_core::{Budget, EnergyPoint, Error, PointSet, Progress, Result, StopReason, Vector, Warning, Watch};

use crate::{
    energy::{
        kernel::Kernel,
        level::{Level, Matches, Tables},
    },
    layout::Layout,
    output::{
        finish::{Finished, finish, kept, sources},
        parts::groups,
        state::Output,
    },
    params::Start,
    prepared::Prepared,
    request::{StructureOutcome, StructureRequest},
    solve::{
        matching::{Round, anywhere, matching, room},
        part::Part,
        round::round,
    },
    start::{gaps::fill, grow::grow, noise::noise, patches::patches, shake::shake},
};

/// Work that a point of the result takes, about: along curves and on surfaces, and in volumes, where its surroundings hold more.
const EACH: [f64; 2] = [6e5, 3.5e6];
/// The smallest window, in units of the first one.
const SMALLEST: f64 = 0.5;
/// How far points are shaken, in units of how much their distances vary.
const SHAKE: f64 = 2.7;
/// So many times as many rounds and tries where the start was not fitted to anything.
const UNFITTED: usize = 3;
/// The same for volumes: the exemplar has many more places to choose from, and each fits less often.
const DEEP: usize = 2;
/// When more than this share of the sites is in motion, the rest is not left out.
const WHOLE: f64 = 0.6;
/// Rounds for the first matches, where the start brings none along.
const FIRST: u64 = 4;

/// Window and width of the Gaussians of one level.
#[derive(Clone, Copy, Debug)]
struct Scale {
    delta: f64,
    sigma: f64,
    /// Its layout.
    layout: usize,
}

/// What all levels share.
struct Stage<'a, const D: usize> {
    prepared: &'a Prepared<D>,
    request: &'a StructureRequest<D>,
    budget: Budget,
    /// The sites of the last levels, then those of wider windows, which are farther apart.
    layouts: Vec<Layout<D>>,
    scales: Vec<Scale>,
    /// Matches of the first sites, where these are done already.
    done: Vec<Option<Vector<D>>>,
}

/// How far a run is.
struct State<const D: usize> {
    output: Output<D>,
    matches: Vec<Vector<D>>,
    /// The layout of which these are the matches.
    layout: usize,
    /// The level that was begun last; `None` before the first.
    level: Option<usize>,
    /// Sites that may change; `None` for all.
    within: Option<Vec<bool>>,
    energy: Vec<EnergyPoint>,
    stopped: StopReason,
}

impl<const D: usize> Prepared<D> {
    /// Makes as much as the request wants. Stopped early, it gives the best so far.
    ///
    /// # Errors
    /// When the territory has no room, when a kept point is no number, or when the budget is used up before there are points.
    pub fn run(
        &self,
        request: &StructureRequest<D>,
        watch: &mut dyn Watch<PointSet<D>>,
    ) -> Result<StructureOutcome<D>> {
        let stage = Stage::new(self, request)?;
        let count = stage.layouts[0].expected(self);
        let each = EACH[usize::from(self.repeats() > 2)];
        watch.foreseen(&stage.budget.forecast(count, count * each));
        let start = kept(&self.pattern, &request.kept)?;
        let mut state = State::of(start, Vec::new());
        stage.levels(&mut state, watch)?;
        stage.outcome(state)
    }
}

/// What a stroke of a brush begins with.
pub(crate) struct Begun<const D: usize> {
    /// The sites that were there near it, then its own.
    pub(crate) layout: Layout<D>,
    /// The points that are there.
    pub(crate) output: Output<D>,
    /// The matches of the sites that were there.
    pub(crate) matches: Vec<Vector<D>>,
    /// For each site whether it may change.
    pub(crate) within: Vec<bool>,
}

/// What came of a stroke.
pub(crate) struct Ended<const D: usize> {
    pub(crate) output: Output<D>,
    pub(crate) matches: Vec<Vector<D>>,
    pub(crate) energy: Vec<EnergyPoint>,
    pub(crate) stopped: StopReason,
}

/// Goes on from what is there: new sites are grown, and those that may change are optimised.
pub(crate) fn go_on<const D: usize>(
    prepared: &Prepared<D>,
    request: &StructureRequest<D>,
    begun: Begun<D>,
    watch: &mut dyn Watch<PointSet<D>>,
) -> Result<Ended<D>> {
    let Begun { layout, output, matches, within } = begun;
    let done = matches.into_iter().map(Some).collect();
    let stage = Stage::on(prepared, request, (layout, done));
    let mut state = State { within: Some(within), ..State::of(output, Vec::new()) };
    stage.levels(&mut state, watch)?;
    let State { output, matches, energy, stopped, .. } = state;
    Ok(Ended { output, matches, energy, stopped })
}

/// The outcome of points and matches as they are.
pub(crate) fn finished<const D: usize>(
    prepared: &Prepared<D>,
    request: &StructureRequest<D>,
    layout: Layout<D>,
    (output, matches): (Output<D>, Vec<Vector<D>>),
) -> Result<StructureOutcome<D>> {
    Stage::on(prepared, request, (layout, Vec::new())).outcome(State::of(output, matches))
}

impl<const D: usize> State<D> {
    fn of(output: Output<D>, matches: Vec<Vector<D>>) -> Self {
        Self {
            output,
            matches,
            layout: 0,
            level: None,
            within: None,
            energy: Vec::new(),
            stopped: StopReason::Finished,
        }
    }
}

impl<'a, const D: usize> Stage<'a, D> {
    fn new(prepared: &'a Prepared<D>, request: &'a StructureRequest<D>) -> Result<Self> {
        let budget = request.budget.stage("making the structure");
        let layout = Layout::new(prepared, &*request.territory, &budget)?;
        let expected = layout.expected(prepared);
        let limits = budget.limits();
        budget.within_expected("points of the result", expected, ("output-elements", limits.output_elements))?;
        budget.allow_elements(expected);
        let (mut scales, mut layouts) = (Vec::new(), vec![layout]);
        let layout = &layouts[0];
        let spacing = prepared.pattern.spacing;
        let (mut delta, sigma) = (layout.window, prepared.sigma);
        let least = SMALLEST * layout.window;
        let mut wider = Vec::new();
        while delta > 1.1 * least {
            wider.push(layout.spaced(delta, &*request.territory, &budget)?);
            scales.push(Scale { delta, sigma, layout: wider.len() });
            delta *= prepared.params.shrink;
        }
        scales.push(Scale { delta: least, sigma, layout: 0 });
        let fine = prepared.params.fine * spacing;
        if fine < sigma {
            scales.push(Scale { delta: least, sigma: fine, layout: 0 });
        }
        layouts.extend(wider);
        Ok(Self { prepared, request, budget, layouts, scales, done: Vec::new() })
    }

    /// All levels on one layout, of which some sites are `done`: for what is small.
    fn on(
        prepared: &'a Prepared<D>,
        request: &'a StructureRequest<D>,
        (layout, done): (Layout<D>, Vec<Option<Vector<D>>>),
    ) -> Self {
        let budget = request.budget.stage("making the structure");
        budget.allow_elements(layout.expected(prepared));
        let least = SMALLEST * layout.window;
        let scale = |delta: f64, sigma: f64| Scale { delta, sigma, layout: 0 };
        let mut scales = Vec::new();
        let mut delta = layout.window;
        while delta > 1.1 * least {
            scales.push(scale(delta, prepared.sigma));
            delta *= prepared.params.shrink;
        }
        scales.push(scale(least, prepared.sigma));
        let fine = prepared.params.fine * prepared.pattern.spacing;
        scales.extend((fine < prepared.sigma).then(|| scale(least, fine)));
        Self { prepared, request, budget, layouts: vec![layout], scales, done }
    }

    /// Goes through the levels, until somebody asks to stop or the budget is used up.
    fn levels(&self, state: &mut State<D>, watch: &mut dyn Watch<PointSet<D>>) -> Result<()> {
        for n in 0..self.scales.len() {
            match self.level(n, state, watch) {
                Ok(ControlFlow::Continue(())) => {}
                Ok(ControlFlow::Break(())) => {
                    state.stopped = StopReason::Stopped;
                    break;
                }
                Err(error) if state.matches.is_empty() => return Err(error),
                Err(Error::Limit { .. }) => {
                    state.stopped = StopReason::Limit;
                    break;
                }
                Err(Error::Stopped { .. }) => {
                    state.stopped = StopReason::Stopped;
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// The layout and the pattern as `tables` see them.
    fn seen_by<'t>(&'t self, layout: usize, tables: &'t Tables<D>) -> Level<'t, D> {
        let layout = &self.layouts[layout];
        let pattern = &*self.prepared.pattern;
        Level {
            pattern,
            tables,
            sites: &layout.sites,
            open: layout.sites.len(),
            index: &layout.index,
            domain: &layout.domain,
            shifts: &self.prepared.repetition.shifts,
            usual: pattern.points.len() as f64 / pattern.measure() * tables.kernel.volume(pattern.repeats()),
        }
    }

    fn level(&self, n: usize, state: &mut State<D>, watch: &mut dyn Watch<PointSet<D>>) -> Result<ControlFlow<()>> {
        let scale = self.scales[n];
        let pattern = &*self.prepared.pattern;
        let params = &self.prepared.params;
        let kernel = Kernel::new(scale.sigma, scale.delta, pattern.base, params.shape);
        let tables = Tables::new(pattern, kernel, &self.prepared.fields, &self.budget)?;
        state.level = Some(n);
        let level = self.seen_by(scale.layout, &tables);
        if n == 0 {
            self.start(&self.seen_by(0, &tables), state)?;
        }
        let (layout, from) = (&self.layouts[scale.layout], &self.layouts[state.layout]);
        if scale.layout != state.layout {
            state.matches = layout.carried(from, &state.matches, pattern.base);
            state.layout = scale.layout;
        }
        let room = room(&level);
        state.matches.iter_mut().for_each(|m| *m = room.clamp(*m));
        let sites = layout.sites.len();
        let mut open = state.within.clone().unwrap_or_else(|| vec![true; sites]);
        let mut energy = None;
        // What was not fitted to anything before needs more of them.
        let more = if params.start != Start::Grow && self.done.is_empty() { UNFITTED } else { 1 };
        let more = if pattern.repeats() > 2 { more.max(DEEP) } else { more };
        let rounds = more * params.rounds;
        for round in 0..rounds {
            let draw =
                Round { seed: self.request.seed, number: (n * 1000 + round) as u64 + 10, tries: more * params.tries };
            let settled = self.advance(&level, state, &mut open, draw, &mut energy)?;
            let elements = state.output.places.len();
            let energy = energy.unwrap_or(0.0) / sites as f64;
            state.energy.push(EnergyPoint { level: n, iteration: round, energy, elements });
            let done = n as f64 + (round + 1) as f64 / rounds as f64;
            let progress = Progress {
                stage: format!("level {} of {}", n + 1, self.scales.len()).into(),
                done: round + 1,
                total: rounds,
                fraction: done / self.scales.len() as f64,
                energy: Some(energy),
                count: elements,
            };
            let output = &state.output;
            if watch.step(&progress, &|| self.preview(output)).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            if settled {
                break;
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// One round over what is in motion, the sites for which `open` says so; these are other ones afterwards. Returns whether all has settled.
    fn advance(
        &self,
        level: &Level<'_, D>,
        state: &mut State<D>,
        open: &mut Vec<bool>,
        draw: Round,
        energy: &mut Option<f64>,
    ) -> Result<bool> {
        let steps = self.prepared.params.steps;
        let count = open.iter().filter(|o| **o).count();
        let whole = state.within.is_none() && count as f64 > WHOLE * open.len() as f64;
        let layout = &self.layouts[state.layout];
        let around = &layout.around;
        let mut moving = vec![false; open.len()];
        let turn = if whole {
            let mut matches = Matches::new(level, std::mem::take(&mut state.matches));
            let turn = round(level, around, (&mut state.output, &mut matches), (draw, steps), &self.budget);
            state.matches = matches.places;
            let turn = turn?;
            turn.rematched.iter().for_each(|&q| moving[q] = true);
            *energy = Some(turn.energy.1);
            turn
        } else {
            let step = layout.plan.step;
            let part = Part::new(level, (around, step), &state.output, &state.matches, open, &self.budget)?;
            let inner = part.level(level);
            let (mut output, mut matches) = (part.output.clone(), Matches::new(&inner, part.places.clone()));
            let turn = round(&inner, &part.around, (&mut output, &mut matches), (draw, steps), &self.budget)?;
            part.back(level, (&output, &matches), (&mut state.output, &mut state.matches));
            turn.rematched.iter().for_each(|&q| moving[part.numbers[q]] = true);
            *energy = Some(energy.unwrap_or(turn.energy.0) + turn.energy.1 - turn.energy.0);
            turn
        };
        for &p in &turn.stirred {
            level.index.windows(level.sites, p, &level.tables.reach, |q, _| moving[q] = true);
        }
        if let Some(within) = &state.within {
            moving.iter_mut().zip(within).for_each(|(m, w)| *m &= *w);
        }
        *open = moving;
        Ok(turn.settled || open.iter().all(|o| !o))
    }

    /// Lays out the first points and matches.
    fn start(&self, level: &Level<'_, D>, state: &mut State<D>) -> Result<()> {
        let (params, seed) = (&self.prepared.params, self.request.seed);
        let layout = &self.layouts[0];
        let step = layout.plan.step;
        let mut kept = std::mem::take(&mut state.output);
        let stay = kept.kept;
        // What is there already is not shaken.
        kept.kept = kept.places.len();
        let spacing = self.prepared.pattern.spacing;
        let start = if self.done.is_empty() { params.start } else { Start::Grow };
        let (mut output, matches) = match start {
            Start::Grow => grow(level, (kept, &self.done), &layout.around, step, seed, &self.budget)?,
            Start::Patches => patches(level, kept, (step, params.patch * spacing), seed),
            Start::Noise => {
                let output = noise(level, kept, step, seed);
                let room = room(level);
                let first = |q| {
                    anywhere(&room, &mut arabesque_core::Stream::new(seed, arabesque_core::Stage::new(46), q as u64))
                };
                let mut matches = Matches::new(level, (0..layout.sites.len()).map(first).collect());
                let near = level.near(&output, &self.budget)?;
                for number in 0..FIRST {
                    let draw = Round { seed, number, tries: 8 };
                    matches = matching(level, &output, &near, &matches, &layout.around, (draw, &self.budget))?.matches;
                }
                (output, matches.places)
            }
        };
        if start != Start::Noise {
            let length = params.shake.unwrap_or((SHAKE * self.prepared.pattern.variation).min(0.5));
            shake(&mut output, length * spacing, seed);
        }
        output.kept = stay;
        if self.done.is_empty() {
            fill(level, &mut output, step, seed, &self.budget)?;
        }
        (state.output, state.matches) = (output, matches);
        Ok(())
    }

    fn preview(&self, output: &Output<D>) -> PointSet<D> {
        let nearest = vec![0; output.places.len()];
        self.cut(output, &nearest, None).points
    }

    fn cut(&self, output: &Output<D>, sources: &[usize], groups: Option<&[i32]>) -> Finished<D> {
        let (plan, domain) = (self.layouts[0].plan, &self.layouts[0].domain);
        let inside = |p| self.request.territory.contains(domain.wrap(p), &plan);
        let mut finished = finish(&self.prepared.pattern, output, sources, groups, inside);
        let exemplar = &self.prepared.pattern.points.positions;
        let mut loose = vec![true; finished.points.len()];
        for element in &mut finished.elements {
            // An element is moved as a whole, by its middle.
            let own = &mut finished.points.positions[element.points.clone()];
            let middle = own.iter().fold(Vector::ZERO, |s, &p| s + p) * (1.0 / own.len().max(1) as f64);
            element.pose.translation += domain.wrap(middle) - middle;
            for (place, source) in own.iter_mut().zip(&finished.sources[element.points.clone()]) {
                *place = source.map_or(*place, |j| element.pose.apply(exemplar[j]));
            }
            loose[element.points.clone()].fill(false);
        }
        for (place, _) in finished.points.positions.iter_mut().zip(&loose).filter(|(_, loose)| **loose) {
            *place = domain.wrap(*place);
        }
        finished
    }

    fn outcome(&self, state: State<D>) -> Result<StructureOutcome<D>> {
        // What is still to be done with the best so far has an account of its own.
        let budget = self.budget.fresh();
        // That of the level at which it was stopped, whose tables are there: whoever asked to stop waits.
        let last = state.level.map(|n| &self.scales[n]).filter(|s| s.layout == state.layout);
        let last = last.or_else(|| self.scales.iter().rev().find(|s| s.layout == state.layout));
        let Some(&scale) = last else { return Err(Error::no_result("no level", "allow a window")) };
        let pattern = &*self.prepared.pattern;
        let kernel = Kernel::new(scale.sigma, scale.delta, pattern.base, self.prepared.params.shape);
        let tables = Tables::new(pattern, kernel, &self.prepared.fields, &budget)?;
        let level = self.seen_by(state.layout, &tables);
        let matches = Matches::new(&level, state.matches);
        let near = level.near(&state.output, &budget)?;
        let sources = sources(&level, &state.output, &near, &matches);
        let groups = groups(&level, &state.output, &near, &matches, &budget)?;
        let finished = self.cut(&state.output, &sources, groups.as_deref());
        let mut warnings = self.prepared.warnings.clone();
        if finished.points.is_empty() {
            return Err(Error::no_result(
                "no point lies in the domain",
                "make the domain larger, or the scale smaller",
            ));
        }
        if state.stopped == StopReason::Limit {
            let (message, advice) = self.budget.spent();
            warnings.push(Warning::new(message, advice));
        }
        Ok(StructureOutcome {
            points: finished.points,
            sources: finished.sources,
            elements: finished.elements,
            energy: state.energy,
            warnings,
            stopped: state.stopped,
        })
    }
}
