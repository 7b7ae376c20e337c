//! The session: strokes one after another, each optimised where it reaches and nowhere else.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Domain, EnergyPoint, GridIndex, PointSet, Result, StopReason, Vector, Watch};

use super::stroke::{Area, Painted, Stroke};
use crate::{
    layout::Layout,
    output::state::Output,
    prepared::Prepared,
    request::{StructureOutcome, StructureRequest},
    run::{Begun, finished, go_on},
    territory::{plan::Territory, site::Site},
};

/// Sites that are nearer than this to one that is there are not laid again, in steps.
const COVERED: f64 = 0.7;
/// Sites that are there change with new ones within so many steps.
const JOINS: f64 = 1.3;
/// How far from new sites anything matters, in windows.
const MATTERS: f64 = 4.0;
/// Cosine of the largest angle between frames of a curve that is followed once more.
const ALIKE: f64 = 0.9;
/// How many strokes can be undone.
const UNDONE: usize = 100;

/// A structure that is painted stroke by stroke.
///
/// Each stroke lays sites where none are yet, grows points on them that go with what is there, and optimises what its sites see. All else
/// stays to the last bit. The same strokes give the same points.
///
/// ```
/// use std::sync::Arc;
/// use arabesque_core::{Budget, PointSet, Unobserved, Vector};
/// use arabesque_structures::{Brush, Prepared, Stroke, StructureParams};
///
/// let dots = (0..64).map(|k| Vector::xy(f64::from(k % 8), f64::from(k / 8))).collect();
/// let budget = Budget::default();
/// let prepared = Prepared::new(Arc::new(PointSet::at(dots)), &StructureParams::default(), &budget)?;
/// let mut brush = Brush::new(Arc::new(prepared), 1);
/// let stroke = Stroke::new(vec![Vector::xy(0.0, 0.0), Vector::xy(8.0, 3.0)], 2.0);
/// brush.stroke(&stroke, &budget, &mut Unobserved)?;
/// let first = brush.outcome(&budget)?.points;
/// brush.stroke(&Stroke::new(vec![Vector::xy(8.0, 3.0)], 4.0), &budget, &mut Unobserved)?;
/// assert!(brush.undo());
/// assert_eq!(brush.outcome(&budget)?.points, first);
/// # Ok::<(), arabesque_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Brush<const D: usize> {
    prepared: Arc<Prepared<D>>,
    canvas: Option<Arc<dyn Territory<D>>>,
    seed: u64,
    now: Arc<Canvas<D>>,
    before: Vec<Arc<Canvas<D>>>,
}

/// What was painted so far.
#[derive(Clone, Debug, Default)]
struct Canvas<const D: usize> {
    strokes: Painted<D>,
    sites: Vec<Site<D>>,
    matches: Vec<Vector<D>>,
    output: Output<D>,
}

/// What came of a stroke.
#[derive(Clone, Debug)]
pub struct StrokeOutcome {
    /// Number of sites that it laid; none where all of it was painted already.
    pub sites: usize,
    /// Number of points near it that were optimised or could have been, before and after.
    pub points: (usize, usize),
    /// `T` after each round, per site near the stroke.
    pub energy: Vec<EnergyPoint>,
    /// Why it ended; stopped early, it leaves the best so far.
    pub stopped: StopReason,
}

impl<const D: usize> Brush<D> {
    /// A brush with the structure of an exemplar, on nothing: structures that repeat along one direction follow the strokes, sheets lie in their own
    /// plane, and what repeats along all directions fills a tube.
    pub fn new(prepared: Arc<Prepared<D>>, seed: u64) -> Self {
        Self { prepared, canvas: None, seed, now: Arc::new(Canvas::default()), before: Vec::new() }
    }

    /// The same on a surface, in a volume or on a page.
    pub fn on(self, canvas: Arc<dyn Territory<D>>) -> Self {
        Self { canvas: Some(canvas), ..self }
    }

    /// Number of strokes.
    pub fn strokes(&self) -> usize {
        self.now.strokes.0.len()
    }

    /// Takes the last stroke back, and all that it changed. Whether there was one; of very many the first ones stay.
    pub fn undo(&mut self) -> bool {
        match self.before.pop() {
            Some(before) => {
                self.now = before;
                true
            }
            None => false,
        }
    }

    /// Paints one stroke. The watch is asked after each round; its previews show what is near the stroke.
    ///
    /// # Errors
    /// When the stroke is none, or when the budget is used up before there are points: then nothing has changed.
    pub fn stroke(
        &mut self,
        stroke: &Stroke<D>,
        budget: &Budget,
        watch: &mut dyn Watch<PointSet<D>>,
    ) -> Result<StrokeOutcome> {
        let repeats = self.prepared.repeats();
        stroke.check(repeats)?;
        let area = Arc::new(Area::new(stroke, repeats, self.canvas.as_ref())?);
        let own = Layout::new(&self.prepared, &*area, &budget.stage("laying a stroke"))?;
        let fresh = self.uncovered(&own);
        let laid = fresh.len();
        let mut next = (*self.now).clone();
        next.strokes.0.push(area);
        let mut outcome =
            StrokeOutcome { sites: laid, points: (0, 0), energy: Vec::new(), stopped: StopReason::Finished };
        if laid > 0 {
            let number = self.strokes() as u64;
            let request = StructureRequest {
                seed: self.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(number),
                budget: budget.clone(),
                ..StructureRequest::new(Arc::new(next.strokes.clone()))
            };
            self.paint(&mut next, (own, fresh), &request, watch, &mut outcome)?;
        }
        if self.before.len() == UNDONE {
            self.before.remove(0);
        }
        self.before.push(std::mem::replace(&mut self.now, Arc::new(next)));
        Ok(outcome)
    }

    /// All that was painted, cut at the borders of the strokes.
    ///
    /// # Errors
    /// When the budget is used up.
    pub fn outcome(&self, budget: &Budget) -> Result<StructureOutcome<D>> {
        let Canvas { strokes, sites, matches, output } = &*self.now;
        if output.places.is_empty() {
            return Ok(StructureOutcome {
                points: PointSet::default(),
                sources: Vec::new(),
                elements: Vec::new(),
                energy: Vec::new(),
                warnings: Vec::new(),
                stopped: StopReason::Finished,
            });
        }
        let plan = self.prepared.plan_for(self.prepared.window);
        let domain = self.domain(strokes.surroundings(), sites);
        let layout = Layout::over(plan, self.prepared.window, sites.clone(), domain, budget)?;
        let territory = Arc::new(strokes.clone());
        let request = StructureRequest { budget: budget.clone(), ..StructureRequest::new(territory) };
        finished(&self.prepared, &request, layout, (output.clone(), matches.clone()))
    }

    fn domain(&self, around: Domain<D>, sites: &[Site<D>]) -> Domain<D> {
        match &self.canvas {
            Some(_) => around,
            None => Domain::Box(around.bounds().union(&Bounds::around(sites.iter().map(|s| s.place)))),
        }
    }

    /// The sites of a stroke that are not there yet.
    fn uncovered(&self, own: &Layout<D>) -> Vec<Site<D>> {
        let there = &self.now.sites;
        if there.is_empty() {
            return own.sites.clone();
        }
        let places: Vec<_> = there.iter().map(|s| s.place).collect();
        let index = GridIndex::new(&places, own.plan.step, &own.domain);
        let follows = self.prepared.repeats() == 1;
        let alike = |a: &Site<D>, b: &Site<D>| {
            let product: f64 = (0..D * D).map(|k| a.rotation.0[k / D][k % D] * b.rotation.0[k / D][k % D]).sum();
            product > ALIKE * D as f64
        };
        let is_new = |site: &&Site<D>| {
            let mut covered = false;
            index.within(site.place, COVERED * own.plan.step * site.scale, |i, _| {
                covered |= !follows || alike(&there[i], site);
            });
            !covered
        };
        own.sites.iter().filter(is_new).copied().collect()
    }

    /// Grows and optimises around `fresh` sites.
    fn paint(
        &self,
        next: &mut Canvas<D>,
        (own, fresh): (Layout<D>, Vec<Site<D>>),
        request: &StructureRequest<D>,
        watch: &mut dyn Watch<PointSet<D>>,
        outcome: &mut StrokeOutcome,
    ) -> Result<()> {
        let pattern = &self.prepared.pattern;
        let (plan, window, was) = (own.plan, own.window, own.domain);
        let largest = fresh.iter().chain(&self.now.sites).map(|s| s.scale).fold(0.0, f64::max);
        let reach = (MATTERS * window + 2.0 * pattern.thickness) * largest;
        let domain = self.domain(was, &fresh);
        let places: Vec<_> = fresh.iter().map(|s| s.place).collect();
        let index = GridIndex::new(&places, reach, &domain);
        let is_near = |p: Vector<D>, radius: f64| {
            let mut near = false;
            index.within(p, radius, |_, _| near = true);
            near
        };
        request.budget.spend((self.now.sites.len() + self.now.output.places.len()) as u64 * 50)?;
        let old: Vec<usize> = (0..self.now.sites.len()).filter(|&q| is_near(self.now.sites[q].place, reach)).collect();
        let joins = JOINS * plan.step * largest;
        let within: Vec<bool> =
            old.iter().map(|&q| is_near(self.now.sites[q].place, joins)).chain(fresh.iter().map(|_| true)).collect();
        let mut sites: Vec<Site<D>> = old.iter().map(|&q| self.now.sites[q]).collect();
        sites.extend(&fresh);
        let (mut far, mut local) = (Output::default(), Output::default());
        for i in self.now.output.heads() {
            let to = if is_near(self.now.output.places[i], reach) { &mut local } else { &mut far };
            to.take(pattern, &self.now.output, i);
        }
        let matches = old.iter().map(|&q| self.now.matches[q]).collect();
        let domain = self.domain(domain, &sites);
        let layout = Layout::over(plan, window, sites, domain, &request.budget)?;
        outcome.points.0 = local.places.len();
        let begun = Begun { layout, output: local, matches, within: within.clone() };
        let ended = go_on(&self.prepared, request, begun, watch)?;
        outcome.points.1 = ended.output.places.len();
        (outcome.energy, outcome.stopped) = (ended.energy, ended.stopped);
        for (k, &q) in old.iter().enumerate().filter(|(k, _)| within[*k]) {
            next.matches[q] = ended.matches[k];
        }
        next.sites.extend(fresh);
        next.matches.extend_from_slice(&ended.matches[old.len()..]);
        ended.output.heads().for_each(|i| {
            far.take(pattern, &ended.output, i);
        });
        next.output = far;
        Ok(())
    }
}
