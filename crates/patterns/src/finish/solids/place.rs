//! Random places in a domain.

use arabesque_core::{Bounds, Budget, Domain, Lattice, Result, Stage, Stream, Vector};
use rayon::prelude::*;

const PLACES: Stage = Stage::new(439);

/// A domain fills this share of the box around it at least, else places are drawn in those cells of the box alone that it reaches into; cells
/// along a side of the box.
const FULL: f64 = 0.15;
const CELLS: usize = 40;
/// Most places that are drawn for one then.
const DRAWS: usize = 60;
/// Work of a question how deep a place lies.
const PER_QUESTION: u64 = 600;
/// Places that tell how deep a domain is.
const TRIED: u64 = 200;
/// A domain that is less deep than this many radii of the thinnest body is a layer: what is empty in it reaches out of it.
const DEEP: f64 = 1.6;
/// Share of the depth of a layer in which places are in the middle of it.
const MIDDLE: f64 = 0.5;

/// A domain in which places are drawn.
pub(super) struct Place<'a, const D: usize> {
    domain: &'a Domain<D>,
    /// Cells of the box around the domain that it reaches into, where it fills little of that.
    cells: Option<(Lattice<D>, Vec<u32>)>,
    /// How deep the domain is, where it is a layer.
    layer: Option<f64>,
}

impl<'a, const D: usize> Place<'a, D> {
    /// `thinnest`: radius of the largest ball in the thinnest body.
    ///
    /// # Errors
    /// When the budget is used up, or a stop is asked for.
    pub(super) fn new(domain: &'a Domain<D>, thinnest: f64, seed: u64, budget: &Budget) -> Result<Self> {
        let is_sparse = domain.measure() < FULL * domain.bounds().size().0.into_iter().product::<f64>();
        let mut place = Self { domain, cells: None, layer: None };
        if is_sparse {
            place.cells = Some(cells(domain, budget)?);
        }
        budget.spend(TRIED * PER_QUESTION)?;
        let depths = (0..TRIED).filter_map(|n| place.draw(&mut Stream::new(seed, PLACES, n)));
        let deepest = depths.map(|(_, depth)| depth).fold(0.0, f64::max);
        place.layer = (deepest > 0.0 && deepest < DEEP * thinnest).then_some(deepest);
        Ok(place)
    }

    /// A random place in the domain, with how deep it lies in it; nothing where none was found.
    pub(super) fn draw(&self, random: &mut Stream) -> Option<(Vector<D>, f64)> {
        let within = |random: &mut Stream, bounds: Bounds<D>| {
            let p = Vector(std::array::from_fn(|k| random.range(bounds.min[k], bounds.max[k])));
            let depth = self.domain.signed_distance(p);
            (depth > 0.0).then_some((p, depth))
        };
        let Some((lattice, cells)) = &self.cells else { return within(random, self.domain.bounds()) };
        let half = lattice.cell() * 0.5;
        (0..if cells.is_empty() { 0 } else { DRAWS }).find_map(|_| {
            let centre = lattice.centre(cells[random.below(cells.len())] as usize);
            within(random, Bounds { min: centre - half, max: centre + half })
        })
    }

    /// Whether an empty ball at a place `depth` deep in the domain counts: one that lies in it, in a layer one that is in the middle
    /// of it and lies within its sides.
    pub(super) fn holds(&self, p: Vector<D>, depth: f64, radius: f64) -> bool {
        let Some(deep) = self.layer else { return depth >= radius };
        let Domain::Box(bounds) = self.domain else { return depth >= MIDDLE * deep };
        let is_within = |k: usize| {
            let depth = (p[k] - bounds.min[k]).min(bounds.max[k] - p[k]);
            let is_across = bounds.max[k] - bounds.min[k] < 2.5 * deep;
            depth >= if is_across { MIDDLE * deep } else { radius }
        };
        (0..D).all(is_within)
    }
}

/// The cells of the box around a domain that it reaches into.
fn cells<const D: usize>(domain: &Domain<D>, budget: &Budget) -> Result<(Lattice<D>, Vec<u32>)> {
    let lattice = Lattice::at_most(domain.bounds(), [CELLS; D], false, CELLS.pow(D as u32));
    let reach = 0.5 * lattice.cell().norm();
    let reached = |c: u32| {
        budget.spend(PER_QUESTION)?;
        Ok((domain.signed_distance(lattice.centre(c as usize)) > -reach).then_some(c))
    };
    let all: Result<Vec<Option<u32>>> = (0..lattice.count() as u32).into_par_iter().map(reached).collect();
    Ok((lattice, all?.into_iter().flatten().collect()))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arabesque_core::Region;

    use super::*;

    /// A thin layer across the middle of a cube.
    #[derive(Debug)]
    struct Sheet;

    impl Region<3> for Sheet {
        fn bounds(&self) -> Bounds<3> {
            Bounds::new(Vector::splat(-10.0), Vector::splat(10.0))
        }

        fn measure(&self) -> f64 {
            80.0
        }

        fn signed_distance(&self, p: Vector<3>) -> f64 {
            0.1 - p[1].abs()
        }

        fn nearest_boundary(&self, p: Vector<3>) -> Vector<3> {
            Vector([p[0], 0.1_f64.copysign(p[1]), p[2]])
        }
    }

    #[test]
    fn places_are_found_in_thin_layers_and_empty_balls_reach_out_of_them() {
        let domain = Domain::Region(Arc::new(Sheet));
        let place = Place::new(&domain, 0.1, 3, &Budget::default()).unwrap();
        let drawn = (0..100).filter_map(|n| place.draw(&mut Stream::new(1, Stage::TEST, n)));
        let depths: Vec<f64> = drawn.map(|(_, depth)| depth).collect();
        assert!(depths.len() > 95 && depths.iter().all(|depth| (0.0..=0.1).contains(depth)), "{}", depths.len());
        let at = |y: f64| place.holds(Vector([0.0, y, 0.0]), 0.1 - y, 2.0);
        assert!(at(0.02) && !at(0.08));
        // Nothing of what is as small as a pebble in it is in a layer.
        assert!(!Place::new(&domain, 0.01, 3, &Budget::default()).unwrap().holds(Vector::ZERO, 0.1, 2.0));
    }

    #[test]
    fn empty_balls_in_a_flat_box_lie_within_its_sides() {
        let domain = Domain::Box(Bounds::new(Vector::ZERO, Vector([8.0, 0.2, 8.0])));
        let place = Place::new(&domain, 0.1, 3, &Budget::default()).unwrap();
        assert!(place.holds(Vector([4.0, 0.1, 4.0]), 0.1, 2.0) && !place.holds(Vector([1.0, 0.1, 4.0]), 0.1, 2.0));
        let deep = Domain::Box(Bounds::new(Vector::ZERO, Vector::splat(8.0)));
        assert!(!Place::new(&deep, 0.1, 3, &Budget::default()).unwrap().holds(Vector([4.0, 0.1, 4.0]), 0.1, 2.0));
    }
}
