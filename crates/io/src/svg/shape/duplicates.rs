//! Strokes that lie on top of each other, whatever their nodes, their direction and, on closed ones, where they start.

use std::collections::BTreeMap;

use arabesque_core::{Bounds, Budget, Measured, Path, Result, Vector, segment};

/// Strokes nearer to each other than this share of the diagonal of the window lie on top of each other.
pub(crate) const NEAR: f64 = 1e-4;

/// Places along a stroke at which it is compared.
const PLACES: usize = 24;

/// Work for a look at a stroke that may be the same, and for each place compared with each point.
const LOOK: u64 = 50;
const PER_PLACE: u64 = 4;

/// A style, and a cell of the grid.
type GridCell = (usize, [i64; 2]);

/// Strokes by their lengths, whose bits are in the order of the numbers.
type ByLength = BTreeMap<u64, Vec<Known>>;

/// A stroke, with the box around it.
#[derive(Debug)]
struct Known {
    /// How many were there before it.
    number: usize,
    bounds: Bounds<2>,
    line: Measured<2>,
}

/// The strokes so far.
#[derive(Debug)]
pub(crate) struct Seen {
    near: f64,
    count: usize,
    /// By style and by the cell in which a corner of the box around them lies.
    cells: BTreeMap<GridCell, ByLength>,
}

impl Seen {
    /// None, in a drawing of this size.
    pub(crate) fn new(window: &Bounds<2>) -> Self {
        Self::nearer_than(NEAR * window.size().norm())
    }

    /// None, where strokes nearer to each other than `near` lie on top of each other.
    pub(crate) fn nearer_than(near: f64) -> Self {
        Self { near: near.max(f64::MIN_POSITIVE), count: 0, cells: BTreeMap::new() }
    }

    /// Adds a stroke. Returns whether none like it was there.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub(crate) fn insert(&mut self, style: usize, path: &Path<2>, budget: &Budget) -> Result<bool> {
        Ok(self.find_or_add(style, path, budget)?.is_none())
    }

    /// The number of a stroke like this, counted from 0 as they were added; where there is none, adds it.
    ///
    /// # Errors
    /// As [`Budget::spend`].
    pub(crate) fn find_or_add(&mut self, style: usize, path: &Path<2>, budget: &Budget) -> Result<Option<usize>> {
        let measured = Measured::new(path.clone(), 0.2 * self.near);
        let bounds = Bounds::around(measured.points().iter().copied());
        let corner = Vector::xy(bounds.min[0], bounds.max[1]) * (1.0 / (2.0 * self.near));
        let cell = [corner[0].floor() as i64, corner[1].floor() as i64];
        let length = measured.length();
        let off = self.near.max(2e-3 * length);
        let lengths = (length - off).max(0.0).to_bits()..=(length + off).to_bits();
        let around =
            (-1..=1).flat_map(|x| (-1..=1).map(move |y| [cell[0].saturating_add(x), cell[1].saturating_add(y)]));
        let known = around.filter_map(|cell| self.cells.get(&(style, cell)));
        let known = known.flat_map(|cell| cell.range(lengths.clone())).flat_map(|(_, alike)| alike);
        let new = Known { number: self.count, bounds, line: measured };
        for other in known {
            budget.spend(LOOK)?;
            if self.may_be_same(other, &new) {
                budget
                    .spend(PER_PLACE * PLACES as u64 * (other.line.points().len() + new.line.points().len()) as u64)?;
                if self.is_same(other, &new) {
                    return Ok(Some(other.number));
                }
            }
        }
        self.count += 1;
        self.cells.entry((style, cell)).or_default().entry(length.to_bits()).or_default().push(new);
        Ok(None)
    }

    /// Whether two strokes have the same extent and length.
    fn may_be_same(&self, a: &Known, b: &Known) -> bool {
        let same = |p: Vector<2>, q: Vector<2>| (p - q).norm() <= self.near;
        let alike = same(a.bounds.min, b.bounds.min)
            && same(a.bounds.max, b.bounds.max)
            && a.line.is_closed() == b.line.is_closed();
        let length = a.line.length();
        alike && (length - b.line.length()).abs() <= self.near.max(1e-3 * length)
    }

    /// Whether two such strokes run along each other.
    fn is_same(&self, a: &Known, b: &Known) -> bool {
        let places = |m: &Measured<2>| (0..=PLACES).map(|k| m.point(m.length() * k as f64 / PLACES as f64)).collect();
        let on = |places: Vec<Vector<2>>, line: &Measured<2>| places.iter().all(|p| distance(*p, line) <= self.near);
        on(places(&b.line), &a.line) && on(places(&a.line), &b.line)
    }
}

/// Distance of a point from the chords of a line.
fn distance(p: Vector<2>, line: &Measured<2>) -> f64 {
    line.points().windows(2).map(|w| segment::distance((w[0], w[1]), p)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn budget() -> Budget {
        Budget::default()
    }

    fn seen() -> Seen {
        Seen::new(&Bounds::new(Vector::ZERO, Vector::xy(100.0, 100.0)))
    }

    fn polyline(points: &[(f64, f64)], closed: bool) -> Path<2> {
        let points: Vec<_> = points.iter().map(|&(x, y)| Vector::xy(x, y)).collect();
        Path { closed, ..Path::polyline(&points) }
    }

    #[test]
    fn nodes_and_direction_do_not_matter() {
        let mut seen = seen();
        assert!(seen.insert(0, &polyline(&[(0.0, 10.0), (100.0, 10.0)], false), &budget()).unwrap());
        assert!(!seen.insert(0, &polyline(&[(100.0, 10.0), (70.0, 10.0), (0.0, 10.0)], false), &budget()).unwrap());
        assert!(seen.insert(1, &polyline(&[(0.0, 10.0), (100.0, 10.0)], false), &budget()).unwrap(), "another style");
        assert!(seen.insert(0, &polyline(&[(0.0, 10.1), (100.0, 10.1)], false), &budget()).unwrap(), "beside it");
        assert!(seen.insert(0, &polyline(&[(20.0, 10.0), (80.0, 10.0)], false), &budget()).unwrap(), "a part of it");
    }

    #[test]
    fn rings_may_start_anywhere() {
        let mut seen = seen();
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        let ring = |start: usize| -> Vec<(f64, f64)> { (0..=4).map(|k| corners[(start + k) % 4]).collect() };
        assert!(seen.insert(0, &polyline(&ring(0), true), &budget()).unwrap());
        assert!(!seen.insert(0, &polyline(&ring(2), true), &budget()).unwrap());
        let diagonal = [(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0), (0.0, 0.0)];
        assert!(seen.insert(0, &polyline(&diagonal, true), &budget()).unwrap(), "the same corners, another way around");
    }
}
