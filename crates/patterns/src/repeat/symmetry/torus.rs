//! Things in one cell of a lattice, of which opposite sides meet.

use std::collections::BTreeMap;

use arabesque_core::Vector;

use crate::repeat::lattice::Lattice;

/// Squares along a side of the cell, at most.
const MOST: f64 = 4096.0;

/// Things at places modulo a lattice, to be asked what is near a place.
#[derive(Clone, Debug)]
pub(super) struct Torus<T> {
    lattice: Lattice,
    counts: [i64; 2],
    squares: BTreeMap<[i64; 2], Vec<(Vector<2>, T)>>,
}

impl<T> Torus<T> {
    /// Without anything in it; things are found within `reach`.
    pub(super) fn new(lattice: Lattice, reach: f64) -> Self {
        // Distance of opposite sides of the cell, in squares as wide as the reach.
        let count = |k: usize| (lattice.cell() / lattice.vectors[1 - k].norm() / reach).floor().clamp(1.0, MOST) as i64;
        Self { lattice, counts: [count(0), count(1)], squares: BTreeMap::new() }
    }

    fn square(&self, place: Vector<2>) -> ([i64; 2], Vector<2>) {
        let inside = self.lattice.coordinates(place).map(|c| c - c.floor());
        let of = |k: usize| ((inside[k] * self.counts[k] as f64) as i64).min(self.counts[k] - 1);
        ([of(0), of(1)], inside)
    }

    pub(super) fn insert(&mut self, place: Vector<2>, thing: T) {
        let (square, inside) = self.square(place);
        self.squares.entry(square).or_default().push((inside, thing));
    }

    /// Visits what may be within reach of a place, with the offset to it; tells how many things that were.
    pub(super) fn near(&self, place: Vector<2>, mut visit: impl FnMut(Vector<2>, &T)) -> u64 {
        let (square, inside) = self.square(place);
        let steps = |k: usize| match self.counts[k] {
            1 => 0..=0,
            2 => 0..=1,
            _ => -1..=1,
        };
        let mut looked = 0;
        for i in steps(0) {
            for j in steps(1) {
                let key = [(square[0] + i).rem_euclid(self.counts[0]), (square[1] + j).rem_euclid(self.counts[1])];
                for (there, thing) in self.squares.get(&key).into_iter().flatten() {
                    looked += 1;
                    let apart = (*there - inside).map(|c| c - c.round());
                    visit(self.lattice.vector(apart), thing);
                }
            }
        }
        looked + 9
    }

    /// Whether something that passes a test lies within a distance.
    pub(super) fn has(&self, place: Vector<2>, within: f64, test: impl Fn(&T) -> bool) -> (bool, u64) {
        let mut found = false;
        let looked = self.near(place, |offset, thing| found = found || (offset.norm() <= within && test(thing)));
        (found, looked)
    }
}
