//! An exemplar, prepared for any number of runs.

use std::{
    ops::ControlFlow,
    sync::{Arc, OnceLock},
};

use arabesque_core::{
    Border, Budget, Drawn, Error, Exemplar, Forecast, Outcome, Placement, Progress, Request, Result, Snapshot,
    StopReason, Vector, Warning, Watch, rounded,
};

use crate::{
    apart,
    dimension::Dimension,
    ending,
    exemplar::checks,
    finish::{
        clearance::{self, ExemplarClearance},
        loose::LooseEnds,
        order::{self, ExemplarOrder},
    },
    irregular::Irregular,
    orderly::{Orderly, straight::Straight},
    params::{Params, Repeats},
    regular::{Filled, Regular},
    repeat::Repeat,
    soft::Softness,
};

/// An exemplar, analysed once, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    exemplar: Arc<Exemplar<D>>,
    /// How its elements lie to one another; `None` where that has no meaning.
    clearance: Option<Arc<ExemplarClearance>>,
    /// The same with elements told apart by their place in the cell of the repeat, by which they are sorted.
    staged: Option<Arc<ExemplarClearance>>,
    /// Which of its elements lie on which; `None` where none overlap.
    order: Option<Arc<ExemplarOrder>>,
    pub(crate) params: Params,
    /// Its repeat, where it has one that is to be used.
    regular: Option<Arc<Regular>>,
    /// The lines that it keeps to, where it has no repeat.
    orderly: Option<Arc<Orderly>>,
    /// The directions of its lines, where they are all straight.
    straight: Option<Arc<Straight>>,
    /// The loose ends of its lines, where it has lines.
    loose: Option<LooseEnds>,
    /// A part that repeats and the rest, which does not, where they say nothing of one another.
    layers: Option<Arc<Layers<D>>>,
    /// Its elements as samples that move by themselves, where some bend.
    soft: Option<Arc<Softness<D>>>,
    /// What the engine needs; where there is a repeat, worked out when a request first needs it.
    irregular: OnceLock<Irregular<D>>,
}

/// A part of an exemplar, ready for any number of runs.
#[derive(Clone, Debug)]
struct Layer<const D: usize> {
    prepared: Prepared<D>,
    /// For each element and each curve its number in the whole exemplar.
    elements: Vec<usize>,
    curves: Vec<usize>,
}

/// Two parts of an exemplar that say nothing of one another.
#[derive(Clone, Debug)]
struct Layers<const D: usize> {
    regular: Layer<D>,
    rest: Layer<D>,
    /// Whether the rest keeps clear of what repeats.
    is_clear: bool,
}

impl<const D: usize> Layer<D> {
    /// What a run made of it, in terms of the whole exemplar.
    fn whole(&self, mut snapshot: Snapshot<D>) -> Snapshot<D> {
        snapshot.placements.iter_mut().for_each(|p| p.source = self.elements[p.source]);
        snapshot.curves.iter_mut().for_each(|c| c.source = self.curves[c.source]);
        snapshot
    }
}

/// Shows what is made of a part with what was made before.
struct Showing<'a, const D: usize> {
    watch: &'a mut dyn Watch<Snapshot<D>>,
    layer: &'a Layer<D>,
    before: &'a Snapshot<D>,
}

impl<const D: usize> Watch<Snapshot<D>> for Showing<'_, D> {
    fn foreseen(&mut self, forecast: &Forecast) {
        self.watch.foreseen(forecast);
    }

    fn step(&mut self, progress: &Progress, preview: &dyn Fn() -> Snapshot<D>) -> ControlFlow<()> {
        let (layer, before) = (self.layer, self.before);
        self.watch.step(progress, &|| {
            let mut shown = layer.whole(preview());
            shown.placements.extend_from_slice(&before.placements);
            shown.curves.extend_from_slice(&before.curves);
            shown
        })
    }
}

/// How an exemplar is continued by its repeat; `None` where it is treated as irregular. The same as what
/// [`Prepared::new`] finds, without the analysis that irregular ones need; [`Prepared::knowing`] does not look for it again.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn regular(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Arc<Regular>>> {
    Ok(Regular::new(exemplar, budget)?.map(Arc::new))
}

/// What is known already of how an exemplar repeats.
#[derive(Clone, Debug, Default)]
pub enum Known {
    /// Nothing: nobody looked.
    #[default]
    Unasked,
    /// What [`regular`] found: how it repeats, or that it is irregular.
    Found(Option<Arc<Regular>>),
}

impl Known {
    /// How it repeats, where that is known.
    pub fn repeat(&self) -> Option<&Arc<Regular>> {
        match self {
            Self::Unasked | Self::Found(None) => None,
            Self::Found(Some(found)) => Some(found),
        }
    }

    /// How `exemplar`, of which this is known, repeats: as found, or by looking for it.
    ///
    /// # Errors
    /// As [`regular`].
    pub fn or_find(self, exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Arc<Regular>>> {
        match self {
            Self::Unasked => regular(exemplar, budget),
            Self::Found(found) => Ok(found),
        }
    }
}

/// The engine for one dimension, compiled in this crate: left generic, it would be compiled again in every crate that calls it.
#[doc(hidden)]
pub trait Compiled<const D: usize>: Dimension<D> {
    /// See [`Prepared::new`].
    ///
    /// # Errors
    /// As there.
    fn analysed(exemplar: &Arc<Exemplar<D>>, params: &Params, known: Known, budget: &Budget) -> Result<Prepared<D>>;

    /// See [`Prepared::run`].
    ///
    /// # Errors
    /// As there.
    fn filled(prepared: &Prepared<D>, request: &Request<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<Outcome<D>>;
}

macro_rules! compiled {
    ($dimension:literal) => {
        impl Compiled<$dimension> for Vector<$dimension> {
            fn analysed(
                exemplar: &Arc<Exemplar<$dimension>>,
                params: &Params,
                known: Known,
                budget: &Budget,
            ) -> Result<Prepared<$dimension>> {
                Prepared::analysed(exemplar, params, known, budget)
            }

            fn filled(
                prepared: &Prepared<$dimension>,
                request: &Request<$dimension>,
                watch: &mut dyn Watch<Snapshot<$dimension>>,
            ) -> Result<Outcome<$dimension>> {
                prepared.filled(request, watch)
            }
        }
    };
}

compiled!(2);
compiled!(3);

impl<const D: usize> Prepared<D>
where
    Vector<D>: Dimension<D>,
{
    /// Analyses the exemplar, which is shared where the caller shares it.
    ///
    /// # Errors
    /// [`Error::Parameter`] when a parameter is out of range, the radius larger than the exemplar, or a repeat asked for
    /// that is not there; [`Error::Input`]
    /// when the exemplar shows no curve and fewer than two elements that may be copied, for then nothing tells how far
    /// apart they belong, or when its curves lie outside its frame; [`Error::Limit`] when its curves meet in too many
    /// places or lie too densely.
    pub fn new(exemplar: impl Into<Arc<Exemplar<D>>>, params: &Params, budget: &Budget) -> Result<Self>
    where
        Vector<D>: Compiled<D>,
    {
        Vector::<D>::analysed(&exemplar.into(), params, Known::Unasked, budget)
    }

    /// The same for an exemplar of which it is known already how it repeats, or that it does not.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn knowing(
        exemplar: impl Into<Arc<Exemplar<D>>>,
        params: &Params,
        known: Known,
        budget: &Budget,
    ) -> Result<Self>
    where
        Vector<D>: Compiled<D>,
    {
        Vector::<D>::analysed(&exemplar.into(), params, known, budget)
    }

    fn analysed(exemplar: &Arc<Exemplar<D>>, params: &Params, known: Known, budget: &Budget) -> Result<Self> {
        params.check()?;
        let has_lines = !exemplar.curves.is_empty() || !exemplar.areas.is_empty();
        if !has_lines {
            checks::several(exemplar)?;
        }
        checks::places(exemplar)?;
        checks::strokes(exemplar)?;
        let side = exemplar.view().side();
        if let Some(radius) = params.radius.filter(|r| *r > side) {
            return Err(Error::parameter(
                "radius",
                radius,
                format!("at most {}, the shorter side of the exemplar", rounded(side)),
            ));
        }
        let regular = match Vector::<D>::plane_exemplar(exemplar) {
            Some(plane) if params.repeat != Repeats::Off => known.or_find(plane, budget)?,
            _ => None,
        };
        if regular.is_none() && params.repeat == Repeats::Exact {
            let advice = "show two whole periods or more, or leave repeat=exact out";
            return Err(Error::input(
                "exemplar",
                "no repeat that explains the drawing, where repeat=exact asks for one",
                advice,
            ));
        }
        let soft = Softness::new(exemplar, params, budget)?.map(Arc::new);
        let orderly = match Vector::<D>::plane_exemplar(exemplar) {
            Some(plane) if params.repeat != Repeats::Off && regular.is_none() => {
                Orderly::new(plane, budget)?.map(Arc::new)
            }
            _ => None,
        };
        if regular.is_none() {
            no_areas(exemplar, "that do not repeat")?;
        }
        let clearance = clearance::measure(exemplar, budget)?.map(Arc::new);
        let order = clearance.as_ref().map_or(Ok(None), |known| ExemplarOrder::new(known, budget))?.map(Arc::new);
        // Of elements alike, those at one place of the cell may lie on others, and those at another place below them.
        let staged = match (&regular, &clearance, &order) {
            (Some(regular), Some(clearance), Some(_)) => Some(Arc::new(clearance.classed(regular.places()))),
            _ => None,
        };
        let order = match &staged {
            Some(staged) => ExemplarOrder::new(staged, budget)?.map(Arc::new),
            None => order,
        };
        let mut prepared = Self {
            exemplar: Arc::clone(exemplar),
            clearance,
            staged,
            order,
            params: params.clone(),
            regular,
            orderly,
            straight: None,
            loose: None,
            layers: None,
            soft,
            irregular: OnceLock::new(),
        };
        prepared.disordered(budget)?;
        Ok(prepared)
    }

    /// Works out what is needed where neither a repeat nor lines of its own explain the exemplar.
    fn disordered(&mut self, budget: &Budget) -> Result<()> {
        if self.regular.is_some() || self.orderly.is_some() || self.soft.is_some() {
            return Ok(());
        }
        let exemplar = Arc::clone(&self.exemplar);
        if let Some(plane) = Vector::<D>::plane_exemplar(&exemplar).filter(|_| self.params.repeat != Repeats::Off)
            && let Some(found) = apart::regular_layer(plane, budget)?
        {
            self.layers = self.layers_of(&found, budget)?.map(Arc::new);
        }
        if self.layers.is_some() {
            return Ok(());
        }
        // That refuses lines on top of one another, in which loose ends would be looked for at great length.
        self.irregular(budget)?;
        if let Some(plane) = Vector::<D>::plane_exemplar(&exemplar).filter(|_| self.params.repeat != Repeats::Off) {
            self.straight = Straight::of(plane, budget)?.map(Arc::new);
            self.loose = LooseEnds::of(plane, budget)?;
        }
        Ok(())
    }

    /// The layers of which one repeats; `None` where the rest by itself shows too little.
    fn layers_of(&self, found: &apart::Layer, budget: &Budget) -> Result<Option<Layers<D>>> {
        let not = |kept: &[bool]| kept.iter().map(|kept| !kept).collect::<Vec<bool>>();
        let numbers = |kept: &[bool]| (0..kept.len()).filter(|&k| kept[k]).collect::<Vec<usize>>();
        let layer = |elements: &[bool], curves: &[bool], known: Known| -> Result<Layer<D>> {
            let params = if known.repeat().is_some() {
                self.params.clone()
            } else {
                Params { repeat: Repeats::Off, ..self.params.clone() }
            };
            let part = Arc::new(apart::part(&self.exemplar, elements, curves));
            let prepared = Self::analysed(&part, &params, known, budget)?;
            Ok(Layer { prepared, elements: numbers(elements), curves: numbers(curves) })
        };
        let regular = layer(&found.elements, &found.curves, Known::Found(Some(Arc::clone(&found.regular))))?;
        let rest = match layer(&not(&found.elements), &not(&found.curves), Known::Unasked) {
            Ok(rest) => rest,
            Err(Error::Input { .. } | Error::Parameter { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        Ok(Some(Layers { regular, rest, is_clear: found.is_clear }))
    }

    /// Fills a domain layer by layer; `None` where something stays that belongs to one of them, or to both.
    fn layered(
        &self,
        layers: &Layers<D>,
        request: &Request<D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<Option<Outcome<D>>> {
        let stays = !request.frozen.is_empty() || !request.frozen_curves.is_empty();
        if stays || request.known.is_some() || request.between.is_some() {
            return Ok(None);
        }
        let nothing = Snapshot::default();
        let mut first = Showing { watch, layer: &layers.regular, before: &nothing };
        let mut outcome = layers.regular.prepared.laid_out(request, &mut first)?;
        let made = layers.regular.whole(Snapshot {
            placements: std::mem::take(&mut outcome.placements),
            curves: std::mem::take(&mut outcome.curves),
            ..Snapshot::default()
        });
        let mut around = request.clone();
        if layers.is_clear {
            let outline = |p: &Placement<D>| self.exemplar.elements[p.source].outline.transformed(&p.transform);
            around.obstacles.extend(made.placements.iter().map(outline));
        }
        if outcome.stopped != StopReason::Finished {
            (outcome.placements, outcome.curves) = (made.placements, made.curves);
            return Ok(Some(outcome));
        }
        let mut second = Showing { watch, layer: &layers.rest, before: &made };
        match layers.rest.prepared.laid_out(&around, &mut second) {
            Ok(rest) => {
                let all = layers.rest.whole(Snapshot {
                    placements: rest.placements,
                    curves: rest.curves,
                    ..Snapshot::default()
                });
                (outcome.placements, outcome.curves) = (all.placements, all.curves);
                outcome.warnings.extend(rest.warnings);
                (outcome.energy, outcome.stopped) = (rest.energy, rest.stopped);
            }
            Err(Error::NoResult { .. }) => {}
            Err(error) => outcome.stopped = ending::reason(Some(error), &mut outcome.warnings)?,
        }
        outcome.placements.extend(made.placements);
        outcome.curves.extend(made.curves);
        Ok(Some(outcome))
    }

    /// Makes straight again what the engine has bent of straight lines, and joins ends that it has left loose.
    fn tidy(&self, outcome: &mut Outcome<D>, request: &Request<D>) -> Result<()> {
        let planes = (Vector::<D>::plane_exemplar(&self.exemplar), Vector::<D>::plane_request(request));
        let (Some(exemplar), Some(request)) = planes else { return Ok(()) };
        if outcome.stopped != StopReason::Finished {
            return Ok(());
        }
        let better = |curves: Vec<Drawn<2>>| {
            let curves = match &self.loose {
                Some(loose) => loose.mended(curves, exemplar, request)?,
                None => curves,
            };
            match &self.straight {
                Some(straight) => straight.straightened(curves, request),
                None => Ok(curves),
            }
        };
        match Vector::<D>::map_plane_strokes(outcome.curves.clone(), better) {
            Ok(curves) => outcome.curves = curves,
            Err(error) => outcome.stopped = ending::reason(Some(error), &mut outcome.warnings)?,
        }
        Ok(())
    }

    /// What the engine works with.
    pub(crate) fn irregular(&self, budget: &Budget) -> Result<&Irregular<D>> {
        if let Some(known) = self.irregular.get() {
            return Ok(known);
        }
        let made = Irregular::new(&self.exemplar, self.clearance.clone(), &self.params, budget)?;
        Ok(self.irregular.get_or_init(|| made))
    }

    /// The repeat by which the exemplar is continued; `None` where it is treated as irregular.
    pub fn repeat(&self) -> Option<&Repeat> {
        self.regular.as_ref().map(|regular| &regular.repeat)
    }

    /// The exemplar as one that repeats; `None` where it is treated as irregular.
    pub fn repeating(&self) -> Option<&Regular> {
        self.regular.as_deref()
    }

    /// Elements with a volume that somebody else has placed, without those that lie deeper in others than in the exemplar or do not suit
    /// the border. Where rows lie on one another anyhow, as those of shingles do (`laps`), overlaps are left.
    ///
    /// # Errors
    /// [`Error::NoResult`] when nothing is left; when a limit is reached, or somebody asks to stop, the result is what it is by then.
    pub fn without_overlaps(
        &self,
        mut placements: Vec<Placement<D>>,
        laps: bool,
        request: &Request<D>,
    ) -> Result<Outcome<D>> {
        let ended = self.irregular(&request.budget)?.without_overlaps(&mut placements, laps, request).err();
        if placements.is_empty() {
            return Err(ended.unwrap_or_else(|| {
                let advice = "make the domain larger, lower the scale, or allow elements to cross its border";
                Error::no_result("no element fits into the domain", advice)
            }));
        }
        let mut warnings = Vec::new();
        let stopped = ending::reason(ended, &mut warnings)?;
        let (sequence, curves, areas, energy) = Default::default();
        Ok(Outcome { placements, sequence, curves, areas, energy, warnings, stopped })
    }

    /// Neighbourhood radius of each level, coarsest first, in the exemplar's units; none where no neighbourhood is
    /// compared.
    pub fn radii(&self) -> Vec<f64> {
        self.irregular.get().map_or_else(Vec::new, |irregular| irregular.radii())
    }

    /// Number of samples of each exemplar element at the finest level; none where no neighbourhood is compared.
    pub fn samples_per_element(&self) -> Vec<usize> {
        self.irregular.get().map_or_else(Vec::new, |irregular| irregular.samples_per_element())
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a frozen element with an unknown source, or where `repeat=exact` cannot be kept;
    /// [`Error::Limit`] when the output would be too
    /// large, or a limit is reached before there is anything; [`Error::Stopped`] when somebody asks to stop so early;
    /// [`Error::NoResult`] when nothing fits into the domain.
    pub fn run(&self, request: &Request<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<Outcome<D>>
    where
        Vector<D>: Compiled<D>,
    {
        Vector::<D>::filled(self, request, watch)
    }

    fn filled(&self, request: &Request<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<Outcome<D>> {
        let mut outcome = self.laid_out(request, watch)?;
        self.stack(&mut outcome, request)?;
        Ok(outcome)
    }

    /// Sorts the elements of an outcome from bottom to top; where there is no time or work left, they stay as they are.
    fn stack(&self, outcome: &mut Outcome<D>, request: &Request<D>) -> Result<()> {
        let is_finished = outcome.stopped == StopReason::Finished;
        let budget = if is_finished { request.budget.clone() } else { ending::last_touches(&request.budget) };
        let clearance = self.staged.as_deref().or(self.clearance.as_deref());
        let order = self.order.as_deref();
        match order::sort(&mut outcome.placements, order, clearance, &request.domain, &budget) {
            Ok(sorted) => {
                outcome.warnings.extend(sorted.warning);
                outcome.sequence = sorted.sequence;
            }
            Err(error) if is_finished => outcome.stopped = ending::reason(Some(error), &mut outcome.warnings)?,
            Err(_) => {}
        }
        Ok(())
    }

    /// Refuses areas where the lattice cannot serve the request; `told` is what that said of a tile.
    fn refuse_bent_areas(&self, request: &Request<D>, told: Option<&Warning>) -> Result<()> {
        if self.exemplar.areas.is_empty() {
            return Ok(());
        }
        let areas = areas_of(&self.exemplar);
        let (what, advice) = match told {
            Some(told) => {
                (format!("fitting {areas} into this tile, which their repeat does not suit,"), told.advice.as_str())
            }
            None if request.border == Border::Turn => (
                format!("turning {areas} at the border"),
                "use --border clip, inside or cross, or draw bands as strokes",
            ),
            None if !request.frozen_curves.is_empty() => (
                format!("fitting {areas} to strokes that are kept"),
                "leave the kept strokes out, or draw bands as strokes",
            ),
            None => (
                format!("bending {areas} by a field"),
                "use fields that turn and grow more gently, or none, or draw bands as strokes",
            ),
        };
        Err(Error::Unsupported { what, advice: advice.to_owned() })
    }

    /// Everything but the order of painting.
    fn laid_out(&self, request: &Request<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<Outcome<D>> {
        checks::frozen(&self.exemplar, request)?;
        if let Some(soft) = &self.soft {
            return soft.filled(&self.exemplar, request, watch);
        }
        let mut told = Vec::new();
        if let Some(regular) = &self.regular {
            match Vector::<D>::fill_plane(regular, &self.exemplar, request, watch)? {
                Some(Filled::Done(outcome)) => return Ok(outcome),
                Some(Filled::Unfit(warnings)) => told = warnings,
                None => {}
            }
            if self.params.repeat == Repeats::Exact {
                let why = told.first().map_or("fields, or strokes that turn or stay, bend it", |w| w.message.as_str());
                return Err(Error::Unsupported {
                    what: format!("keeping the repeat exactly (repeat=exact) here, where {why},"),
                    advice: told.first().map_or("leave repeat=exact out", |w| w.advice.as_str()).to_owned(),
                });
            }
        }
        if let Some(orderly) = &self.orderly
            && let Some(outcome) = Vector::<D>::fill_orderly(orderly, &self.exemplar, request, watch)?
        {
            return Ok(outcome);
        }
        if let Some(layers) = &self.layers
            && let Some(outcome) = self.layered(layers, request, watch)?
        {
            return Ok(outcome);
        }
        self.refuse_bent_areas(request, told.first())?;
        let mut outcome = self.irregular(&request.budget)?.filled(request, watch)?;
        self.tidy(&mut outcome, request)?;
        outcome.warnings.splice(0..0, told);
        Ok(outcome)
    }
}

/// Refuses areas that only a repeat could continue.
fn no_areas<const D: usize>(exemplar: &Exemplar<D>, which: &str) -> Result<()> {
    if exemplar.areas.is_empty() {
        return Ok(());
    }
    Err(Error::Unsupported {
        what: format!("going on with {} {which}", areas_of(exemplar)),
        advice: "show two whole periods of the pattern, or draw bands as strokes".into(),
    })
}

/// The areas of an exemplar, in words.
fn areas_of<const D: usize>(exemplar: &Exemplar<D>) -> String {
    let count = exemplar.areas.len();
    let mut names: Vec<&str> = Vec::new();
    for area in &exemplar.areas {
        let name = exemplar.styles[area.style].name.as_str();
        if !names.contains(&name) && names.len() < 4 {
            names.push(name);
        }
    }
    let more = if names.len() > 3 { ", ..." } else { "" };
    names.truncate(3);
    format!("{count} filled area{} ({}{more})", if count == 1 { "" } else { "s" }, names.join(", "))
}
