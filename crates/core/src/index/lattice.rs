//! Equal cells over a box, and the walk through those around a point.

use std::ops::Range;

use crate::space::{Bounds, Vector, cell_index, cell_place};

/// A box cut into equal cells, numbered with the first coordinate fastest. Where the coordinates have a period, the box is one
/// period, and what leaves it on one side comes in on the other.
#[derive(Clone, Debug)]
pub struct Lattice<const D: usize> {
    origin: Vector<D>,
    cell: Vector<D>,
    counts: [usize; D],
    is_periodic: bool,
    /// The cells that are numbered: so many from the first one on along each coordinate, around the back where there is a period.
    first: [usize; D],
    held: [usize; D],
}

impl<const D: usize> Lattice<D> {
    /// `counts[k]` cells along coordinate `k` of the box, each at least 1.
    pub fn new(bounds: Bounds<D>, counts: [usize; D], is_periodic: bool) -> Self {
        let size = bounds.size();
        let cell = Vector(std::array::from_fn(|k| (size[k] / counts[k] as f64).max(f64::MIN_POSITIVE)));
        Self { origin: bounds.min, cell, counts, is_periodic, first: [0; D], held: counts }
    }

    /// The cells that the box around a ball touches, as a lattice of their own: places are the same, the numbers are those that
    /// [`Lattice::around`] comes by. What is asked of other cells finds none.
    pub fn part(&self, p: Vector<D>, radius: f64) -> Self {
        let (low, held) = self.touched(p, radius);
        let first = std::array::from_fn(|k| low[k].rem_euclid(self.counts[k] as isize) as usize);
        Self { first, held, ..self.clone() }
    }

    /// A lattice of about `counts[k]` cells along coordinate `k`, of fewer where that would be more than `most` together.
    pub fn at_most(bounds: Bounds<D>, mut counts: [usize; D], is_periodic: bool, most: usize) -> Self {
        while counts.iter().fold(1, |all: usize, &n| all.saturating_mul(n)) > most.max(1) {
            if let Some(longest) = counts.iter_mut().max() {
                *longest = longest.div_ceil(2);
            }
        }
        Self::new(bounds, counts, is_periodic)
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.held.iter().product()
    }

    /// Side lengths of a cell.
    pub fn cell(&self) -> Vector<D> {
        self.cell
    }

    /// Centre of the cell with number `index`.
    pub fn centre(&self, index: usize) -> Vector<D> {
        let place = cell_place(index, &self.held);
        self.centre_at(std::array::from_fn(|k| ((self.first[k] + place[k]) % self.counts[k]) as isize))
    }

    /// Centre of the cell that lies so many cells from the first one along each coordinate, inside the box or beyond it.
    pub fn centre_at(&self, place: [isize; D]) -> Vector<D> {
        Vector(std::array::from_fn(|k| self.origin[k] + (place[k] as f64 + 0.5) * self.cell[k]))
    }

    /// Number of the cell at `p`; `None` outside the box, which a period does not have.
    #[inline]
    pub fn at(&self, p: Vector<D>) -> Option<usize> {
        let (mut index, mut stride) = (0, 1);
        for k in 0..D {
            let n = self.counts[k];
            let mut i = floor((p[k] - self.origin[k]) / self.cell[k]);
            if i < 0 || i >= n as isize {
                if !self.is_periodic {
                    return None;
                }
                i = i.rem_euclid(n as isize);
            }
            let i = self.numbered(k, i as usize);
            if i >= self.held[k] {
                return None;
            }
            index += i * stride;
            stride *= self.held[k];
        }
        Some(index)
    }

    /// The number along coordinate `k` of the cell that is the `i`-th of the box; none that there is for one that is not numbered.
    #[inline]
    fn numbered(&self, k: usize, i: usize) -> usize {
        let first = self.first[k];
        if i >= first { i - first } else { i + self.counts[k] - first }
    }

    /// Number of the cell of the box that is nearest to `p`, whether there is a period or not.
    pub fn nearest(&self, p: Vector<D>) -> usize {
        let at = |k: usize| {
            let i = (((p[k] - self.origin[k]) / self.cell[k]).max(0.0) as usize).min(self.counts[k] - 1);
            self.numbered(k, i).min(self.held[k] - 1)
        };
        cell_index(std::array::from_fn(at), &self.held)
    }

    /// The first cell that the box around a ball touches, and how many along each coordinate.
    #[inline]
    fn touched(&self, p: Vector<D>, radius: f64) -> ([isize; D], [usize; D]) {
        let mut low = [0_isize; D];
        let mut count = [0_usize; D];
        for k in 0..D {
            let at = |v: f64| floor((v - self.origin[k]) / self.cell[k]);
            let (mut a, mut b) = (at(p[k] - radius), at(p[k] + radius));
            if !self.is_periodic {
                let last = self.counts[k] as isize - 1;
                (a, b) = (a.clamp(0, last), b.clamp(0, last));
            }
            low[k] = a;
            count[k] = (b.saturating_sub(a).max(0) as usize).saturating_add(1).min(self.counts[k]);
        }
        (low, count)
    }

    /// Calls `visit(index, place)` for the cells that the box around a ball touches, each once and in a fixed order. Without a period
    /// these are cells of the lattice alone, the outermost ones for what lies beyond them. With one, a `place` beyond the box is
    /// where the cell comes to lie around the back.
    #[inline]
    pub fn around(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(usize, [isize; D])) {
        self.rows(p, radius, |cells, mut place| {
            for cell in cells {
                visit(cell, place);
                place[0] = place[0].wrapping_add(1);
            }
        });
    }

    /// The cells of [`Lattice::around`] in the same order, as many at once as have numbers that follow one another; `place` is that of the first.
    #[inline]
    pub fn rows(&self, p: Vector<D>, radius: f64, mut visit: impl FnMut(Range<usize>, [isize; D])) {
        let (low, count) = self.touched(p, radius);
        // Without a period the first cell is one of the box.
        let wrapped = |k: usize| if self.is_periodic { low[k].rem_euclid(self.counts[k] as isize) } else { low[k] };
        let from: [usize; D] = std::array::from_fn(|k| wrapped(k) as usize);
        let (row, held, first) = (self.counts[0], self.held[0], self.numbered(0, from[0]));
        let before_end = count[0].min(row - first);
        let (mut step, mut at) = ([0_usize; D], from);
        loop {
            let (mut start, mut stride, mut is_held) = (0, held, true);
            for k in 1..D {
                let i = self.numbered(k, at[k]);
                is_held &= i < self.held[k];
                start += i * stride;
                stride *= self.held[k];
            }
            if is_held {
                let mut place: [isize; D] = std::array::from_fn(|k| low[k].wrapping_add(step[k] as isize));
                if first < held {
                    visit(start + first..start + (first + before_end).min(held), place);
                }
                // Around the back, where there is a period.
                if before_end < count[0] {
                    place[0] = place[0].wrapping_add(before_end as isize);
                    visit(start..start + (count[0] - before_end).min(held), place);
                }
            }
            let mut k = 1;
            loop {
                if k >= D {
                    return;
                }
                (step[k], at[k]) = (step[k] + 1, if at[k] + 1 == self.counts[k] { 0 } else { at[k] + 1 });
                if step[k] < count[k] {
                    break;
                }
                (step[k], at[k]) = (0, from[k]);
                k += 1;
            }
        }
    }
}

/// The largest integer that is no larger; by conversion, since the rounding of floats is a call on plain x86-64.
#[inline]
fn floor(x: f64) -> isize {
    let i = x as isize;
    if i as f64 > x { i.saturating_sub(1) } else { i }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn lattice(is_periodic: bool) -> Lattice<2> {
        Lattice::new(Bounds::new(Vector::xy(-1.0, 2.0), Vector::xy(7.0, 5.0)), [4, 3], is_periodic)
    }

    proptest! {
        #[test]
        fn a_walk_meets_every_cell_that_has_a_point_in_the_ball(
            x in -6.0..12.0, y in -3.0..10.0, radius in 0.0..9.0, is_periodic: bool,
        ) {
            let (lattice, p) = (lattice(is_periodic), Vector::xy(x, y));
            let mut met = Vec::new();
            lattice.around(p, radius, |index, place| met.push((index, place)));
            for turn in 0..16 {
                let angle = f64::from(turn) / 16.0 * std::f64::consts::TAU;
                let cell = lattice.at(p + Vector::xy(angle.cos(), angle.sin()) * (radius * 0.999));
                prop_assert!(cell.is_none_or(|cell| met.iter().any(|(index, _)| *index == cell)));
            }
            for &(index, place) in &met {
                prop_assert_eq!(lattice.at(lattice.centre_at(place)), Some(index));
                prop_assert_eq!(met.iter().filter(|m| m.0 == index).count(), 1);
            }
        }

        #[test]
        fn in_space_a_walk_meets_every_cell_of_the_box_around_the_ball_once_and_row_by_row(
            p in prop::array::uniform3(-6.0..12.0), radius in 0.0..9.0, is_periodic: bool,
        ) {
            let bounds = Bounds::new(Vector([-1.0, 2.0, 0.0]), Vector([7.0, 5.0, 5.0]));
            let (lattice, p) = (Lattice::new(bounds, [4, 3, 5], is_periodic), Vector(p));
            let mut met = Vec::new();
            lattice.around(p, radius, |index, place| met.push((index, place)));
            let (low, count) = lattice.touched(p, radius);
            prop_assert_eq!(met.len(), count.iter().product::<usize>());
            for (n, &(index, place)) in met.iter().enumerate() {
                let step = [n % count[0], n / count[0] % count[1], n / count[0] / count[1]];
                prop_assert_eq!(place, std::array::from_fn(|k| low[k] + step[k] as isize));
                prop_assert_eq!(lattice.at(lattice.centre_at(place)), Some(index));
            }
            let mut rows = Vec::new();
            lattice.rows(p, radius, |cells, _| rows.extend(cells));
            prop_assert_eq!(rows, met.iter().map(|m| m.0).collect::<Vec<_>>());
        }

        #[test]
        fn a_part_is_walked_like_the_whole(
            x in -6.0..12.0, y in -3.0..10.0, radius in 0.0..4.0, u in -1.0..1.0, v in -1.0..1.0, inner in 0.0..1.0, is_periodic: bool,
        ) {
            let (lattice, p) = (lattice(is_periodic), Vector::xy(x, y));
            let part = lattice.part(p, radius);
            let mut numbers = Vec::new();
            lattice.around(p, radius, |index, _| numbers.push(index));
            prop_assert_eq!(part.count(), numbers.len());
            for (k, &index) in numbers.iter().enumerate() {
                let centre = lattice.centre(index);
                prop_assert_eq!((part.centre(k), part.at(centre), part.nearest(centre)), (centre, Some(k), k));
            }
            // A smaller ball inside: the same cells, in the same order, at the same places.
            let (far, q) = (radius * inner, p + Vector::xy(u, v) * (radius * (1.0 - inner)));
            let (mut whole, mut walked) = (Vec::new(), Vec::new());
            lattice.around(q, far, |index, place| whole.push((index, place)));
            part.around(q, far, |k, place| walked.push((numbers[k], place)));
            prop_assert_eq!(walked, whole);
        }

        #[test]
        fn the_cell_at_a_point_holds_it(x in -0.99..6.99, y in 2.01..4.99) {
            let (lattice, p) = (lattice(false), Vector::xy(x, y));
            let cell = lattice.at(p).unwrap();
            prop_assert!((lattice.centre(cell) - p).0.iter().zip(lattice.cell().0).all(|(d, side)| d.abs() <= 0.5 * side + 1e-9));
            prop_assert_eq!(lattice.nearest(p), cell);
            let copy = p + Vector::xy(8.0, -3.0);
            prop_assert_eq!((lattice.at(copy), self::lattice(true).at(copy)), (None, Some(cell)));
        }
    }

    #[test]
    fn beyond_the_box_the_outermost_cell_is_the_nearest() {
        let lattice = lattice(false);
        assert_eq!((lattice.nearest(Vector::xy(99.0, 99.0)), lattice.nearest(Vector::xy(-99.0, 2.5))), (11, 0));
        assert_eq!(lattice.count(), 12);
    }

    #[test]
    fn too_many_cells_become_larger_ones() {
        let bounds = Bounds::new(Vector([0.0; 3]), Vector([8.0, 4.0, 1.0]));
        assert_eq!(Lattice::at_most(bounds, [8, 4, 1], false, 32).count(), 32);
        let coarse = Lattice::at_most(bounds, [1 << 40, 1 << 40, 1 << 40], false, 1000);
        assert!((125..=1000).contains(&coarse.count()), "{}", coarse.count());
        assert_eq!(Lattice::at_most(bounds, [8, 4, 1], false, 0).count(), 1);
    }
}
