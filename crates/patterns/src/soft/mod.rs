//! Elements that bend: ropes, noodles, bags [Ma 2011 §3.1, fig. 13].
//!
//! An element is several samples: of a strand along its centre line, of a bag all through it. Lines say more about such a pattern than
//! neighbourhoods of centres do, for an element is longer than its neighbours are away. So elements are laid out one by one wherever there
//! is most room, each as the source that lies best among those around it, and a search for similar neighbourhoods ([Ma 2011 §4.2]) only
//! offers candidates. Then all samples move at once to where links and distances want them: lengths and bends of the sources stay, and
//! nothing comes nearer to anything else than it does in the exemplar. Both ends of a strand are equal, and samples have no ids.
//!
//! | step | module |
//! |---|---|
//! | samples, links, pieces | `form` |
//! | what the exemplar shows | `natural` |
//! | lay out | `layout`, over `bodies` |
//! | take apart | `relax` |
//! | borders and ground | `wall` |

mod bodies;
mod form;
mod layout;
mod natural;
mod relax;
#[cfg(test)]
mod tests;
mod wall;

use arabesque_core::{
    Border, Budget, Error, Exemplar, Matrix, Outcome, Placement, Progress, Request, Result, Similarity, Snapshot, Watch,
};

use crate::{
    ending::{self, heard, last_touches},
    exemplar::checks,
    params::{Clearance, Params},
};
use bodies::{Bodies, Laid};
use form::{Form, forms};
use layout::{Plan, empty, holding};
use natural::Natural;
use relax::{BETWEEN, ROUNDS, Relaxation, SURE};

/// Work that an element takes, about.
const PER_ELEMENT: f64 = 8e6;
/// Share of the progress that the layout counts for.
const LAYOUT_SHARE: f64 = 0.6;
/// An element that should lie inside is taken that is as near to the border as it may be, and nearer by rounding; where nothing has moved
/// it there, when every sample is so far away, in its radii.
const OF_SURE: f64 = 0.999;
const WITHIN: f64 = 0.97;
/// Elements are laid out so often at most, and no more once so small a share of them is missing.
const REFILLS: u64 = 4;
const ENOUGH: f64 = 0.02;

/// An exemplar of elements that bend, prepared for any number of runs.
#[derive(Clone, Debug)]
pub(crate) struct Softness<const D: usize> {
    forms: Vec<Form<D>>,
    natural: Natural,
    is_relaxed: bool,
}

impl<const D: usize> Softness<D> {
    /// Analyses the exemplar; `None` where nothing in it bends.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        exemplar: &Exemplar<D>,
        params: &Params,
        budget: &arabesque_core::Budget,
    ) -> Result<Option<Self>> {
        let is_soft = !exemplar.softs.is_empty() && exemplar.softs.len() == exemplar.elements.len();
        if !is_soft || exemplar.softs.iter().any(|s| s.samples.is_empty()) {
            return Ok(None);
        }
        let budget = &budget.stage("analysing the exemplar");
        let forms = forms(exemplar);
        let natural = Natural::new(exemplar, &forms, budget)?;
        Ok(Some(Self { forms, natural, is_relaxed: params.clearance == Clearance::Repaired }))
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// As [`crate::Prepared::run`].
    pub(crate) fn filled(
        &self,
        exemplar: &Exemplar<D>,
        request: &Request<D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<Outcome<D>> {
        let mut plan = Plan::new(exemplar, &self.forms, &self.natural, request);
        checks::expected(plan.expected(), &request.budget)?;
        request.budget.allow_elements(plan.expected());
        let count = plan.expected();
        watch.foreseen(&request.budget.forecast(count, count * PER_ELEMENT));
        let mut laid = empty(&plan);
        self.keep(&mut laid, request);
        let mut cut_short = self.lay_out(&mut plan, &mut laid, watch).err();
        let mut bodies = laid.bodies.near(&self.forms, request, self.natural.width);
        if self.is_relaxed {
            let is_whole = cut_short.is_none();
            let budget = if is_whole { request.budget.clone() } else { last_touches(&request.budget) };
            let heard = if is_whole { Some(watch) } else { None };
            let ended = self.take_apart(&mut bodies, request, &budget, heard).err();
            cut_short = cut_short.or(ended);
        }
        let placements = self.placements(&bodies, request);
        if placements.is_empty() {
            return Err(cut_short.unwrap_or_else(|| {
                Error::no_result(
                    "no element fits into the domain",
                    "make the domain larger, lower the scale, or allow elements to cross its border",
                )
            }));
        }
        let mut warnings = Vec::new();
        let stopped = ending::reason(cut_short, &mut warnings)?;
        let (sequence, curves, areas, energy) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Ok(Outcome { placements, sequence, curves, areas, energy, warnings, stopped })
    }

    /// Lays elements out until there are as many as there should be; what lies too near to one another moves apart, so that there is
    /// room for more.
    fn lay_out(&self, plan: &mut Plan<'_, D>, laid: &mut Laid<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<()> {
        let request = plan.request;
        let budget = request.budget.stage("taking elements apart");
        loop {
            plan.laid_out(laid, &mut |laid, share| {
                self.told("laying out", LAYOUT_SHARE * share, &laid.bodies, request, watch)
            })?;
            plan.round += 1;
            if plan.round >= REFILLS || !self.is_relaxed || plan.missing(&laid.bodies) <= ENOUGH * plan.expected() {
                return Ok(());
            }
            let relaxation = Relaxation { request, forms: &self.forms, natural: &self.natural };
            let mut bodies = std::mem::take(&mut laid.bodies);
            let ended = relaxation.run((&mut bodies, BETWEEN), &budget, &mut |_, _| Ok(()));
            *laid = holding(plan, &bodies);
            ended?;
        }
    }

    /// Moves elements apart, and takes out what cannot be.
    fn take_apart(
        &self,
        bodies: &mut Bodies<D>,
        request: &Request<D>,
        budget: &Budget,
        mut watch: Option<&mut dyn Watch<Snapshot<D>>>,
    ) -> Result<()> {
        let relaxation = Relaxation { request, forms: &self.forms, natural: &self.natural };
        let budget = budget.stage("taking elements apart");
        relaxation.run((bodies, ROUNDS), &budget, &mut |bodies, share| {
            let fraction = LAYOUT_SHARE + (1.0 - LAYOUT_SHARE) * share;
            let Some(watch) = watch.as_deref_mut() else { return Ok(()) };
            self.told("taking elements apart", fraction, bodies, request, watch)
        })?;
        relaxation.thin(bodies, &budget)
    }

    /// Puts in what the user placed.
    fn keep(&self, laid: &mut Laid<D>, request: &Request<D>) {
        for (n, kept) in request.frozen.iter().enumerate() {
            let Some(form) = self.forms.get(kept.source) else { continue };
            let own = &form.soft.samples;
            let samples: Vec<_> = if kept.control.len() == own.len() {
                kept.control.iter().map(|(_, to)| *to).collect()
            } else {
                own.iter().map(|p| kept.transform.apply(*p)).collect()
            };
            laid.push(kept.source, form, &samples, kept.transform.scale, Some(n));
        }
    }

    fn told(
        &self,
        stage: &'static str,
        fraction: f64,
        bodies: &Bodies<D>,
        request: &Request<D>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<()> {
        let (done, count) = ((100.0 * fraction) as usize, bodies.list.len());
        let progress = Progress { stage: stage.into(), done, total: 100, fraction, energy: None, count };
        let preview = || Snapshot { placements: self.placements(bodies, request), ..Snapshot::default() };
        heard(watch.step(&progress, &preview), &progress)
    }

    /// Those that are part of the result.
    fn placements(&self, bodies: &Bodies<D>, request: &Request<D>) -> Vec<Placement<D>> {
        let one = |body: &bodies::Body| {
            let form = &self.forms[body.source];
            let samples = bodies.samples(body, form);
            if let Some(n) = body.frozen {
                return Some(Placement { frozen: Some(n), ..request.frozen[n].clone() });
            }
            let is_in = match request.border {
                Border::Inside => {
                    let radii = if self.is_relaxed { OF_SURE * SURE } else { WITHIN };
                    let least = |k: usize| radii * form.soft.radii[k] * body.scale;
                    wall::holds(request, (samples, form.is_line()), least)
                }
                _ => request.domain.contains(form.soft.middle(samples)),
            };
            let own = &form.soft.samples;
            is_in.then(|| Placement {
                source: body.source,
                transform: Similarity::fit(own, samples, body.scale, Matrix::identity()),
                control: own.iter().copied().zip(samples.iter().copied()).collect(),
                frozen: None,
            })
        };
        bodies.list.iter().filter_map(one).collect()
    }
}
