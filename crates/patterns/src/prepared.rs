//! An exemplar, prepared for any number of runs.

use std::sync::{Arc, OnceLock};

use arabesque_core::{
    Budget, Error, Exemplar, Outcome, Request, Result, Role, Snapshot, StopReason, Vector, Watch, rounded,
};

use crate::{
    dimension::Dimension,
    ending,
    exemplar::checks,
    finish::{
        clearance::{self, ExemplarClearance},
        order::{self, ExemplarOrder},
    },
    irregular::Irregular,
    params::{Params, Repeats},
    regular::{Filled, Regular},
    repeat::Repeat,
};

/// An exemplar, analysed once, ready for any number of runs.
#[derive(Clone, Debug)]
pub struct Prepared<const D: usize> {
    exemplar: Arc<Exemplar<D>>,
    /// How its elements lie to one another; `None` where that has no meaning.
    clearance: Option<Arc<ExemplarClearance>>,
    /// Which of its elements lie on which; `None` where none overlap.
    order: Option<Arc<ExemplarOrder>>,
    pub(crate) params: Params,
    /// Its repeat, where it has one that is to be used.
    regular: Option<Arc<Regular>>,
    /// What the engine needs; where there is a repeat, worked out when a request first needs it.
    irregular: OnceLock<Irregular<D>>,
}

/// The repeat by which an exemplar is continued; `None` where it is treated as irregular. The same as
/// [`Prepared::repeat`], without the analysis that irregular ones need.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn repeat_of(exemplar: &Exemplar<2>, budget: &Budget) -> Result<Option<Repeat>> {
    Ok(Regular::new(exemplar, budget)?.map(Regular::into_repeat))
}

/// The engine for one dimension, compiled in this crate: left generic, it would be compiled again in every crate that calls it.
#[doc(hidden)]
pub trait Compiled<const D: usize>: Dimension<D> {
    /// See [`Prepared::new`].
    ///
    /// # Errors
    /// As there.
    fn analysed(exemplar: &Arc<Exemplar<D>>, params: &Params, budget: &Budget) -> Result<Prepared<D>>;

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
                budget: &Budget,
            ) -> Result<Prepared<$dimension>> {
                Prepared::analysed(exemplar, params, budget)
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
        Vector::<D>::analysed(&exemplar.into(), params, budget)
    }

    fn analysed(exemplar: &Arc<Exemplar<D>>, params: &Params, budget: &Budget) -> Result<Self> {
        params.check()?;
        let has_lines = !exemplar.curves.is_empty() || !exemplar.areas.is_empty();
        if !has_lines && exemplar.elements.iter().filter(|e| e.role == Role::Source).count() < 2 {
            let problem = "one element only, expected at least two";
            let advice = "repeat the element a few times in the exemplar, so that it shows distances and directions";
            return Err(Error::input("exemplar", problem, advice));
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
            Some(plane) if params.repeat != Repeats::Off => Regular::new(plane, budget)?.map(Arc::new),
            _ => None,
        };
        if regular.is_none() && params.repeat == Repeats::Exact {
            let expected = "auto or off: the exemplar shows no repeat that explains it";
            return Err(Error::parameter("repeat", "exact", expected));
        }
        if regular.is_none() {
            no_areas(
                exemplar,
                "that run through the frame and do not repeat",
                "show two periods of the pattern or more, draw the lines as strokes or with one width, use --method elements to \
                 treat every connected piece as one element, or mark items with data-arabesque=\"element\" or \"ignore\"",
            )?;
        }
        let clearance = clearance::measure(exemplar, budget)?.map(Arc::new);
        let order = clearance.as_ref().map_or(Ok(None), |known| ExemplarOrder::new(known, budget))?.map(Arc::new);
        let prepared = Self {
            exemplar: Arc::clone(exemplar),
            clearance,
            order,
            params: params.clone(),
            regular,
            irregular: OnceLock::new(),
        };
        if prepared.regular.is_none() {
            prepared.irregular(budget)?;
        }
        Ok(prepared)
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
        let (order, clearance) = (self.order.as_deref(), self.clearance.as_deref());
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

    /// Everything but the order of painting.
    fn laid_out(&self, request: &Request<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<Outcome<D>> {
        checks::frozen(&self.exemplar, request)?;
        let mut told = Vec::new();
        if let Some(regular) = &self.regular {
            match Vector::<D>::fill_plane(regular, &self.exemplar, request, watch)? {
                Some(Filled::Done(outcome)) => return Ok(outcome),
                Some(Filled::Unfit(warnings)) => told = warnings,
                None => {}
            }
            if self.params.repeat == Repeats::Exact {
                let why = told.first().map_or("fields, or strokes that turn or stay, bend it", |w| w.message.as_str());
                return Err(Error::parameter("repeat", "exact", format!("auto: {why}")));
            }
        }
        no_areas(
            &self.exemplar,
            "where the repeat cannot follow the fields, turn at the border, join what is kept, or fit the tile",
            "use fields that turn and grow more gently, another border, or a tile that suits (--tile auto), or draw the areas \
             as strokes",
        )?;
        let mut outcome = self.irregular(&request.budget)?.filled(request, watch)?;
        outcome.warnings.splice(0..0, told);
        Ok(outcome)
    }
}

/// Whether an exemplar of the plane has a repeat by which it can be continued.
///
/// # Errors
/// When the budget is used up, or somebody asks to stop.
pub fn repeats(exemplar: &Exemplar<2>, budget: &Budget) -> Result<bool> {
    Ok(Regular::new(exemplar, budget)?.is_some())
}

/// Refuses areas that only a repeat could continue.
fn no_areas<const D: usize>(exemplar: &Exemplar<D>, why: &str, advice: &str) -> Result<()> {
    let count = exemplar.areas.len();
    if count == 0 {
        return Ok(());
    }
    let mut names: Vec<&str> = exemplar.areas.iter().map(|a| exemplar.styles[a.style].name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let more = if names.len() > 3 { ", .." } else { "" };
    names.truncate(3);
    let what = format!("{count} filled areas ({}{more}) {why}", names.join(", "));
    Err(Error::Unsupported { what, advice: advice.into() })
}
