//! The elements of one class by place: a raster whose cells know beforehand whom a look-up from within them could find.
//!
//! Patches of the layout ask for the element nearest to a place, for each element around, millions of times a run. One cell, and the
//! short list in it, answers.

use arabesque_core::{Bounds, Lattice, Meter, Result, Vector};

/// Cells to the reach of a look-up, in the plane and in space.
const CELLS: (f64, f64) = (2.0, 1.0);

/// Most cells: so many for each element, and a few more.
const MOST: (usize, usize) = (32, 256);

/// Nanoseconds for an element and a cell that is looked at.
const WORK: u64 = 6;

/// By how much the lists reach farther than look-ups, for what rounding may do: relative to the reach, and to coordinates.
const SLACK: (f64, f64) = (1e-6, 1e-14);

/// An element where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<const D: usize> {
    pub(crate) place: Vector<D>,
    pub(crate) element: u32,
}

/// Elements within some reach of the cells of a raster.
#[derive(Clone, Debug)]
pub(crate) struct Places<const D: usize> {
    lattice: Lattice<D>,
    /// Elements that may be within reach of cell `c`: `near[starts[c]..starts[c + 1]]`, ascending.
    starts: Vec<u32>,
    near: Vec<Placed<D>>,
}

impl<const D: usize> Places<D> {
    /// Places the elements `members` for look-ups of up to `reach`.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(crate) fn new(
        members: &[u32],
        place: impl Fn(u32) -> Vector<D>,
        reach: f64,
        meter: &mut Meter<'_>,
    ) -> Result<Self> {
        let bounds = Bounds::around(members.iter().map(|&e| place(e)));
        let bounds = if bounds.is_empty() { Bounds::new(Vector::ZERO, Vector::ZERO) } else { bounds };
        let size = |v: Vector<D>| v.0.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let reach = reach * (1.0 + SLACK.0) + SLACK.1 * (size(bounds.min) + size(bounds.max));
        let bounds = bounds.grown(reach);
        let cell = reach / if D == 2 { CELLS.0 } else { CELLS.1 };
        let counts = bounds.size().0.map(|side| ((side / cell).ceil() as usize).clamp(1, 1 << 12));
        let lattice = Lattice::at_most(bounds, counts, false, MOST.0 * members.len() + MOST.1);
        // A place on the border between two cells may fall into either.
        let half = lattice.cell() * (0.5 + SLACK.0);
        let is_near = |p: Vector<D>, at: [isize; D]| {
            let offset = lattice.centre_at(at) - p;
            let beyond: f64 = (0..D).map(|k| (offset[k].abs() - half[k]).max(0.0).powi(2)).sum();
            beyond <= reach * reach
        };
        let mut starts = vec![0_u32; lattice.count() + 1];
        let mut looked = 0;
        for &e in members {
            lattice.around(place(e), reach + half.norm(), |c, at| {
                looked += 1;
                starts[c + 1] += u32::from(is_near(place(e), at));
            });
            meter.spend(WORK * std::mem::take(&mut looked))?;
        }
        for c in 1..starts.len() {
            starts[c] += starts[c - 1];
        }
        let mut next = starts.clone();
        let nobody = Placed { place: Vector::ZERO, element: 0 };
        let mut near = vec![nobody; starts.last().map_or(0, |&n| n as usize)];
        for &element in members {
            let place = place(element);
            lattice.around(place, reach + half.norm(), |c, at| {
                looked += 1;
                if is_near(place, at) {
                    near[next[c] as usize] = Placed { place, element };
                    next[c] += 1;
                }
            });
            meter.spend(WORK * std::mem::take(&mut looked))?;
        }
        Ok(Self { lattice, starts, near })
    }

    /// At least the elements within reach of a place.
    #[inline]
    pub(crate) fn near(&self, p: Vector<D>) -> &[Placed<D>] {
        match self.lattice.at(p) {
            Some(c) => &self.near[self.starts[c] as usize..self.starts[c + 1] as usize],
            None => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Budget, Stage, Stream};

    use super::*;

    fn check<const D: usize>(count: u32, side: f64, at: f64, reach: f64) {
        let mut random = Stream::new(7, Stage::TEST, u64::from(count));
        let places: Vec<Vector<D>> =
            (0..count).map(|_| Vector(std::array::from_fn(|_| at + random.range(0.0, side)))).collect();
        let members: Vec<u32> = (0..count).collect();
        let budget = Budget::default();
        let raster = Places::new(&members, |e| places[e as usize], reach, &mut budget.meter()).unwrap();
        for _ in 0..500 {
            let p = Vector(std::array::from_fn(|_| at + random.range(-2.0 * reach, side + 2.0 * reach)));
            let near = raster.near(p);
            assert!(near.windows(2).all(|w| w[0].element < w[1].element));
            for &e in &members {
                let is_near = (places[e as usize] - p).norm() <= reach;
                assert!(!is_near || near.iter().any(|other| other.element == e), "{e} at {p:?}");
            }
        }
        let most = if D == 2 { 40 } else { 60 };
        assert!(raster.near.len() <= most * count as usize, "{} entries", raster.near.len());
    }

    #[test]
    fn nobody_within_reach_is_missed() {
        check::<2>(300, 10.0, 0.0, 0.6);
        check::<2>(300, 1e-3, 1e6, 1e-4);
        check::<3>(200, 4.0, -2.0, 0.5);
        check::<2>(5, 1e4, 0.0, 0.1);
        check::<2>(1, 0.0, 3.0, 0.5);
    }

    #[test]
    fn a_class_without_elements_finds_nobody() {
        let raster = Places::<2>::new(&[], |_| Vector::ZERO, 1.0, &mut Budget::default().meter()).unwrap();
        assert!(raster.near(Vector::ZERO).is_empty());
    }
}
