//! What one cell of an exemplar holds, and whether an operation takes it to itself.

use arabesque_core::{Budget, Exemplar, Matrix, Result, Vector};

use crate::repeat::{
    description::{Explains, Repeat},
    lattice::Lattice,
    marks::place_of,
    orbits::orbits,
    symmetry::{lines::CellLines, shapes::Shape, torus::Torus},
};

/// How far a place may lie off: as a share of the shorter vector, of the mean distance of places, and in terms of the
/// jitter.
const TOLERANCE: (f64, f64, f64) = (0.02, 0.1, 3.0);

/// Places without a partner, as a share of all, that are forgiven.
const FORGIVEN: f64 = 0.02;

/// Work for each place that is looked up.
const LOOK: u64 = 12;

/// The content of a cell.
pub(super) struct Content {
    lattice: Lattice,
    /// The shapes that differ, each as it lies.
    shapes: Vec<Shape>,
    /// Places of elements, with the numbers of their shapes.
    places: Vec<(Vector<2>, usize)>,
    index: Torus<usize>,
    lines: CellLines,
    tolerance: f64,
}

/// An operation that takes the content to itself: a linear map, then a shift.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operation {
    pub(super) shift: Vector<2>,
}

impl Content {
    /// The content of a cell of `lattice`, which is that of the repeat, or one that has it within.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(super) fn new(exemplar: &Exemplar<2>, repeat: &Repeat, lattice: Lattice, budget: &Budget) -> Result<Self> {
        let (orbits, _) = orbits(exemplar, repeat, budget)?;
        let mut shapes: Vec<Shape> = Vec::new();
        let mut places = Vec::new();
        for orbit in &orbits {
            let Some(first) = orbit.instances.first() else { continue };
            let element = &exemplar.elements[first.element as usize];
            let shape = Shape::of(element, place_of(element, repeat.anchor));
            let number = match repeat.explains {
                Explains::Places => (!shapes.is_empty()).then_some(0),
                Explains::Everything => {
                    let mut known = None;
                    for (k, other) in shapes.iter().enumerate() {
                        if shape.becomes(other, &Matrix::identity(), budget)? {
                            known = Some(k);
                            break;
                        }
                    }
                    known
                }
            };
            if number.is_none() {
                shapes.push(shape);
            }
            // Where it is in the exemplar: the sides of a frieze are not to be folded over.
            let place = orbit.base + repeat.lattice.at(first.node);
            places.push((place, number.unwrap_or(shapes.len() - 1)));
        }
        if repeat.explains == Explains::Places {
            shapes.clear();
        }
        let shorter = repeat.lattice.shorter();
        let unit = (repeat.lattice.cell() / places.len().max(1) as f64).sqrt();
        let tolerance = (TOLERANCE.0 * shorter).min(TOLERANCE.1 * unit).max(TOLERANCE.2 * repeat.jitter);
        let mut index = Torus::new(lattice, tolerance);
        places.iter().for_each(|&(place, shape)| index.insert(place, shape));
        let lines = CellLines::new(exemplar, lattice, budget)?;
        Ok(Self { lattice, shapes, places, index, lines, tolerance })
    }

    /// Whether there is nothing in it.
    pub(super) fn is_empty(&self) -> bool {
        self.places.is_empty() && self.lines.is_empty()
    }

    /// A shift with which a linear map takes the content to itself; all others differ from it by nodes of the lattice.
    ///
    /// # Errors
    /// When the budget is used up, or somebody asks to stop.
    pub(super) fn operation(&self, linear: &Matrix<2>, budget: &Budget) -> Result<Option<Operation>> {
        let becomes = self.becomes(linear, budget)?;
        let counts = |shape: usize| self.places.iter().filter(|(_, other)| *other == shape).count();
        let rarest = (0..becomes.len()).min_by_key(|&shape| (counts(shape), shape));
        let anchors = match rarest {
            Some(rarest) => {
                let from = self.places.iter().find(|(_, shape)| *shape == rarest).map(|(place, _)| *place);
                let to = self.places.iter().filter(|(_, shape)| becomes[rarest][*shape]).map(|(place, _)| *place);
                from.map(|from| (from, to.collect()))
            }
            None => self.lines.anchors(self.lattice, linear),
        };
        let Some((from, to)): Option<(Vector<2>, Vec<Vector<2>>)> = anchors else { return Ok(None) };
        for there in to {
            let shift = there - linear.apply(from);
            if self.admits(linear, shift, &becomes, budget)?
                && (self.lines.is_empty() || self.lines.admit(linear, shift, budget)?)
            {
                return Ok(Some(Operation { shift }));
            }
        }
        Ok(None)
    }

    /// Which shape looks like which after a linear map; where shapes do not count, there is one that looks like itself.
    fn becomes(&self, linear: &Matrix<2>, budget: &Budget) -> Result<Vec<Vec<bool>>> {
        if self.shapes.is_empty() {
            return Ok(if self.places.is_empty() { Vec::new() } else { vec![vec![true]] });
        }
        let row = |from: &Shape| self.shapes.iter().map(|to| from.becomes(to, linear, budget)).collect();
        self.shapes.iter().map(row).collect()
    }

    fn admits(&self, linear: &Matrix<2>, shift: Vector<2>, becomes: &[Vec<bool>], budget: &Budget) -> Result<bool> {
        let (mut lost, mut work) = (0_usize, 0);
        for &(place, shape) in &self.places {
            let there = linear.apply(place) + shift;
            let (found, looked) = self.index.has(there, self.tolerance, |&other| becomes[shape][other]);
            work += looked;
            lost += usize::from(!found);
            if lost as f64 > FORGIVEN * self.places.len() as f64 {
                break;
            }
        }
        budget.spend(LOOK * work)?;
        Ok(lost as f64 <= FORGIVEN * self.places.len() as f64)
    }
}
