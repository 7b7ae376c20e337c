//! Axis-aligned boxes.

use crate::space::{Vector, cell_place};

/// An axis-aligned box, `min` to `max` in every coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize> {
    /// Smallest coordinates.
    pub min: Vector<D>,
    /// Largest coordinates.
    pub max: Vector<D>,
}

impl<const D: usize> Bounds<D> {
    /// The box that holds nothing; joining a point to it gives that point.
    pub const EMPTY: Self = Self { min: Vector::splat(f64::INFINITY), max: Vector::splat(f64::NEG_INFINITY) };

    /// Box from corner to corner.
    pub const fn new(min: Vector<D>, max: Vector<D>) -> Self {
        Self { min, max }
    }

    /// Smallest box around the points; [`Bounds::EMPTY`] for none.
    pub fn around(points: impl IntoIterator<Item = Vector<D>>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::joined)
    }

    /// This box grown to hold `p`.
    pub fn joined(self, p: Vector<D>) -> Self {
        Self { min: self.min.zip(p, f64::min), max: self.max.zip(p, f64::max) }
    }

    /// Smallest box around two boxes.
    pub fn union(self, other: &Self) -> Self {
        Self { min: self.min.zip(other.min, f64::min), max: self.max.zip(other.max, f64::max) }
    }

    /// This box with every side moved outwards by `margin` (inwards when negative).
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - Vector::splat(margin), max: self.max + Vector::splat(margin) }
    }

    /// Side lengths; negative for an empty box.
    pub fn size(&self) -> Vector<D> {
        self.max - self.min
    }

    /// Midpoint.
    pub fn centre(&self) -> Vector<D> {
        (self.min + self.max) * 0.5
    }

    /// Product of the side lengths: area or volume; 0 for an empty box.
    pub fn measure(&self) -> f64 {
        self.size().0.iter().map(|s| s.max(0.0)).product()
    }

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        (0..D).any(|k| self.min[k] > self.max[k])
    }

    /// Whether `p` lies inside or on the box.
    pub fn contains(&self, p: Vector<D>) -> bool {
        (0..D).all(|k| self.min[k] <= p[k] && p[k] <= self.max[k])
    }

    /// Whether the two boxes share a point.
    pub fn intersects(&self, other: &Self) -> bool {
        (0..D).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Distance to the boundary: positive inside, negative outside.
    pub fn signed_distance(&self, p: Vector<D>) -> f64 {
        let inside = (0..D).map(|k| (p[k] - self.min[k]).min(self.max[k] - p[k])).fold(f64::INFINITY, f64::min);
        if inside >= 0.0 {
            return inside;
        }
        -(p - self.clamp(p)).norm()
    }

    /// Nearest point of the box to `p`.
    pub fn clamp(&self, p: Vector<D>) -> Vector<D> {
        Vector(std::array::from_fn(|k| p[k].max(self.min[k]).min(self.max[k])))
    }

    /// Centre of cell `index` where the box is cut into `counts` equal cells, the first coordinate fastest.
    pub fn cell_centre(&self, index: usize, counts: &[usize; D]) -> Vector<D> {
        let (place, size) = (cell_place(index, counts), self.size());
        Vector(std::array::from_fn(|k| self.min[k] + size[k] * (place[k] as f64 + 0.5) / counts[k] as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_box() {
        let b = Bounds::new(Vector::xy(1.0, 2.0), Vector::xy(5.0, 8.0));
        let centres: Vec<_> = (0..6).map(|index| b.cell_centre(index, &[2, 3])).collect();
        assert_eq!(centres[..3], [Vector::xy(2.0, 3.0), Vector::xy(4.0, 3.0), Vector::xy(2.0, 5.0)]);
        assert_eq!(Bounds::around(centres), Bounds::new(Vector::xy(2.0, 3.0), Vector::xy(4.0, 7.0)));
    }
}
