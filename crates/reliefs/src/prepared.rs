//! A texture that is understood once and continued as often as wanted.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Error, PointSet, Progress, Result, StopReason, Warning, Watch};

use crate::{
    ground::canvas::Canvas,
    ground::hole::HoleCanvas,
    ground::on_mesh::MeshCanvas,
    ground::plane::PlaneCanvas,
    ground::relax::relax,
    params::ReliefParams,
    patch::notes::Notes,
    request::{Ground, ReliefOutcome, ReliefRequest, Statistics},
    sample::Sample,
    texture::{axes::Axes, understand::Texture},
};
use arabesque_surface::MeshIndex;

/// Work units that a point of the result may take, at most.
const EACH: f64 = 60_000.0;
/// The same as they usually are.
const WORK: f64 = 10_000.0;
/// Questions to a mesh for each point of the result.
const QUESTIONS: f64 = 20.0;
/// Overlap of the patches in a gap at least, as a share of the patch.
const GAP_OVERLAP: f64 = 0.2;
/// How much worse than the best a patch in a gap may be at most.
const GAP_TOLERANCE: f64 = 0.1;
/// How many more patches are tried in a gap.
const GAP_TRIES: usize = 4;
/// Share of points in overlaps that may be torn before it is told.
const TOLD: f64 = 0.03;

/// A prepared texture.
#[derive(Clone, Debug)]
pub struct Prepared {
    texture: Arc<Texture>,
    params: ReliefParams,
}

impl Prepared {
    /// Understands a texture: its plane and height, the box of the texture proper, its distance field, what repeats in it. `bounds` is the box
    /// where it is known; the points have to go on beyond it. Where it is not known, it is made smaller than the points.
    ///
    /// # Errors
    /// When there are too few points, when some are not numbers, when normals are missing in part or contradict one another, when a patch is larger
    /// than the box, or the box than the points; [`Error::Parameter`] for parameters out of range; [`Error::Limit`] when the budget is used up.
    pub fn new(
        points: &PointSet<3>,
        bounds: Option<Bounds<3>>,
        params: &ReliefParams,
        budget: &Budget,
    ) -> Result<Self> {
        params.check()?;
        let budget = budget.stage("preparing the texture");
        let texture = Texture::new(points, (bounds, false), params, &budget)?;
        Ok(Self { texture: Arc::new(texture), params: params.clone() })
    }

    /// Understands a scan with a gap that is to be filled: patches are taken from beside it.
    ///
    /// # Errors
    /// As [`Prepared::new`], and when nothing is empty that is wider than the holes of the texture, or when there is no room for patches beside it.
    pub fn with_gap(
        points: &PointSet<3>,
        bounds: Option<Bounds<3>>,
        params: &ReliefParams,
        budget: &Budget,
    ) -> Result<Self> {
        params.check()?;
        let budget = budget.stage("preparing the scan");
        // A gap is closed once, in one place: what fits best is wanted there, with little variety.
        let params = ReliefParams {
            tolerance: params.tolerance.min(GAP_TOLERANCE),
            apart: 0.0,
            overlap: Some(params.overlap.map_or(GAP_OVERLAP, |o| o.max(GAP_OVERLAP))),
            tries: params.tries.saturating_mul(GAP_TRIES),
            ..params.clone()
        };
        let texture = Texture::new(points, (bounds, true), &params, &budget)?;
        Ok(Self { texture: Arc::new(texture), params })
    }

    /// Number of points of the texture.
    pub fn points(&self) -> usize {
        self.texture.points.len()
    }

    /// Distance of neighbouring points, about.
    pub fn spacing(&self) -> f64 {
        self.texture.spacing
    }

    /// Side of a patch.
    pub fn patch(&self) -> f64 {
        self.texture.patch_side()
    }

    /// How far the texture is from where it looks like itself again, if it does.
    pub fn repetition(&self) -> Option<f64> {
        self.texture.repetition.length.map(|cells| cells * self.texture.lattice.cell)
    }

    /// The two shortest shifts along x and y of its plane that carry a strictly repeating texture into itself.
    pub fn repeat(&self) -> Option<[[f64; 2]; 2]> {
        self.texture.repetition.repeat.map(|r| r.shifts.map(|s| s.map(|v| v * self.texture.lattice.cell)))
    }

    /// For a tile whose sides do not suit what repeats: for each of them the nearest that does, below and above; `None` for a tile that suits.
    pub fn better_tile(&self, size: [f64; 2]) -> Option<[[Option<f64>; 2]; 2]> {
        let (repeat, cell) = (self.texture.repetition.repeat?, self.texture.lattice.cell);
        let cells = size.map(|s| s / cell);
        let nearest = |k: usize| repeat.lengths(k, cells[k]).map(|near| near.map(|length| length * cell));
        repeat.closing(cells).is_none().then(|| [nearest(0), nearest(1)])
    }

    /// How well the texture agrees with itself there: 0 to 1.
    pub fn regularity(&self) -> f64 {
        self.texture.repetition.strength
    }

    /// Width, depth and height of the texture proper, in its plane.
    pub fn size(&self) -> [f64; 3] {
        self.texture.bounds.size().0
    }

    /// How the axes of the file go with the plane, and how far the texture leans from it.
    pub fn axes(&self) -> Axes {
        self.texture.axes
    }

    /// What was noticed.
    pub fn warnings(&self) -> &[Warning] {
        &self.texture.warnings
    }

    /// Whether a mesh may be covered at this scale: for those who have work to do before that.
    ///
    /// # Errors
    /// [`Error::Limit`] when there would be more points than the limit `output-elements`.
    pub fn foresee(&self, mesh: &MeshIndex, scale: f64, budget: &Budget) -> Result<()> {
        let expected = self.expected(mesh.area() / (scale * scale));
        let limit = budget.limits().output_elements;
        budget.within_expected("points of the result", expected, ("output-elements", limit))?;
        budget.allow_elements(expected * EACH / 1e6);
        Ok(())
    }

    /// Makes as much as the request wants. Stopped early, it gives the best so far.
    ///
    /// # Errors
    /// When there is no room for a patch, or the budget is used up before there are points.
    pub fn run(&self, request: &ReliefRequest, watch: &mut dyn Watch<PointSet<3>>) -> Result<ReliefOutcome> {
        let budget = request.budget.stage("laying patches");
        let both = (&*self.texture, &self.params);
        let canvas: Box<dyn Canvas + '_> = match &request.ground {
            Ground::Plane(size) | Ground::Tile(size) => {
                let is_tile = matches!(request.ground, Ground::Tile(_));
                self.allow((self.expected(size[0] * size[1]), 0.0), &budget, watch)?;
                Box::new(PlaneCanvas::new(both, *size, is_tile, request.seed, &budget)?)
            }
            Ground::Hole => {
                self.allow((2.0 * self.points() as f64, 0.0), &budget, watch)?;
                Box::new(HoleCanvas::new(both, request.seed, &budget)?)
            }
            Ground::Mesh(mesh, directions, scale) => {
                let expected = self.expected(mesh.area() / (scale * scale));
                self.allow((expected, QUESTIONS * mesh.dearness()), &budget, watch)?;
                Box::new(MeshCanvas::new(both, (mesh, directions, *scale), request.seed, &budget)?)
            }
        };
        self.cover(canvas, &budget, watch)
    }

    /// Points on so much of the plane.
    fn expected(&self, area: f64) -> f64 {
        let size = self.texture.points.len() as f64;
        let all = Bounds::around(self.texture.points.positions().iter().copied()).size();
        size * area / (all[0] * all[1])
    }

    /// Allows the work of as many points, and tells how much that will be, with what each takes beyond the usual.
    fn allow(&self, (expected, beyond): (f64, f64), budget: &Budget, watch: &mut dyn Watch<PointSet<3>>) -> Result<()> {
        let limits = budget.limits();
        budget.within_expected("points of the result", expected, ("output-elements", limits.output_elements))?;
        budget.allow_elements(expected * EACH / 1e6);
        let work = expected * (WORK + beyond);
        watch.foreseen(&budget.forecast(expected, work));
        Ok(())
    }

    /// Lays patch after patch.
    fn cover(
        &self,
        mut canvas: Box<dyn Canvas + '_>,
        budget: &Budget,
        watch: &mut dyn Watch<PointSet<3>>,
    ) -> Result<ReliefOutcome> {
        let mut notes = Notes::default();
        let mut stopped = StopReason::Finished;
        loop {
            match canvas.step() {
                Ok(None) => break,
                Ok(Some(more)) => notes.add(more),
                Err(error) if notes.patches == 0 => return Err(error),
                Err(Error::Limit { .. }) => stopped = StopReason::Limit,
                Err(Error::Stopped { .. }) => stopped = StopReason::Stopped,
                Err(error) => return Err(error),
            }
            if stopped != StopReason::Finished {
                break;
            }
            let (done, total) = (notes.patches, canvas.steps().max(notes.patches));
            let progress = Progress {
                stage: "laying patches".into(),
                done,
                total,
                fraction: done as f64 / total as f64,
                energy: None,
                count: canvas.count(),
            };
            let preview = || self.points_of(&canvas.samples(), canvas.is_flat()).0;
            if watch.step(&progress, &preview).is_break() {
                stopped = StopReason::Stopped;
                break;
            }
        }
        self.outcome(canvas, notes, stopped, budget)
    }

    fn outcome(
        &self,
        canvas: Box<dyn Canvas + '_>,
        notes: Notes,
        stopped: StopReason,
        budget: &Budget,
    ) -> Result<ReliefOutcome> {
        let (period, extent) = (canvas.period(), canvas.extent());
        let (is_flat, scale) = (canvas.is_flat(), canvas.scale());
        let mut samples = canvas.into_samples();
        let mut warnings = self.texture.warnings.clone();
        let spent = (stopped == StopReason::Limit).then(|| budget.spent());
        // What is still to be done with the best so far has an account of its own.
        let budget = if stopped == StopReason::Finished { budget.clone() } else { budget.fresh() };
        let texture = &*self.texture;
        let scale = (texture.spacing * scale, texture.radius * scale);
        // Who asks to stop does not want to wait for points to be evened out; without the time for it they stay where they are.
        let rounds = if stopped == StopReason::Stopped { 0 } else { self.params.relax };
        let merged = match relax(&mut samples, scale, rounds, (period, extent), &budget) {
            Ok(merged) => merged,
            Err(Error::Limit { .. } | Error::Stopped { .. }) => 0,
            Err(error) => return Err(error),
        };
        if let Some([width, depth]) = period {
            for s in &mut samples {
                (s.at[0], s.at[1]) = (s.at[0].rem_euclid(width), s.at[1].rem_euclid(depth));
            }
        }
        if samples.is_empty() {
            return Err(Error::no_result("no point lies within the extent", "make it larger"));
        }
        if let Some((message, advice)) = spent {
            warnings.push(Warning::new(message, advice));
        }
        let torn = notes.cracks + notes.unmatched;
        if torn as f64 > TOLD * notes.overlapped as f64 {
            let message = format!(
                "patches do not fit well: {torn} of {} points where they meet have nothing to go on to",
                notes.overlapped
            );
            warnings.push(Warning::new(message, "give a larger texture, other patches with --patch, or another seed"));
        }
        let (points, sources) = self.points_of(&samples, is_flat);
        let statistics = Statistics {
            patches: notes.patches,
            folds: notes.folds,
            passed: notes.passed,
            unbent: notes.unbent,
            overlapped: notes.overlapped,
            by_ray: notes.by_ray,
            by_projection: notes.by_projection,
            seams: notes.unmatched,
            cracks: notes.cracks,
            merged,
        };
        Ok(ReliefOutcome { points, sources, statistics, warnings, stopped })
    }

    /// Samples as points with the attributes of the texture.
    fn points_of(&self, samples: &[Sample], is_flat: bool) -> (PointSet<3>, Vec<usize>) {
        let texture = &*self.texture;
        // What closes a gap lies where the gap is; a larger texture lies flat.
        let place = |v| match (is_flat, &texture.gap) {
            (true, Some(_)) => texture.axes.back(v),
            (true, None) => texture.axes.stand(v),
            (false, _) => v,
        };
        let sources: Vec<usize> = samples.iter().map(|s| s.source as usize).collect();
        let points = PointSet {
            positions: samples.iter().map(|s| place(s.at)).collect(),
            normals: Some(samples.iter().map(|s| place(s.normal)).collect()),
            colours: texture.colours.as_ref().map(|_| samples.iter().map(|s| s.colour.map(f64::from)).collect()),
            radii: texture.radii.as_ref().map(|r| sources.iter().map(|&i| r[i]).collect()),
            groups: texture.groups.as_ref().map(|g| sources.iter().map(|&i| g[i]).collect()),
            ..PointSet::default()
        };
        (points, sources)
    }
}
