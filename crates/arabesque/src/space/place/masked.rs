//! A place of which parts stay empty.

use arabesque_core::{Bounds, Budget, Domain, Error, Region, Result, Vector};

use super::inside::Inside;

/// Cells along the longest side of the grid on which the volume is measured, and work for each.
const CELLS: f64 = 48.0;
const CELL: u64 = 2000;

/// What lies in a domain and in none of some solids.
#[derive(Debug)]
pub(super) struct Masked {
    domain: Domain<3>,
    masks: Vec<Inside>,
    measure: f64,
}

impl Masked {
    pub(super) fn new(domain: Domain<3>, masks: Vec<Inside>, budget: &Budget) -> Result<Self> {
        let (bounds, measure) = (domain.bounds(), domain.measure());
        let mut masked = Self { domain, masks, measure };
        let size = bounds.size();
        let cell = size.0.into_iter().fold(0.0, f64::max) / CELLS;
        let counts = size.0.map(|side| (side / cell).ceil().max(1.0) as usize);
        let (mut all, mut free) = (0.0, 0.0);
        for n in 0..counts.iter().product() {
            budget.spend(CELL)?;
            let p = bounds.cell_centre(n, &counts);
            if masked.domain.contains(p) {
                all += 1.0;
                free += f64::from(u8::from(masked.signed_distance(p) >= 0.0));
            }
        }
        if free == 0.0 {
            let advice = "avoid less, or fill a larger place";
            return Err(Error::no_result("what is avoided leaves no room", advice));
        }
        masked.measure = measure * free / all;
        Ok(masked)
    }
}

impl Region<3> for Masked {
    fn bounds(&self) -> Bounds<3> {
        self.domain.bounds()
    }

    fn measure(&self) -> f64 {
        self.measure
    }

    fn signed_distance(&self, p: Vector<3>) -> f64 {
        let inside = self.domain.signed_distance(p);
        self.masks.iter().map(|mask| -mask.signed_distance(p)).fold(inside, f64::min)
    }

    fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
        // Out of what is avoided first, then into the domain: near where both meet this is near enough.
        let deepest = self.masks.iter().map(|mask| (mask.signed_distance(p), mask)).max_by(|a, b| a.0.total_cmp(&b.0));
        match deepest {
            Some((depth, mask))
                if depth > 0.0 || !matches!(self.domain, Domain::Region(_)) && self.domain.contains(p) =>
            {
                mask.nearest_boundary(p)
            }
            _ => self.domain.nearest_inside(p),
        }
    }
}
