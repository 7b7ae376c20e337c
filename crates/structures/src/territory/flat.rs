//! Boxes, tiles and shapes: the base is flat, and the pattern is turned and scaled by fields.

use arabesque_core::{Bounds, Budget, Domain, Error, Fields, Lattice, Matrix, Result, Vector};

use super::{
    plan::{SitePlan, Territory},
    site::Site,
};

/// A box, a torus or a region. A pattern that repeats along fewer directions than there are lies along the longest sides of the box,
/// in the plane or on the line on which its own base is.
#[derive(Clone, Debug)]
pub struct Flat<const D: usize> {
    domain: Domain<D>,
    fields: Fields<D>,
}

impl<const D: usize> Flat<D> {
    /// The domain with the pattern turned and scaled by `fields`; their density is not used.
    pub fn new(domain: Domain<D>, fields: Fields<D>) -> Self {
        Self { domain, fields }
    }

    fn base_bounds(&self, plan: &SitePlan<D>, margin: f64) -> Bounds<D> {
        let (bounds, wraps) = (self.domain.bounds(), self.domain.period().is_some());
        let margin = if wraps { 0.0 } else { margin };
        let side = |k: usize, side: f64, out: f64| if plan.base[k] { side + out } else { plan.axis[k] };
        Bounds::new(
            Vector(std::array::from_fn(|k| side(k, bounds.min[k], -margin))),
            Vector(std::array::from_fn(|k| side(k, bounds.max[k], margin))),
        )
    }
}

impl<const D: usize> Territory<D> for Flat<D> {
    fn sites(&self, plan: &SitePlan<D>, budget: &Budget) -> Result<Vec<Site<D>>> {
        let (smallest, largest) = self.fields.scale.range();
        if !(smallest > 0.0 && largest.is_finite()) {
            return Err(Error::parameter("scale", smallest, "a positive number everywhere"));
        }
        let bounds = self.base_bounds(plan, plan.margin * largest);
        let size = bounds.size();
        let steps = |k: usize| (size[k] / (plan.step * smallest)).round().max(1.0);
        let count: f64 = (0..D).filter(|&k| plan.base[k]).map(steps).product();
        budget.within_expected("quadrature points", count, ("output-elements", budget.limits().output_elements))?;
        let counts = std::array::from_fn(|k| if plan.base[k] { steps(k) as usize } else { 1 });
        let lattice = Lattice::new(bounds, counts, false);
        let mut sites = Vec::new();
        let cell: f64 = (0..D).filter(|&k| plan.base[k]).map(|k| size[k] / counts[k] as f64).product();
        let repeats = plan.base.iter().filter(|b| **b).count() as i32;
        let mut meter = budget.meter();
        for index in 0..lattice.count() {
            meter.spend(100)?;
            let centre = lattice.centre(index);
            let place = Vector(std::array::from_fn(|k| if plan.base[k] { centre[k] } else { plan.axis[k] }));
            let scale = self.fields.scale.at(place);
            if !matches!(self.domain, Domain::Region(_)) || self.domain.signed_distance(place) >= -plan.margin * scale {
                let rotation = self.fields.orientation.as_ref().map_or_else(Matrix::identity, |o| o.at(place));
                sites.push(Site { place, rotation, scale, weight: cell / (plan.step * scale).powi(repeats) });
            }
        }
        Ok(sites)
    }

    fn contains(&self, p: Vector<D>, plan: &SitePlan<D>) -> bool {
        match &self.domain {
            Domain::Torus(_) => true,
            Domain::Region(region) => region.signed_distance(p) >= 0.0,
            Domain::Box(b) => (0..D).all(|k| !plan.base[k] || p[k] >= b.min[k] && p[k] <= b.max[k]),
        }
    }

    fn surroundings(&self) -> Domain<D> {
        self.domain.clone()
    }

    fn measure(&self, repeats: usize) -> f64 {
        let mut sides = self.domain.bounds().size().0;
        if repeats == D {
            return self.domain.measure();
        }
        sides.sort_by(|a, b| b.total_cmp(a));
        sides[..repeats.min(D)].iter().product()
    }
}
