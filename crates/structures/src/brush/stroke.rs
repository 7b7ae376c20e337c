//! One stroke: where its sites are and how far it reaches.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Domain, Error, Matrix, Result, Vector};

use crate::territory::{
    plan::{SitePlan, Territory},
    site::Site,
    tube::{Along, Thread, Tube},
};

/// Smallest and largest scale.
const SCALES: [f64; 2] = [0.01, 100.0];

/// One stroke of a brush.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke<const D: usize> {
    /// Where the brush goes: a polyline. A single point is a dab, but for structures that repeat along one direction, which follow the line.
    pub path: Vec<Vector<D>>,
    /// How far from the path the structure goes where it repeats along more than one direction.
    pub radius: f64,
    /// Size of the structure; 2 is twice as large as in the exemplar. Default 1.
    pub scale: f64,
    /// Where the first direction of the structure leads, as far as it lies along the base; `None` leaves it as in the exemplar, or as the surface
    /// that is painted on has it. A structure that repeats along one direction runs along the path.
    pub direction: Option<Vector<D>>,
}

impl<const D: usize> Stroke<D> {
    /// A stroke of this radius in the size of the exemplar.
    pub fn new(path: Vec<Vector<D>>, radius: f64) -> Self {
        Self { path, radius, scale: 1.0, direction: None }
    }

    /// Refuses what is no stroke for structures that repeat along so many directions.
    pub(super) fn check(&self, repeats: usize) -> Result<()> {
        if self.path.is_empty() || self.path.iter().any(|p| !p.is_finite()) {
            let problem = if self.path.is_empty() { "no point" } else { "a point that is not finite" };
            return Err(Error::input("the stroke", problem, "give at least one point with finite coordinates"));
        }
        if !(SCALES[0]..=SCALES[1]).contains(&self.scale) {
            return Err(Error::parameter("scale", self.scale, format!("a number from {} to {}", SCALES[0], SCALES[1])));
        }
        if repeats > 1 && !(self.radius > 0.0 && self.radius.is_finite()) {
            return Err(Error::parameter("radius", self.radius, "a positive number"));
        }
        match self.direction {
            Some(way) if !(way.norm() > 0.0 && way.is_finite()) => {
                Err(Error::parameter("direction", format!("{:?}", way.0), "a direction with a length"))
            }
            Some(_) if repeats == 1 => Err(Error::Unsupported {
                what: "direction for a structure that runs along the stroke".into(),
                advice: "leave it out".into(),
            }),
            _ => Ok(()),
        }
    }

    /// Squared distance to the path along the coordinates of `base`.
    fn distance2(&self, p: Vector<D>, base: [bool; D]) -> f64 {
        let flat = |v: Vector<D>| -> Vector<D> { Vector(std::array::from_fn(|k| if base[k] { v[k] } else { 0.0 })) };
        let p = flat(p);
        let dabs = self.path.iter().map(|&c| (flat(c) - p).norm2());
        let lines = self.path.windows(2).map(|w| {
            let (a, d) = (flat(w[0]), flat(w[1]) - flat(w[0]));
            let t = ((p - a).dot(d) / d.norm2().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            (p - (a + d * t)).norm2()
        });
        dabs.chain(lines).fold(f64::INFINITY, f64::min)
    }
}

/// The area of a stroke, on a surface or other place where there is one.
#[derive(Clone, Debug)]
pub(super) struct Area<const D: usize> {
    stroke: Stroke<D>,
    /// The curve that a structure follows which repeats along one direction.
    tube: Option<Tube<D>>,
    canvas: Option<Arc<dyn Territory<D>>>,
}

impl<const D: usize> Area<D> {
    pub(super) fn new(stroke: &Stroke<D>, repeats: usize, canvas: Option<&Arc<dyn Territory<D>>>) -> Result<Self> {
        let tube = if repeats == 1 {
            let thread = Thread { scale: Along::constant(stroke.scale), ..Thread::new(stroke.path.clone()) };
            Some(Tube::new(vec![thread], 0.0)?)
        } else {
            None
        };
        Ok(Self { stroke: stroke.clone(), tube, canvas: canvas.cloned() })
    }

    /// The base whose coordinates count for distances: all of them on a canvas, which may bend.
    fn flat(&self, plan: &SitePlan<D>) -> [bool; D] {
        if self.canvas.is_some() { [true; D] } else { plan.base }
    }

    /// Sites on a grid that is the same for all strokes of a scale.
    fn on_grid(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>> {
        let step = plan.step * self.stroke.scale;
        let reach = self.stroke.radius + plan.margin * self.stroke.scale;
        let bounds = Bounds::around(self.stroke.path.iter().copied()).grown(reach);
        let low: [f64; D] = bounds.min.0.map(|c| (c / step).ceil());
        let count: [f64; D] = std::array::from_fn(|k| {
            if plan.base[k] { ((bounds.max[k] / step).floor() - low[k] + 1.0).max(0.0) } else { 1.0 }
        });
        let all = count.iter().product::<f64>();
        budget.within_expected("quadrature points", all, ("output-elements", budget.limits().output_elements))?;
        budget.spend((all as u64).saturating_mul(20 + 10 * self.stroke.path.len() as u64))?;
        let rotation = turned(Matrix::identity(), plan.base, self.stroke.direction);
        let mut sites = Vec::new();
        for n in 0..all as usize {
            let mut rest = n;
            let place = Vector(std::array::from_fn(|k| {
                let c = rest % count[k] as usize;
                rest /= count[k] as usize;
                if plan.base[k] { (low[k] + c as f64) * step } else { plan.axis[k] }
            }));
            if self.stroke.distance2(place, plan.base) <= reach * reach {
                sites.push(Site { place, rotation, scale: self.stroke.scale, weight: 1.0 });
            }
        }
        Ok(sites)
    }
}

impl<const D: usize> Territory<D> for Area<D> {
    fn sites(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>> {
        if let Some(tube) = &self.tube {
            return tube.sites(plan, budget);
        }
        let Some(canvas) = &self.canvas else { return self.on_grid(plan, budget) };
        let scale = self.stroke.scale;
        let finer = SitePlan { step: plan.step * scale, margin: plan.margin * scale, ..*plan };
        let mut sites = canvas.sites(&finer, budget)?;
        let reach = self.stroke.radius + finer.margin;
        budget.spend((sites.len() as u64).saturating_mul(10 * self.stroke.path.len() as u64))?;
        sites.retain(|s| self.stroke.distance2(s.place, [true; D]) <= reach * reach);
        for site in &mut sites {
            site.scale *= scale;
            site.rotation = turned(site.rotation, plan.base, self.stroke.direction);
        }
        Ok(sites)
    }

    fn contains(&self, p: Vector<D>, plan: &SitePlan<D>) -> bool {
        match (&self.tube, &self.canvas) {
            (Some(tube), _) => tube.contains(p, plan),
            (None, canvas) => {
                self.stroke.distance2(p, self.flat(plan)) <= self.stroke.radius * self.stroke.radius
                    && canvas.as_ref().is_none_or(|c| c.contains(p, plan))
            }
        }
    }

    fn surroundings(&self) -> Domain<D> {
        let around = || Domain::Box(Bounds::around(self.stroke.path.iter().copied()).grown(self.stroke.radius));
        self.canvas.as_ref().map_or_else(around, |canvas| canvas.surroundings())
    }

    fn measure(&self, repeats: usize) -> f64 {
        match &self.tube {
            Some(tube) => tube.measure(repeats),
            None => {
                Bounds::around(self.stroke.path.iter().copied()).grown(self.stroke.radius).size().0.iter().product()
            }
        }
    }
}

/// All areas together.
#[derive(Clone, Debug, Default)]
pub(super) struct Painted<const D: usize>(pub(super) Vec<Arc<Area<D>>>);

impl<const D: usize> Territory<D> for Painted<D> {
    fn sites(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>> {
        let mut sites = Vec::new();
        for area in &self.0 {
            sites.extend(area.sites(plan, budget)?);
        }
        Ok(sites)
    }

    fn contains(&self, p: Vector<D>, plan: &SitePlan<D>) -> bool {
        self.0.iter().any(|area| area.contains(p, plan))
    }

    fn surroundings(&self) -> Domain<D> {
        match self.0.first() {
            Some(first) if first.canvas.is_some() => first.surroundings(),
            _ => Domain::Box(self.0.iter().fold(Bounds::EMPTY, |all, area| all.union(&area.surroundings().bounds()))),
        }
    }

    fn measure(&self, repeats: usize) -> f64 {
        self.0.iter().map(|area| area.measure(repeats)).sum()
    }
}

/// A frame turned so that its first direction along the base leads along `direction`, as far as that lies along the base.
fn turned<const D: usize>(frame: Matrix<D>, base: [bool; D], direction: Option<Vector<D>>) -> Matrix<D> {
    let Some(way) = direction else { return frame };
    let column = |c: usize| Vector::<D>(std::array::from_fn(|r| frame.0[r][c]));
    // In cyclic order, so that right-handed stays right-handed.
    let across = (0..D).find(|&k| !base[k]);
    let first = if D == 2 { 0 } else { across.map_or(0, |a| (a + 1) % D) };
    let along = across.filter(|_| D == 3).map_or(way, |a| way - column(a) * way.dot(column(a)));
    let Some(target) = along.unit_if_longer(1e-9 * way.norm()) else { return frame };
    between(column(first), target).compose(&frame)
}

/// The smallest rotation that turns one direction into another, both of length 1.
fn between<const D: usize>(from: Vector<D>, to: Vector<D>) -> Matrix<D> {
    let cosine = from.dot(to);
    let mut turn = Matrix::identity();
    if cosine < -1.0 + 1e-9 {
        // Half a turn, in the plane of the direction and what is least along it.
        let least = (0..D).min_by(|&a, &b| from[a].abs().total_cmp(&from[b].abs())).unwrap_or(0);
        let mut side = Vector::<D>::ZERO;
        side[least] = 1.0;
        let side = (side - from * from[least]).unit_or_zero();
        for r in 0..D {
            for c in 0..D {
                turn.0[r][c] -= 2.0 * (from[r] * from[c] + side[r] * side[c]);
            }
        }
        return turn;
    }
    // Rodrigues' formula, by outer products alone.
    for r in 0..D {
        for c in 0..D {
            let skew = to[r] * from[c] - from[r] * to[c];
            let square: f64 =
                (0..D).map(|k| (to[r] * from[k] - from[r] * to[k]) * (to[k] * from[c] - from[k] * to[c])).sum();
            turn.0[r][c] += skew + square / (1.0 + cosine);
        }
    }
    turn
}
