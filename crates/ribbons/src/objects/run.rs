//! Objects along all curves of a run.

use arabesque_core::{Budget, Error, Path, Progress, Result, Vector, Warning, rounded};

use crate::{
    geometry::cage::Cage,
    objects::{find::Objects, lay::Laying, place::Obstacle, way::Way},
    params::{RibbonParams, STEP},
    pieces::piece::{Piece, Ribbon},
};

/// Elements of a drawing that an object counts as, for the work that each adds.
const ELEMENTS: f64 = 25.0;

/// The ribbons so far, and how they ended.
#[derive(Debug)]
pub(crate) struct Laid<const D: usize> {
    pub(crate) ribbons: Vec<Ribbon<D>>,
    pub(crate) warnings: Vec<Warning>,
    /// Why not all curves have one.
    pub(crate) ended: Option<Ended>,
}

/// Why a run ended before it was done.
#[derive(Debug)]
pub(crate) enum Ended {
    /// Whoever watched it had enough.
    Watch,
    /// The budget is used up, or somebody asked to stop.
    Budget(Error),
}

/// What objects are laid along.
pub(crate) struct Course<'a, const D: usize> {
    pub(crate) objects: &'a Objects,
    pub(crate) params: &'a RibbonParams,
    pub(crate) curves: &'a [(String, Path<D>)],
    pub(crate) cages: &'a [Cage<D>],
    pub(crate) changes: &'a [f64],
    /// Column of the first exemplar at which the object begins that comes first.
    pub(crate) first: Option<usize>,
    pub(crate) seed: u64,
    pub(crate) budget: &'a Budget,
}

/// How a ribbon is cut for objects: finely, for their places are found between the cuts.
pub(crate) fn fine(params: &RibbonParams, height: f64) -> RibbonParams {
    let most = STEP * height * params.scale;
    RibbonParams { step: Some(params.step.map_or(most, |step| step.min(most))), ..params.clone() }
}

impl<const D: usize> Course<'_, D> {
    /// Lays objects along all curves. `watch` is told after each, and answers whether to go on.
    ///
    /// # Errors
    /// [`Error::NoResult`] when no object fits anywhere, [`Error::Limit`] and [`Error::Stopped`] before there is one.
    pub(crate) fn lay(
        &self,
        blocked: Option<&dyn Fn(Vector<D>) -> bool>,
        watch: &mut dyn FnMut(Progress, &[Ribbon<D>]) -> bool,
    ) -> Result<Laid<D>> {
        let mut laying = Laying {
            objects: self.objects,
            params: self.params,
            seed: self.seed,
            changes: self.changes,
            first: self.first.and_then(|column| self.beginning(column)),
            blocked,
            budget: self.budget,
            others: Vec::new(),
        };
        let mut laid = Laid { ribbons: Vec::new(), warnings: Vec::new(), ended: None };
        let mut pieces = 0;
        for (k, cage) in self.cages.iter().enumerate() {
            let way = Way::new(cage);
            let shortest = self.objects.list.iter().map(|o| o.length()).fold(f64::INFINITY, f64::min);
            self.budget.allow_elements(ELEMENTS * (way.length() / (shortest * self.params.scale)).ceil());
            let placed = match laying.along(&way, k) {
                Ok(placed) => placed,
                Err(error) if pieces == 0 => return Err(error),
                Err(error) => {
                    laid.ended = Some(Ended::Budget(error));
                    break;
                }
            };
            let placed = placed.unwrap_or_else(|obstacle| {
                laid.warnings.push(self.empty(k, way.length(), obstacle));
                Vec::new()
            });
            let own: Vec<Piece<D>> = placed.into_iter().flat_map(|object| object.pieces).collect();
            pieces += own.len();
            laid.ribbons.push(Ribbon { pieces: own, closed: cage.closed, cost: 0.0 });
            let progress = Progress {
                stage: "laying objects".into(),
                done: k + 1,
                total: self.cages.len(),
                fraction: (k + 1) as f64 / self.cages.len() as f64,
                energy: None,
                count: pieces,
            };
            if !watch(progress, &laid.ribbons) && k + 1 < self.cages.len() {
                laid.ended = Some(Ended::Watch);
                break;
            }
        }
        match laid.warnings.first() {
            Some(warning) if pieces == 0 => Err(Error::no_result(warning.message.clone(), warning.advice.clone())),
            _ => Ok(laid),
        }
    }

    /// The first object that begins at `column` or after it.
    fn beginning(&self, column: usize) -> Option<usize> {
        let ends = |k: &usize| self.objects.list[*k].source == 0 && self.objects.list[*k].right > column as f64;
        (0..self.objects.list.len()).find(ends)
    }

    /// Why a curve has no object.
    fn empty(&self, curve: usize, length: f64, obstacle: Obstacle) -> Warning {
        let name = &self.curves[curve].0;
        let shortest = self.objects.list.iter().map(|o| o.length()).fold(f64::INFINITY, f64::min) * self.params.scale;
        let (shortest, length) = (rounded(shortest), rounded(length));
        let (why, advice) = match obstacle {
            Obstacle::End => (
                format!(
                    "its stretches between corners are too short, the curve being {length} long in all and the \
                     shortest object {shortest}"
                ),
                "draw a longer curve, or use a smaller --scale",
            ),
            Obstacle::Width => {
                ("the ribbon is narrower than the objects".to_owned(), "use a larger --width or a smaller --scale")
            }
            Obstacle::Bend => {
                ("it is bent more tightly than the objects can be".to_owned(), "bend it less, or use a smaller --scale")
            }
            Obstacle::Taken => (
                "wherever one might lie is a place to avoid or another object".to_owned(),
                "avoid less, move the curves apart, or use a smaller --scale",
            ),
        };
        Warning::new(format!("{name} stays empty, for no object of the exemplar fits along it: {why}"), advice)
    }
}
