//! Outlines of elements, and exact questions about them.

use i_overlay::{
    core::{fill_rule::FillRule as Rule, overlay_rule::OverlayRule},
    float::{simplify::SimplifyShape, single::SingleFloatOverlay},
    mesh::{
        float::outline::offset::OutlineOffset,
        float::style::{LineJoin, OutlineStyle},
    },
};

use crate::{
    region::{ring, segment::Segment},
    space::{Bounds, Similarity, Vector},
};

/// Rounded corners are polygons with an edge for every so many radians.
const ROUND: f64 = 0.1;

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
/// In 2D: disjoint areas, outer rings and holes with opposite turning sense, as [`Outline::union`] makes them.
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
    /// The area covered by `rings` under `rule`, as disjoint polygons without self-crossings.
    pub fn union(rings: &[Ring<2>], rule: FillRule) -> Self {
        let rule = match rule {
            FillRule::NonZero => Rule::NonZero,
            FillRule::EvenOdd => Rule::EvenOdd,
        };
        Self::from_shapes(to_arrays(rings).simplify_shape(rule))
    }

    /// The part that both outlines cover.
    pub fn intersection(&self, other: &Self) -> Self {
        self.overlay(other, OverlayRule::Intersect)
    }

    /// The part of this outline that `other` does not cover.
    pub fn difference(&self, other: &Self) -> Self {
        self.overlay(other, OverlayRule::Difference)
    }

    /// Everything within `distance` of the outline, corners rounded; with a negative `distance` everything at least so far inside.
    pub fn grown(&self, distance: f64) -> Self {
        if self.rings.is_empty() || distance == 0.0 {
            return self.clone();
        }
        let style = OutlineStyle::new(distance).line_join(LineJoin::Round(ROUND));
        Self::from_shapes(to_arrays(&self.rings).outline(&style))
    }

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

    /// Whether the two outlines share area.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.bounds().intersects(&other.bounds()) && !self.intersection(other).rings.is_empty()
    }

    /// The edges of all rings, start and end.
    pub fn edges(&self) -> impl Iterator<Item = Segment<2>> + '_ {
        self.rings.iter().flat_map(|r| ring::edges(r))
    }

    fn overlay(&self, other: &Self, rule: OverlayRule) -> Self {
        if self.rings.is_empty() {
            return Self::default();
        }
        if other.rings.is_empty() {
            return if rule == OverlayRule::Difference { self.clone() } else { Self::default() };
        }
        Self::from_shapes(to_arrays(&self.rings).overlay(&to_arrays(&other.rings), rule, Rule::EvenOdd))
    }

    fn from_shapes(shapes: Vec<Vec<Vec<[f64; 2]>>>) -> Self {
        let rings = shapes.into_iter().flatten().map(|ring| ring.into_iter().map(Vector).collect()).collect();
        Self { rings }
    }
}

fn to_arrays(rings: &[Ring<2>]) -> Vec<Vec<[f64; 2]>> {
    rings.iter().map(|ring| ring.iter().map(|p| p.0).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Ring<2> {
        vec![Vector::xy(x, y), Vector::xy(x + side, y), Vector::xy(x + side, y + side), Vector::xy(x, y + side)]
    }

    #[test]
    fn union_of_two_overlapping_squares_counts_the_overlap_once() {
        let u = Outline::union(&[square(0.0, 0.0, 2.0), square(1.0, 0.0, 2.0)], FillRule::NonZero);
        assert!((u.area() - 6.0).abs() < 1e-6);
    }

    #[test]
    fn a_hole_is_not_inside() {
        let frame = Outline::union(&[square(0.0, 0.0, 4.0), square(1.0, 1.0, 2.0)], FillRule::EvenOdd);
        assert!((frame.area() - 12.0).abs() < 1e-6);
        assert!(frame.contains(Vector::xy(0.5, 0.5)));
        assert!(!frame.contains(Vector::xy(2.0, 2.0)));
        assert!((frame.centroid().unwrap() - Vector::xy(2.0, 2.0)).norm() < 1e-6);
    }

    #[test]
    fn touching_squares_do_not_overlap() {
        let a = Outline { rings: vec![square(0.0, 0.0, 1.0)] };
        let b = Outline { rings: vec![square(1.0, 0.0, 1.0)] };
        let c = Outline { rings: vec![square(0.9, 0.0, 1.0)] };
        assert!(!a.overlaps(&b));
        assert!(a.overlaps(&c));
        assert!((a.intersection(&c).area() - 0.1).abs() < 1e-6);
    }
}
