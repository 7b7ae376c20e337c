//! An exemplar that is continued by its neighbourhoods, prepared for any number of runs.

use std::sync::Arc;

use arabesque_core::{
    Budget, Error, Exemplar, Numbered, Outcome, Placement, Request, Result, Snapshot, Vector, Warning, Watch,
};

use crate::{
    border::Extent,
    dimension::Dimension,
    ending,
    evenness::Evenness,
    exemplar::{
        checks,
        graph::{crowding, skeleton::Skeleton},
        level_exemplar::{LevelExemplar, expected_nodes, level_exemplars, shortest},
    },
    finish::{clearance::ExemplarClearance, placements, solids},
    optimise::{search, targets::class_targets},
    params::{Clearance, Deform, Params, Switch},
    run::{LevelContext, Made, Run},
};

/// Curves with more [`search::dissimilarity`] than this have nothing to repeat.
const MAX_DISSIMILARITY: f64 = 0.7;

/// With more samples than this, curves that never repeat are taken for a random pattern.
const MIN_RANDOM_NODES: usize = 100;

/// Strokes that cover more of the exemplar than this run into one another.
const CROWDED: f64 = 0.95;

/// Fewest elements in the window of an exemplar from which a distribution can be learnt without a warning.
const MIN_ELEMENTS: usize = 12;

/// Work units that an element takes in one iteration, by and large.
const PER_ELEMENT: f64 = 1e4;
/// Work units that a sample of a stroke takes in one iteration, by and large.
const PER_SAMPLE: f64 = 4e4;

/// What the engine works out of an exemplar once.
#[derive(Clone, Debug)]
pub(crate) struct Irregular<const D: usize> {
    exemplar: Arc<Exemplar<D>>,
    clearance: Option<Arc<ExemplarClearance>>,
    pub(crate) levels: Vec<LevelExemplar<D>>,
    params: Params,
    /// How even its elements lie; `None` where that cannot be told.
    evenness: Option<Evenness<D>>,
    /// See [`search::dissimilarity`]; `None` without curves.
    dissimilarity: Option<f64>,
}

impl<const D: usize> Irregular<D>
where
    Vector<D>: Dimension<D>,
{
    /// Analyses the exemplar, whose `clearance` is known.
    ///
    /// # Errors
    /// As [`crate::Prepared::new`].
    pub(crate) fn new(
        exemplar: &Arc<Exemplar<D>>,
        clearance: Option<Arc<ExemplarClearance>>,
        params: &Params,
        budget: &Budget,
    ) -> Result<Self> {
        let budget = &budget.stage("analysing the exemplar");
        budget.check()?;
        let skeleton = match exemplar.curves.as_slice() {
            [] => None,
            curves => Some(Arc::new(Skeleton::new(curves, &exemplar.view(), budget)?)),
        };
        if skeleton.as_ref().is_some_and(|s| s.lines.is_empty()) && exemplar.elements.is_empty() {
            let problem = "every curve lies outside the frame or is too short to be seen";
            return Err(Error::input("exemplar", problem, "draw longer curves inside the frame of the page"));
        }
        let skeleton = skeleton.filter(|s| !s.lines.is_empty());
        checks::density(skeleton.as_ref().map_or(0.0, |s| expected_nodes(exemplar, s, params)))?;
        let levels = level_exemplars(exemplar, skeleton.as_ref(), params, budget)?;
        checks::sizes(exemplar, &levels)?;
        let dissimilarity = match levels.first().filter(|_| skeleton.is_some()) {
            Some(s) => search::dissimilarity(&s.level, &s.library, params.matching, budget)?,
            None => None,
        };
        // What has a volume is evened out by that, at the end.
        let is_rigid = params.deform == Deform::Rigid && exemplar.solids.is_empty();
        let is_wanted = params.even == Switch::On && is_rigid;
        let evenness = match levels.last().filter(|_| is_wanted) {
            Some(s) => {
                let net = s.level.net.as_deref();
                Evenness::new(&s.exemplar, &s.library, net, s.level.base as usize, budget)?
            }
            None => None,
        };
        Ok(Self { exemplar: Arc::clone(exemplar), clearance, dissimilarity, levels, evenness, params: params.clone() })
    }

    /// Neighbourhood radius of each level, coarsest first, in the exemplar's units.
    pub(crate) fn radii(&self) -> Vec<f64> {
        self.levels.iter().map(|s| s.level.radius).collect()
    }

    /// Number of samples of each exemplar element at the finest level.
    pub(crate) fn samples_per_element(&self) -> Vec<usize> {
        let parts = |s: &LevelExemplar<D>| s.level.parts.iter().take(s.level.base as usize).map(Vec::len).collect();
        self.levels.last().map_or_else(Vec::new, parts)
    }

    /// Fills a domain.
    ///
    /// # Errors
    /// As [`crate::Prepared::run`].
    pub(crate) fn filled(&self, request: &Request<D>, watch: &mut dyn Watch<Snapshot<D>>) -> Result<Outcome<D>> {
        let (levels, mut warnings) = self.usable_levels(request);
        let iterations = if levels.is_empty() { 0 } else { self.params.iterations };
        // Where no neighbourhood fits, the first layout is all there can be.
        let levels = if levels.is_empty() { vec![self.levels.len() - 1] } else { levels };
        // Levels without curves share one exemplar; what it means for the request is then worked out once.
        let used = if self.has_curves() { &levels[..] } else { &levels[..1] };
        let extents: Vec<_> = used
            .iter()
            .map(|&k| {
                Extent::new(request, &self.levels[k].exemplar, &self.levels[k].library, self.levels[k].level.base)
            })
            .collect::<Result<_>>()?;
        let targets: Vec<_> = used
            .iter()
            .zip(&extents)
            .map(|(&k, extent)| class_targets(&self.levels[k].library, request, extent, self.levels[k].level.base))
            .collect::<Result<_>>()?;
        checks::expected(targets.iter().map(|t| t.iter().sum()).fold(0.0, f64::max), &request.budget)?;
        let context = |(n, &k): (usize, &usize)| {
            let shared = n.min(used.len() - 1);
            LevelContext { sampled: &self.levels[k], extent: &extents[shared], targets: &targets[shared] }
        };
        let contexts: Vec<_> = levels.iter().enumerate().map(context).collect();
        let evenness = self.evenness.as_ref();
        let run = Run { params: &self.params, request, contexts, evenness, iterations };
        let (count, work) = Self::forecast(&run);
        request.budget.allow_elements(count);
        watch.foreseen(&request.budget.forecast(count, work));
        let mut trace = Vec::new();
        let Made { snapshot: mut found, mut cut_short } = run.synthesise(&mut trace, watch)?;
        if cut_short.is_none() && !found.placements.is_empty() {
            cut_short = run.mending(&found, watch).err();
        }
        let last = &extents[extents.len() - 1];
        let budget = if cut_short.is_some() { ending::last_touches(&request.budget) } else { request.budget.clone() };
        match placements::mend(&mut found.placements, self.clearance.as_deref(), last, &self.params, &budget) {
            Ok(mended) => warnings.extend(mended),
            Err(error) => {
                found.placements.retain(|p| p.frozen.is_some() || last.keeps_rule(p));
                cut_short = cut_short.or(Some(error));
            }
        }
        if cut_short.is_none() && self.params.clearance == Clearance::Repaired {
            let (sampled, targets) = (&self.levels[used[used.len() - 1]], &targets[targets.len() - 1]);
            cut_short = {
                let wanted = (targets, self.params.even == Switch::On);
                solids::mend(&mut found.placements, &self.exemplar, &sampled.library, last, wanted).err()
            };
        }
        if found.placements.is_empty() && found.curves.is_empty() {
            if let Some(error) = cut_short {
                return Err(error);
            }
            let what = if self.has_curves() { "stroke" } else { "element" };
            return Err(Error::no_result(
                format!("no {what} fits into the domain"),
                "make the domain larger, lower the scale, or allow elements to cross its border",
            ));
        }
        let stopped = ending::reason(cut_short, &mut warnings)?;
        let Snapshot { placements, curves, .. } = found;
        Ok(Outcome { placements, sequence: Vec::new(), curves, areas: Vec::new(), energy: trace, warnings, stopped })
    }

    /// See [`crate::Prepared::without_overlaps`].
    ///
    /// # Errors
    /// As there.
    pub(crate) fn without_overlaps(
        &self,
        placements: &mut Vec<Placement<D>>,
        laps: bool,
        request: &Request<D>,
    ) -> Result<()> {
        let Some(sampled) = self.levels.last() else { return Ok(()) };
        let extent = Extent::new(request, &sampled.exemplar, &sampled.library, sampled.level.base)?;
        solids::take_out(placements, laps, (&self.exemplar, &sampled.library), &extent)
    }

    /// How many elements and samples there will be, and what a run will take, by what its samples take in each iteration.
    fn forecast(run: &Run<'_, D>) -> (f64, f64) {
        let of_level = |context: &LevelContext<'_, D>| -> (f64, f64) {
            let (library, base) = (&context.sampled.library, context.sampled.level.base);
            let is_stroke = |c: usize| library.members(c as u32).first().is_some_and(|&e| e >= base);
            let price = |c: usize| if is_stroke(c) { PER_SAMPLE } else { PER_ELEMENT };
            let each = context.targets.iter().enumerate().map(|(c, &n)| (n, n * price(c)));
            each.fold((0.0, 0.0), |(count, work), (n, more)| (count + n, work + more))
        };
        let levels: Vec<_> = run.contexts.iter().map(of_level).collect();
        let work: f64 = levels.iter().map(|(_, work)| work).sum();
        (levels.iter().map(|(count, _)| *count).fold(0.0, f64::max), work * run.iterations as f64)
    }

    /// What may be wrong with an exemplar.
    fn exemplar_warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let giants = self.levels.first().map_or(0, |s| s.library.giants);
        warnings.extend(checks::giants_left_out(giants));
        let Some(sampled) = self.levels.first().filter(|_| self.has_curves()) else { return warnings };
        let side = self.exemplar.view().side();
        if sampled.level.radius >= 0.5 * side {
            warnings.push(Warning::new(
                format!(
                    "the exemplar is hardly larger than one neighbourhood: {side:.4} across, and it takes {:.4} \
                     to see one",
                    2.0 * sampled.level.radius
                ),
                "show more of the pattern, or set a smaller radius or spacing",
            ));
        }
        // A large irregular net has nothing alike either, but enough of it to be one of a kind.
        let nodes = sampled.level.net.as_ref().map_or(0, |net| net.nodes.len());
        if nodes < MIN_RANDOM_NODES && self.dissimilarity.is_none_or(|s| s > MAX_DISSIMILARITY) {
            warnings.push(Warning::new(
                "no part of the exemplar's curves looks like another: there is nothing to repeat",
                "draw the pattern several times over, so that the exemplar shows how it goes on",
            ));
        }
        let Some(net) = &sampled.level.net else { return warnings };
        let covered = crowding::coverage(&net.skeleton, &self.exemplar.window, CROWDED);
        if covered > CROWDED {
            warnings.push(Warning::new(
                format!(
                    "strokes at least as wide as their spacing: they cover {:.0} % of the exemplar and run into one another",
                    100.0 * covered
                ),
                "use thinner strokes; lines closer than their width are taken to touch",
            ));
        }
        let short = self.lost_curves(&net.skeleton);
        if short > 0 {
            warnings.push(Warning::new(
                format!("strokes too short to be seen left out: {short}, each below a thousandth of the exemplar"),
                "draw them longer, or as dots: filled circles",
            ));
        }
        warnings
    }

    /// Curves in the window that are in no line of the skeleton and not part of a junction either.
    fn lost_curves(&self, skeleton: &Skeleton<D>) -> usize {
        let mut is_seen = Numbered::filled(false, self.exemplar.curves.len());
        skeleton.lines.iter().for_each(|line| is_seen[line.curve] = true);
        let side = self.exemplar.view().side();
        let is_lost = |n: &usize| {
            let centre = self.exemplar.curves[*n].path.bounds().centre();
            self.exemplar.view().contains(centre) && !skeleton.is_in_junction(centre, side)
        };
        (0..is_seen.len()).filter(|&n| !is_seen[n]).filter(is_lost).count()
    }

    fn has_curves(&self) -> bool {
        self.levels.iter().any(|s| s.level.net.is_some())
    }

    /// Levels whose neighbourhoods fit into the domain, and what to say about the rest.
    fn usable_levels(&self, request: &Request<D>) -> (Vec<usize>, Vec<Warning>) {
        let mut warnings = Vec::new();
        let inside = self.exemplar.elements.iter().filter(|e| self.exemplar.view().contains(e.centre)).count();
        if inside < MIN_ELEMENTS && !self.has_curves() {
            warnings.push(Warning::new(
                format!("the exemplar shows only {inside} elements"),
                format!(
                    "draw {MIN_ELEMENTS} or more, so that the output need not repeat the few arrangements there are"
                ),
            ));
        }
        warnings.extend(self.exemplar_warnings());
        let room = request
            .domain
            .period()
            .map_or(f64::INFINITY, |p| 0.5 * shortest(p) / Extent::<D>::largest_spacing_scale(request));
        let levels = self.levels.len();
        let fits: Vec<_> = (0..levels).filter(|&l| self.levels[l].level.radius <= room).collect();
        if fits.len() < levels {
            warnings.push(Warning::new(
                format!("the tile is too small for {} of {levels} levels", levels - fits.len()),
                "make the tile larger, or set a smaller radius",
            ));
        }
        (fits, warnings)
    }
}
