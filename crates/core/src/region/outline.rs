//! Outlines of elements, and exact questions about them.

use crate::{
    region::{ring, segment::Segment},
    space::{Bounds, Similarity, Vector},
};

/// A closed polygon; the last point is joined to the first, which is not repeated.
pub type Ring<const D: usize> = Vec<Vector<D>>;

/// How overlapping rings enclose area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillRule {
    /// Inside where the winding number is not zero.
    NonZero,
    /// Inside where the winding number is odd.
    EvenOdd,
}

/// The ink of an element, fills and stroke widths together, as polygons.
///
/// In 2D: disjoint areas, outer rings and holes with opposite turning sense, as [`Outline::try_union`] makes them.
/// No rings at all means a point: exemplars from point files, and everything in 3D so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline<const D: usize> {
    /// The polygons.
    pub rings: Vec<Ring<D>>,
}

impl<const D: usize> Outline<D> {
    /// Smallest box around the rings; empty for a point.
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.points())
    }

    /// All ring points, ring by ring.
    pub fn points(&self) -> impl Iterator<Item = Vector<D>> + '_ {
        self.rings.iter().flatten().copied()
    }

    /// The outline moved by `transform`.
    pub fn transformed(&self, transform: &Similarity<D>) -> Self {
        Self { rings: self.rings.iter().map(|ring| ring.iter().map(|&p| transform.apply(p)).collect()).collect() }
    }

    /// Largest distance of a ring point from `centre`; 0 for a point.
    pub fn radius(&self, centre: Vector<D>) -> f64 {
        self.points().map(|p| (p - centre).norm2()).fold(0.0, f64::max).sqrt()
    }
}

impl Outline<2> {
    /// Area, holes taken out.
    pub fn area(&self) -> f64 {
        self.rings.iter().map(|r| ring::area(r)).sum::<f64>().abs()
    }

    /// Centre of area; the mean of the ring points where the area vanishes, `None` for a point.
    pub fn centroid(&self) -> Option<Vector<2>> {
        let origin = *self.rings.iter().flatten().next()?;
        let (mut area, mut moment) = (0.0, Vector::ZERO);
        for (a, b) in self.edges() {
            let (a, b) = (a - origin, b - origin);
            let cross = a.cross(b);
            area += cross;
            moment += (a + b) * cross;
        }
        let extent = self.bounds().size();
        if area.abs() > 1e-12 * extent.norm2() {
            return Some(origin + moment * (1.0 / (3.0 * area)));
        }
        let (n, sum) = self.points().fold((0.0, Vector::ZERO), |(n, sum), p| (n + 1.0, sum + p));
        Some(sum * (1.0 / n))
    }

    /// Whether `p` is covered.
    pub fn contains(&self, p: Vector<2>) -> bool {
        ring::covers(self.edges(), p)
    }

    /// The edges of all rings, start and end.
    pub fn edges(&self) -> impl Iterator<Item = Segment<2>> + '_ {
        self.rings.iter().flat_map(|r| ring::edges(r))
    }
}
