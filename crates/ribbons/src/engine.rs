//! From exemplars and curves to ribbons.

use std::sync::Arc;

use arabesque_core::{Budget, Error, Patch, Path, Progress, Result, Snapshot, StopReason, Vector, Warning, Watch};
use rayon::prelude::*;

use crate::{
    constraints::demands::{Plan, changes},
    constraints::mask::{Forbidden, Mask},
    constraints::valid::{Grade, Offset, Position},
    exemplar::columns::Columns,
    exemplar::strip::{self, Strip, StripExemplar, sample},
    forecast::{Pace, USUAL},
    geometry::cage::{Cage, CagePlan},
    objects::{
        find::{self, Objects},
        run,
    },
    params::RibbonParams,
    pieces::piece::{Piece, Ribbon},
    pieces::stitch,
    request::RibbonRequest,
    search::reuse::Reuse,
    search::solve::{Course, Ended, Kept, Solution},
};

/// What errors of a run begin with.
const LAYING: &str = "laying pieces";
/// Elements of a drawing that a piece counts as, for the work that each adds: it is looked for all over the exemplar.
const ELEMENTS: f64 = 25.0;
/// Most work of stitching that is still done when somebody asked to stop; pieces that would take more stay unbent.
const QUICK: u64 = 200_000_000;

/// The result of a run.
#[derive(Clone, Debug)]
pub struct RibbonOutcome<const D: usize> {
    /// One ribbon per curve, in order; fewer when the run was stopped.
    pub ribbons: Vec<Ribbon<D>>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Why the run ended.
    pub stopped: StopReason,
    /// What another run can take over.
    pub memory: Memory,
}

/// Rows of a run, from which a run with a slightly different curve goes on.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    curves: Vec<Vec<Kept>>,
    basis: Option<Basis>,
    /// Pieces whose row was taken over from the run before.
    pub resumed: usize,
}

/// What all rows depend on.
#[derive(Clone, Debug, PartialEq)]
struct Basis {
    params: RibbonParams,
    seed: u64,
    exemplars: Arc<Vec<StripExemplar>>,
}

/// Exemplars that are ready to be laid along curves.
#[derive(Clone, Debug)]
pub struct Prepared {
    exemplars: Arc<Vec<StripExemplar>>,
    params: RibbonParams,
    /// As the search sees them.
    strip: Strip,
    /// Rows of the highest one.
    height: usize,
    /// What they consist of, where that is separate objects.
    objects: Option<Arc<Objects>>,
}

/// One curve of a run.
struct CurveRun<'a, const D: usize> {
    cage: &'a Cage<D>,
    /// The pixels that each piece leaves free.
    free: &'a [Arc<Vec<Offset>>],
    /// What messages call it.
    name: &'a str,
    request: &'a RibbonRequest<D>,
    /// Rows of an earlier run that may be taken over.
    rows: &'a [Kept],
    budget: &'a Budget,
}

impl<const D: usize> RibbonOutcome<D> {
    fn new() -> Self {
        let (stopped, memory) = (StopReason::Finished, Memory::default());
        Self { ribbons: Vec::new(), warnings: Vec::new(), stopped, memory }
    }

    /// What was laid so far is all there will be.
    fn end(&mut self, ended: Ended) {
        self.stopped = StopReason::Stopped;
        if matches!(ended, Ended::Budget(Error::Limit { .. })) {
            self.stopped = StopReason::Limit;
        }
        if let Ended::Budget(Error::Limit { what, found, limit, advice }) = ended {
            let message = format!("{what}: {found} is over the limit of {limit}; this is what was laid until then");
            self.warnings.push(Warning::new(message, advice));
        }
    }
}

impl Prepared {
    /// Prepares `exemplars`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter out of range, [`Error::Input`] for an exemplar that has no pattern on a transparent background,
    /// [`Error::Limit`] beyond [`strip::PIXELS`], or when the work or the memory is used up.
    pub fn new(exemplars: Vec<StripExemplar>, params: RibbonParams, budget: &Budget) -> Result<Self> {
        params.check()?;
        strip::check(&exemplars, params.coarse, params.relax, budget)?;
        let strip = Strip::new(&exemplars, params.coarse, budget)?;
        let height = exemplars.iter().map(|e| e.image.height).max().unwrap_or(0);
        let objects = find::find(&exemplars, budget)?.map(Arc::new);
        Ok(Self { exemplars: Arc::new(exemplars), params, strip, height, objects })
    }

    /// The exemplars.
    pub fn exemplars(&self) -> &[StripExemplar] {
        &self.exemplars
    }

    /// How many separate objects the exemplars consist of; `None` where their pattern goes on.
    pub fn objects(&self) -> Option<usize> {
        self.objects.as_ref().map(|objects| objects.list.len())
    }

    /// Lays the pattern along curves in the plane.
    ///
    /// When the budget is used up or somebody asks to stop, the pieces that were laid until then are the result, with
    /// [`StopReason::Stopped`].
    ///
    /// # Errors
    /// [`Error::NoResult`] names a piece for which no part of the exemplar is valid; [`Error::Input`] and [`Error::Limit`] a curve that
    /// cannot be used. [`Error::Limit`] and [`Error::Stopped`] also when the run ended before there was a piece.
    pub fn run(&self, request: &RibbonRequest<2>, watch: &mut dyn Watch<Snapshot<2>>) -> Result<RibbonOutcome<2>> {
        self.resume(request, &Memory::default(), watch)
    }

    /// The same as [`Prepared::run`], and the same result, taking over from an earlier run what did not change: the pieces before the
    /// first one that differs.
    ///
    /// # Errors
    /// As [`Prepared::run`].
    pub fn resume(
        &self,
        request: &RibbonRequest<2>,
        before: &Memory,
        watch: &mut dyn Watch<Snapshot<2>>,
    ) -> Result<RibbonOutcome<2>> {
        let budget = request.budget.stage(LAYING);
        let cages = self.cages(&request.curves, Cage::<2>::along, &budget)?;
        let mask = request.avoid.as_ref();
        if self.objects.is_some() {
            let blocked = mask.map(|mask| move |p: Vector<2>| mask.blocks(p));
            let blocked = blocked.as_ref().map(|b| b as &dyn Fn(Vector<2>) -> bool);
            return self.lay_objects(&cages, request, blocked, watch);
        }
        let pieces = allow(&cages, &budget);
        let free = Forbidden::of(&cages, mask, self.strip.longest() as f64, &budget, &mut |work| {
            watch.foreseen(&budget.forecast(pieces as f64, work + USUAL * pieces as f64));
        })?;
        let mut outcome = self.lay(&cages, &free, (request, before), watch)?;
        let Some(mask) = mask else { return Ok(outcome) };
        let spared = self.spare(&mut outcome.ribbons, &cages, mask, &after(&budget, outcome.stopped));
        if let Err(error) = spared {
            outcome.end(Ended::of(error)?);
        }
        Ok(outcome)
    }

    /// Lays the pattern along curves in space, on a strip that follows the curve without twisting more than it must.
    ///
    /// # Errors
    /// As [`Prepared::run`].
    pub fn run_in_space(
        &self,
        request: &RibbonRequest<3>,
        watch: &mut dyn Watch<Snapshot<3>>,
    ) -> Result<RibbonOutcome<3>> {
        let cages = self.cages(&request.curves, Cage::<3>::in_space, &request.budget.stage(LAYING))?;
        if self.objects.is_some() {
            return self.lay_objects(&cages, request, None, watch);
        }
        allow(&cages, &request.budget);
        self.lay(&cages, &Forbidden::none(&cages), (request, &Memory::default()), watch)
    }

    /// The ribbons around all curves, after what can be known of them was found to be within the limits.
    fn cages<const D: usize>(
        &self,
        curves: &[(String, Path<D>)],
        cut: impl Fn(&Path<D>, &CagePlan<'_>) -> Result<Cage<D>>,
        budget: &Budget,
    ) -> Result<Vec<Cage<D>>> {
        let plan = |params, place| CagePlan { params, height: self.height as f64, place, budget };
        let params = match self.objects {
            Some(_) => &run::fine(&self.params, self.height as f64),
            None => &self.params,
        };
        let plan = |place| plan(params, place);
        plan("").check_width()?;
        let (mut cages, mut pieces, mut stitches) = (Vec::new(), 0, 0_u64);
        let limit = budget.limits().output_elements;
        for (name, path) in curves {
            let cage = cut(path, &plan(name))?;
            if self.objects.is_none() {
                check_folds(name, &cage)?;
            }
            pieces += cage.len();
            budget.within("pieces along all curves", pieces, ("output-elements", limit))?;
            if self.params.stitch && self.objects.is_none() {
                let (work, bytes) = stitch::demand(cage.forms.iter().map(|form| form.rows()).max().unwrap_or(0));
                budget.hold("stitches across the whole width of the ribbon", bytes)?;
                stitches = stitches.saturating_add(work.saturating_mul(cage.len() as u64));
            }
            cages.push(cage);
        }
        budget.foresee(stitches)?;
        Ok(cages)
    }

    /// Separate objects along all curves.
    fn lay_objects<const D: usize>(
        &self,
        cages: &[Cage<D>],
        request: &RibbonRequest<D>,
        blocked: Option<&dyn Fn(Vector<D>) -> bool>,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<RibbonOutcome<D>> {
        let mut outcome = RibbonOutcome::new();
        let Some(objects) = &self.objects else { return Ok(outcome) };
        let course = run::Course {
            objects,
            params: &self.params,
            curves: &request.curves,
            cages,
            changes: &changes(&request.changes, self.exemplars.len())?,
            first: request.first.map(|(column, _)| column),
            seed: request.seed,
            budget: &request.budget.stage(LAYING),
        };
        let laid = course.lay(blocked, &mut |progress, ribbons| {
            let patches = || ribbons.iter().flat_map(|ribbon| ribbon.pieces.iter().map(|p| p.patch)).collect();
            watch.step(&progress, &|| Snapshot { patches: patches(), ..Snapshot::default() }).is_continue()
        })?;
        match laid.ended {
            None => {}
            Some(run::Ended::Watch) => outcome.end(Ended::Watch),
            Some(run::Ended::Budget(error)) => outcome.end(Ended::of(error)?),
        }
        outcome.warnings.extend(laid.warnings);
        outcome.ribbons = laid.ribbons;
        Ok(outcome)
    }

    fn lay<const D: usize>(
        &self,
        cages: &[Cage<D>],
        free: &Forbidden,
        (request, before): (&RibbonRequest<D>, &Memory),
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<RibbonOutcome<D>> {
        let budget = request.budget.stage(LAYING);
        let basis = Basis { params: self.params.clone(), seed: request.seed, exemplars: Arc::clone(&self.exemplars) };
        let known = before.basis.as_ref() == Some(&basis);
        let mut memory = Memory { basis: Some(basis), ..Memory::default() };
        let mut outcome = RibbonOutcome::new();
        let total: usize = cages.iter().map(Cage::len).sum();
        let mut pace = Pace::new(total, budget.work());
        let mut done = 0;
        for (k, (cage, free)) in cages.iter().zip(&free.cages).enumerate() {
            let name = &request.curves[k].0;
            let rows = if known { before.curves.get(k).map_or(&[][..], |c| c) } else { &[] };
            let curve = CurveRun { cage, free, name, request, rows, budget: &budget };
            let finished = &outcome.ribbons;
            let solved = self.solve(&curve, &mut |rows, energy, path| {
                if let Some(work) = pace.at(done + rows, budget.work()) {
                    watch.foreseen(&budget.forecast(total as f64, work));
                }
                let progress = progress(done + rows, total, energy);
                let preview = || Snapshot { patches: self.preview(finished, cage, &path()), ..Snapshot::default() };
                watch.step(&progress, &preview).is_continue()
            });
            let mut solution = match solved {
                Ok(solution) => solution,
                Err(error) if k == 0 => return Err(error),
                Err(error) => {
                    outcome.end(Ended::of(error)?);
                    break;
                }
            };
            done += cage.len();
            memory.resumed += solution.resumed;
            outcome.warnings.extend(forced(name, &solution, cage));
            outcome.ribbons.push(self.ribbon(cage, &mut solution, &budget)?);
            memory.curves.push(solution.kept);
            if let Some(ended) = solution.ended {
                outcome.end(ended);
                break;
            }
        }
        outcome.memory = memory;
        Ok(outcome)
    }

    fn solve<const D: usize>(
        &self,
        curve: &CurveRun<'_, D>,
        watch: &mut crate::search::solve::Watch<'_>,
    ) -> Result<Solution> {
        let CurveRun { cage, request, name, budget, .. } = *curve;
        let plan = Plan { strip: &self.strip, params: &self.params, request, cage, budget };
        let demands = plan.demands(curve.free.to_vec())?;
        let reuse = Reuse::new(&self.params, request.seed, (cage.len(), &cage.forms[0]), &self.strip, budget)?;
        let places: Vec<String> = (0..cage.len()).map(|k| place(cage, k)).collect();
        let course = Course {
            strip: &self.strip,
            params: &self.params,
            forms: &cage.forms,
            demands: &demands,
            closed: cage.closed,
            reuse,
            name,
            places: &places,
            budget,
        };
        course.solve(curve.rows, watch)
    }

    fn preview<const D: usize>(&self, finished: &[Ribbon<D>], cage: &Cage<D>, path: &[Position]) -> Vec<Patch<D>> {
        let patches = finished.iter().flat_map(|ribbon| ribbon.pieces.iter().map(|p| p.patch));
        let path = path.iter().take(cage.len()).enumerate();
        patches.chain(path.map(|(k, &position)| self.patch(cage, k, position))).collect()
    }

    /// Piece `k` of `cage`, at `position` in the strip.
    fn patch<const D: usize>(&self, cage: &Cage<D>, k: usize, position: Position) -> Patch<D> {
        let source = self.strip.owner(usize::from(position.x));
        let (form, coarse) = (&cage.forms[k], self.params.coarse as f64);
        let x = f64::from(position.x) - self.strip.spans[source].start as f64 + 0.5;
        let corner = Vector::xy(x, f64::from(position.y) - self.strip.above[source] as f64);
        let texture = [Vector::ZERO, form.top, form.bottom, form.foot].map(|p| (corner + p) * coarse);
        let (a, b) = (&cage.rungs[k], &cage.rungs[k + 1]);
        Patch { source, corners: [a.top, b.top, b.bottom, a.bottom], texture }
    }

    /// The pieces of a solution, bent to meet; `solution` then says whether that ended early.
    fn ribbon<const D: usize>(&self, cage: &Cage<D>, solution: &mut Solution, budget: &Budget) -> Result<Ribbon<D>> {
        let shifts = match &solution.ended {
            None | Some(Ended::Watch) => self.shifts(cage, solution, budget),
            Some(Ended::Budget(_)) => self.quick_shifts(cage, solution, budget),
        };
        let shifts = match shifts {
            Ok(shifts) => shifts,
            // A second request to stop ends it.
            Err(error) if matches!(solution.ended, Some(Ended::Budget(_))) => return Err(error),
            Err(error) => {
                solution.ended = Some(Ended::of(error)?);
                self.quick_shifts(cage, solution, budget)?
            }
        };
        let pieces = solution.positions.iter().zip(shifts).enumerate();
        let pieces = pieces.map(|(k, (&position, shift))| Piece { patch: self.patch(cage, k, position), shift });
        let whole = solution.positions.len() == cage.len();
        Ok(Ribbon { pieces: pieces.collect(), closed: cage.closed && whole, cost: solution.cost })
    }

    /// How the right edge of each piece is bent to meet the next one.
    fn shifts<const D: usize>(&self, cage: &Cage<D>, solution: &Solution, budget: &Budget) -> Result<Vec<Vec<f32>>> {
        let n = solution.positions.len();
        if !self.params.stitch {
            return Ok(vec![Vec::new(); n]);
        }
        let shift = |k: usize| {
            let next = if k + 1 < n { Some(k + 1) } else { (cage.closed && n == cage.len()).then_some(0) };
            next.map_or(Ok(Vec::new()), |next| self.shift(cage, [k, next], solution, budget))
        };
        let shifts = (0..n).into_par_iter().map(shift).collect::<Result<_>>()?;
        budget.spend(0)?;
        Ok(shifts)
    }

    /// The same on a fresh account, where that takes little time; else nothing is bent.
    fn quick_shifts<const D: usize>(
        &self,
        cage: &Cage<D>,
        solution: &Solution,
        budget: &Budget,
    ) -> Result<Vec<Vec<f32>>> {
        let n = solution.positions.len();
        let work: u64 = cage.forms[..n].iter().map(|form| stitch::demand(form.rows()).0).sum();
        if work > QUICK {
            return Ok(vec![Vec::new(); n]);
        }
        self.shifts(cage, solution, &budget.fresh())
    }

    /// How the right edge of piece `k` is bent to meet the left edge of `next`.
    fn shift<const D: usize>(
        &self,
        cage: &Cage<D>,
        [k, next]: [usize; 2],
        solution: &Solution,
        budget: &Budget,
    ) -> Result<Vec<f32>> {
        let (form, after) = (&cage.forms[k], &cage.forms[next]);
        let [own, others] = [k, next].map(|k| &solution.positions[k..=k]);
        let right = Columns::right(&self.strip, (form, after.rows()), 0.0, own, budget)?;
        let left = Columns::left(&self.strip, after, 0.0, others, budget)?;
        let pixels = (after.left() / after.rows() as f64 * self.params.coarse as f64) as f32;
        Ok(stitch::align(&right, &left, budget)?.into_iter().map(|samples| samples * pixels).collect())
    }

    /// Leaves pieces unbent where bending would put ink on the mask; all of them where there is no time to find out.
    fn spare(&self, ribbons: &mut [Ribbon<2>], cages: &[Cage<2>], mask: &Mask, budget: &Budget) -> Result<()> {
        let hits = ribbons.iter().zip(cages).map(|(ribbon, cage)| {
            let hit = |(k, piece): (usize, &Piece<2>)| {
                if piece.shift.is_empty() { Ok(false) } else { self.hits(piece, (cage, k), mask, budget) }
            };
            ribbon.pieces.par_iter().enumerate().map(hit).collect::<Result<Vec<bool>>>()
        });
        let hits = hits.collect::<Result<Vec<Vec<bool>>>>().and_then(|hits| budget.spend(0).map(|()| hits));
        for (r, ribbon) in ribbons.iter_mut().enumerate() {
            for (k, piece) in ribbon.pieces.iter_mut().enumerate() {
                if hits.as_ref().map_or(true, |hits| hits[r][k]) {
                    piece.shift.clear();
                }
            }
        }
        hits.map(|_| ())
    }

    /// Whether a piece puts ink on the mask as it is bent.
    fn hits(&self, piece: &Piece<2>, (cage, k): (&Cage<2>, usize), mask: &Mask, budget: &Budget) -> Result<bool> {
        let image = &self.exemplars[piece.patch.source].image;
        let around = cage.bounds(k).grown(2.0 * self.params.scale);
        let inked = |p: Vector<2>| sample(image, piece.bent(piece.to_exemplar(p)))[3] > 0.0;
        let inside = |p: Vector<2>| cage.forms[k].depth(cage.local(k, p)) > -1.5;
        let mut hit = false;
        mask.points(around, self.params.scale, &mut budget.meter(), |p| {
            hit = inside(p) && inked(p);
            Ok(hit)
        })?;
        Ok(hit)
    }
}

/// Refuses a curve with a piece that no position can fill, before any piece is laid.
fn check_folds<const D: usize>(name: &str, cage: &Cage<D>) -> Result<()> {
    let Some(k) = cage.forms.iter().position(|form| form.unfolded().is_none()) else { return Ok(()) };
    let (number, n, place) = (k + 1, cage.len(), place(cage, k));
    let problem = format!("{name}: piece {number} of {n}, at {place}: the curve turns back on itself within one piece");
    Err(Error::no_result(problem, "round the curve there, use shorter pieces (--step), or a narrower ribbon (--width)"))
}

/// Allows the work of all pieces, and says how many there are.
fn allow<const D: usize>(cages: &[Cage<D>], budget: &Budget) -> usize {
    let pieces = cages.iter().map(Cage::len).sum();
    budget.allow_elements(ELEMENTS * pieces as f64);
    pieces
}

/// What is left to do after a run is done on its own account, or on a fresh one when that has ended.
fn after(budget: &Budget, stopped: StopReason) -> Budget {
    if stopped == StopReason::Finished { budget.clone() } else { budget.fresh() }
}

fn progress(done: usize, total: usize, energy: f64) -> Progress {
    Progress {
        stage: LAYING.into(),
        done,
        total,
        fraction: done as f64 / total as f64,
        energy: Some(energy),
        count: done,
    }
}

/// Where a piece is, for messages.
fn place<const D: usize>(cage: &Cage<D>, k: usize) -> String {
    let centre = (cage.rungs[k].centre() + cage.rungs[k + 1].centre()) * 0.5;
    let numbers: Vec<String> = centre.0.iter().map(|c| format!("{c:.1}")).collect();
    numbers.join(",")
}

/// A warning about pieces at which rules were broken.
fn forced<const D: usize>(name: &str, solution: &Solution, cage: &Cage<D>) -> Option<Warning> {
    let first = solution.forced.first()?;
    let what = match solution.forced.iter().map(|f| f.1).max()? {
        Grade::Whole | Grade::Forbidden => "covers a place to avoid and is not drawn there",
        Grade::Cut => "is cut by the border of the ribbon",
        Grade::Any => "breaks off",
    };
    let count = solution.forced.len();
    let message = format!("{name}: at {count} pieces, the first at {}, the pattern {what}", place(cage, first.0));
    Some(Warning::new(message, "bend the curve less, avoid less, or change --width or --scale"))
}
