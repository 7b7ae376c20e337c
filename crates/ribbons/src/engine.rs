//! From exemplars and curves to ribbons.

use std::sync::Arc;

use arabesque_core::{Budget, Patch, Path, Progress, Result, Snapshot, StopReason, Vector, Warning, Watch};

use crate::{
    constraints::demands::Plan,
    constraints::mask::{Mask, forbidden},
    constraints::valid::{Demands, Grade, Position},
    exemplar::columns::Columns,
    exemplar::strip::{self, Strip, StripExemplar},
    geometry::cage::Cage,
    params::RibbonParams,
    pieces::piece::{Piece, Ribbon},
    pieces::stitch,
    request::RibbonRequest,
    search::reuse::Reuse,
    search::solve::{Course, Kept, Solution},
};

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
    /// As they are drawn.
    full: Strip,
}

/// One curve of a run.
struct CurveRun<'a> {
    /// What messages call it.
    name: &'a str,
    seed: u64,
    /// Rows of an earlier run that may be taken over.
    rows: &'a [Kept],
}

impl Prepared {
    /// Prepares `exemplars`.
    ///
    /// # Errors
    /// [`arabesque_core::Error::Parameter`] for a parameter out of range, [`arabesque_core::Error::Input`] for an exemplar that has no pattern on a transparent
    /// background, [`arabesque_core::Error::Limit`] beyond [`strip::PIXELS`].
    pub fn new(exemplars: Vec<StripExemplar>, params: RibbonParams, budget: &Budget) -> Result<Self> {
        params.check()?;
        budget.check()?;
        strip::check(&exemplars, params.coarse, params.relax)?;
        let (strip, full) = (Strip::new(&exemplars, params.coarse), Strip::new(&exemplars, 1));
        Ok(Self { exemplars: Arc::new(exemplars), params, strip, full })
    }

    /// The exemplars.
    pub fn exemplars(&self) -> &[StripExemplar] {
        &self.exemplars
    }

    /// Lays the pattern along curves in the plane.
    ///
    /// # Errors
    /// [`arabesque_core::Error::NoResult`] names a piece for which no part of the exemplar is valid; [`arabesque_core::Error::Input`] and [`arabesque_core::Error::Limit`] a curve that
    /// cannot be used.
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
        let along = |(name, path): &(String, Path<2>)| {
            Cage::along(path, &self.params, self.full.height as f64, self.scale(), name)
        };
        let cages = request.curves.iter().map(along).collect::<Result<Vec<_>>>()?;
        let free = forbidden(&cages, request.avoid.as_ref());
        let mut outcome = self.lay(&cages, free, request, before, watch)?;
        for (ribbon, cage) in outcome.ribbons.iter_mut().zip(&cages) {
            self.spare(ribbon, cage, request.avoid.as_ref());
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
        let along = |(name, path): &(String, Path<3>)| {
            Cage::in_space(path, &self.params, self.full.height as f64, self.scale(), name)
        };
        let cages = request.curves.iter().map(along).collect::<Result<Vec<_>>>()?;
        let free = cages.iter().map(|cage| vec![Vec::new(); cage.len()]).collect();
        self.lay(&cages, free, request, &Memory::default(), watch)
    }

    /// User units per pixel of the search.
    fn scale(&self) -> f64 {
        self.params.scale * self.params.coarse as f64
    }

    fn lay<const D: usize>(
        &self,
        cages: &[Cage<D>],
        free: Vec<Vec<Vec<crate::constraints::valid::Offset>>>,
        request: &RibbonRequest<D>,
        before: &Memory,
        watch: &mut dyn Watch<Snapshot<D>>,
    ) -> Result<RibbonOutcome<D>> {
        let basis = Basis { params: self.params.clone(), seed: request.seed, exemplars: Arc::clone(&self.exemplars) };
        let known = before.basis.as_ref() == Some(&basis);
        let mut memory = Memory { basis: Some(basis), ..Memory::default() };
        let mut outcome = RibbonOutcome {
            ribbons: Vec::new(),
            warnings: Vec::new(),
            stopped: StopReason::Finished,
            memory: Memory::default(),
        };
        let total = cages.iter().map(Cage::len).sum();
        let mut done = 0;
        for (k, (cage, free)) in cages.iter().zip(free).enumerate() {
            let name = &request.curves[k].0;
            let rows = if known { before.curves.get(k).map_or(&[][..], |c| c) } else { &[] };
            let demands = Plan { strip: &self.strip, params: &self.params, request, cage }.demands(free)?;
            let finished = &outcome.ribbons;
            let solution =
                self.solve(cage, &demands, &CurveRun { name, seed: request.seed, rows }, &mut |rows, energy, path| {
                    let iteration = done + rows;
                    let progress = Progress {
                        stage: "laying pieces".into(),
                        done: iteration,
                        total,
                        fraction: iteration as f64 / total as f64,
                        energy: Some(energy),
                        count: iteration,
                    };
                    let preview = || Snapshot { patches: self.preview(finished, cage, &path()), ..Snapshot::default() };
                    watch.step(&progress, &preview).is_continue()
                })?;
            done += cage.len();
            memory.resumed += solution.resumed;
            outcome.warnings.extend(forced(name, &solution, cage));
            outcome.ribbons.push(self.ribbon(cage, &solution));
            memory.curves.push(solution.kept);
            if solution.stopped {
                outcome.stopped = StopReason::Stopped;
                break;
            }
        }
        outcome.memory = memory;
        Ok(outcome)
    }

    fn solve<const D: usize>(
        &self,
        cage: &Cage<D>,
        demands: &[Demands],
        curve: &CurveRun<'_>,
        watch: &mut crate::search::solve::Watch<'_>,
    ) -> Result<Solution> {
        let reuse = Reuse::new(&self.params, curve.seed, cage.len(), &cage.forms[0], &self.strip);
        let places: Vec<String> = (0..cage.len()).map(|k| place(cage, k)).collect();
        let course = Course {
            strip: &self.strip,
            params: &self.params,
            forms: &cage.forms,
            demands,
            closed: cage.closed,
            reuse,
            name: curve.name,
            places: &places,
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

    fn ribbon<const D: usize>(&self, cage: &Cage<D>, solution: &Solution) -> Ribbon<D> {
        let n = solution.positions.len();
        let whole = n == cage.len();
        let pieces = solution.positions.iter().enumerate().map(|(k, &position)| {
            let next = if k + 1 < n { Some(k + 1) } else { (cage.closed && whole).then_some(0) };
            let shift = next.filter(|_| self.params.stitch).map(|next| self.shift(cage, k, next, solution));
            Piece { patch: self.patch(cage, k, position), shift: shift.unwrap_or_default() }
        });
        Ribbon { pieces: pieces.collect(), closed: cage.closed && whole, cost: solution.cost }
    }

    /// How the right edge of piece `k` is bent to meet the left edge of `next`.
    fn shift<const D: usize>(&self, cage: &Cage<D>, k: usize, next: usize, solution: &Solution) -> Vec<f32> {
        let right =
            Columns::right(&self.strip, &cage.forms[k], cage.forms[next].rows(), 0.0, &solution.positions[k..=k]);
        let left = Columns::left(&self.strip, &cage.forms[next], 0.0, &solution.positions[next..=next]);
        let pixels = (cage.forms[next].left() / cage.forms[next].rows() as f64 * self.params.coarse as f64) as f32;
        stitch::align(&right, &left).into_iter().map(|samples| samples * pixels).collect()
    }

    /// Leaves a piece unbent where bending would put ink on the mask.
    fn spare(&self, ribbon: &mut Ribbon<2>, cage: &Cage<2>, mask: Option<&Mask>) {
        let Some(mask) = mask else { return };
        for (k, piece) in ribbon.pieces.iter_mut().enumerate().filter(|(_, piece)| !piece.shift.is_empty()) {
            let strip = Strip::new(&self.exemplars[piece.patch.source..=piece.patch.source], 1);
            let around = cage.bounds(k).grown(2.0 * self.params.scale);
            let span = 0..strip.width;
            let inked = |p: Vector<2>| strip.sample(piece.bent(piece.to_exemplar(p)), &span)[3] > 0.0;
            let inside = |p: Vector<2>| cage.forms[k].depth(cage.local(k, p)) > -1.5;
            let hit = mask.points(around, self.params.scale).any(|p| inside(p) && inked(p));
            if hit {
                piece.shift.clear();
            }
        }
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
