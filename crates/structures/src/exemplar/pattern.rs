//! The exemplar as it is prepared once.

use std::sync::Arc;

use arabesque_core::{Bounds, Budget, Domain, Error, GridIndex, Meter, PointSet, Result, Vector, Warning};

use super::{
    bodies::{Body, Gaps, LOOSE, bodies},
    channels::{Channels, LANES, Weights},
    spacing::{base, spacing},
};
use crate::params::StructureParams;

/// Fewest points that show anything that repeats.
const FEWEST: usize = 10;
/// Distances from point to point that vary by this share of themselves are those of points at random.
const RANDOM: f64 = 0.2;
/// Where Gaussians end, in their widths.
const WIDE: f64 = 3.1;
/// Extents below this share of the largest one count as flat.
const FLAT: f64 = 1e-6;

/// What is known of the exemplar whatever the level.
#[derive(Clone, Debug)]
pub(crate) struct Pattern<const D: usize> {
    /// The exemplar itself.
    pub(crate) points: Arc<PointSet<D>>,
    /// What each channel of the weights holds.
    pub(crate) channels: Channels,
    /// The weights of each point.
    pub(crate) weights: Vec<Weights>,
    /// Smallest and largest weight in each channel.
    pub(crate) ranges: [(f32, f32); LANES],
    /// Mean distance of a point from the nearest.
    pub(crate) spacing: f64,
    /// By what share of itself that distance varies.
    pub(crate) variation: f64,
    /// The coordinates along which the exemplar repeats.
    pub(crate) base: [bool; D],
    /// The box of what repeats; across it, that of all points.
    pub(crate) bounds: Bounds<D>,
    /// The place of the base across itself: the axis of a rope, the plane under a surface; zero along it.
    pub(crate) axis: Vector<D>,
    /// How far points are from the base.
    pub(crate) thickness: f64,
    /// Rigid elements.
    pub(crate) bodies: Vec<Body<D>>,
    /// For each point its rigid element.
    pub(crate) body_of: Vec<u32>,
    /// How near rigid elements come to one another.
    pub(crate) gaps: Gaps,
    /// All points by place.
    pub(crate) index: GridIndex<D>,
}

impl<const D: usize> Pattern<D> {
    /// Checks and analyses an exemplar.
    pub(crate) fn new(
        points: Arc<PointSet<D>>,
        params: &StructureParams,
        budget: &Budget,
        warnings: &mut Vec<Warning>,
    ) -> Result<Self> {
        check(&points, budget)?;
        let all = points.bounds();
        budget.spend(points.len() as u64 * 2_000)?;
        let (spacing, variation) = spacing(&points.positions).ok_or_else(|| {
            Error::input("the exemplar", "all points lie in one place", "give an exemplar in which points lie apart")
        })?;
        let (bodies, body_of) = bodies(&points);
        let loose: Vec<Vector<D>> =
            (0..points.len()).filter(|&i| body_of[i] as usize >= bodies.len()).map(|i| points.positions[i]).collect();
        // Whole elements may stick out of the box that their middles fill.
        let inner = if loose.len() * 5 > points.len() {
            Bounds::around(loose)
        } else {
            Bounds::around(bodies.iter().map(|b| b.centre))
        };
        let base = base(&all, params.repeats);
        let bounds = Bounds::new(
            Vector(std::array::from_fn(|k| if base[k] { inner.min[k] } else { all.min[k] })),
            Vector(std::array::from_fn(|k| if base[k] { inner.max[k] } else { all.max[k] })),
        );
        let single = bodies.iter().filter(|b| b.members.len() == 1).count();
        if single > 0 {
            warnings.push(Warning::new(
                format!("rigid elements of one point: {single}; nothing tells how they are turned"),
                "leave the attribute element out, or give each element three points or more",
            ));
        }
        flatness(&all, base, warnings);
        let axis = Vector(std::array::from_fn(|k| {
            let holds_zero = all.min[k] <= spacing && all.max[k] >= -spacing;
            if base[k] || holds_zero { 0.0 } else { 0.5 * (all.min[k] + all.max[k]) }
        }));
        let across = |p: &Vector<D>| (0..D).filter(|&k| !base[k]).map(|k| (p[k] - axis[k]).powi(2)).sum::<f64>().sqrt();
        let thickness = points.positions.iter().map(across).fold(0.0, f64::max);
        let channels = Channels::new(&points, params);
        let weights: Vec<Weights> = (0..points.len()).map(|i| channels.of(&points, i)).collect();
        let range = |c: usize| weights.iter().fold((f32::MAX, f32::MIN), |(a, b), w| (w[c].min(a), w[c].max(b)));
        let ranges = std::array::from_fn(range);
        let index = GridIndex::new(&points.positions, 2.0 * spacing, &Domain::Box(all));
        let gaps = Gaps::new((&points.positions, &index), (&bodies, &body_of), spacing, all.size().norm());
        Ok(Self {
            channels,
            weights,
            ranges,
            spacing,
            variation,
            base,
            bounds,
            axis,
            thickness,
            bodies,
            body_of,
            gaps,
            index,
            points,
        })
    }

    /// How alike the normals of loose points are that lie under one Gaussian of width `sigma`: 1 where they face the same way, and without normals.
    pub(crate) fn alike(&self, sigma: f64, meter: &mut Meter) -> Result<f64> {
        let Some(normals) = &self.points.normals else { return Ok(1.0) };
        let (mut same, mut all) = (0.0, 1e-12);
        for i in (0..self.points.len()).filter(|&i| self.body_of[i] == LOOSE) {
            let looked = self.index.within(self.points.positions[i], WIDE * sigma, |j, r| {
                let h = (-0.5 * r.norm2() / (sigma * sigma)).exp();
                same += h * normals[i].dot(normals[j]);
                all += h;
            });
            meter.spend(20 + 12 * looked)?;
        }
        Ok(if all > 1e-9 { same / all } else { 1.0 })
    }

    /// Number of directions along which the exemplar repeats.
    pub(crate) fn repeats(&self) -> usize {
        self.base.iter().filter(|b| **b).count()
    }

    /// Side lengths of the box of what repeats, along the base.
    pub(crate) fn sides(&self) -> impl Iterator<Item = f64> {
        let size = self.bounds.size();
        (0..D).filter(|&k| self.base[k]).map(move |k| size[k])
    }

    /// Length, area or volume of what repeats.
    pub(crate) fn measure(&self) -> f64 {
        // The outermost points of a lattice are half a spacing from its border; those at random are next to it.
        let even = (1.0 - self.variation / RANDOM).max(0.0);
        let n = self.bodies.len() as f64;
        let rigid = self.body_of.iter().all(|b| *b != LOOSE) && n > 1.0;
        self.sides().map(|s| if rigid { s * n / (n - 1.0) } else { s + even * self.spacing }).product()
    }
}

fn check<const D: usize>(points: &PointSet<D>, budget: &Budget) -> Result<()> {
    points.check("the exemplar")?;
    budget.within("points of the exemplar", points.len(), ("elements", budget.limits().elements))?;
    if points.len() < FEWEST {
        return Err(Error::input(
            "the exemplar",
            format!("{} points", points.len()),
            format!("give at least {FEWEST}, so that something can repeat"),
        ));
    }
    match points.positions.iter().position(|p| !p.is_finite()) {
        Some(i) => Err(Error::input(
            "the exemplar",
            format!("a coordinate of point {} is not a finite number", i + 1),
            "leave the point out",
        )),
        None => Ok(()),
    }
}

/// Tells what it means when all points lie in a plane or on a line.
fn flatness<const D: usize>(all: &Bounds<D>, base: [bool; D], warnings: &mut Vec<Warning>) {
    let size = all.size();
    let largest = size.0.iter().copied().fold(0.0, f64::max);
    let flat = size.0.iter().filter(|&&s| s < FLAT * largest).count();
    if D == 3 && flat > 0 && base.iter().filter(|b| **b).count() <= 2 {
        let what = if flat == 1 { "in one plane" } else { "on one line" };
        warnings.push(Warning::new(
            format!("all points of the exemplar lie {what}"),
            "the result is as flat along its domain; give an exemplar with depth for more",
        ));
    }
}
