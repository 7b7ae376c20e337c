//! Which elements look alike after one of them is turned or reflected.

use arabesque_core::{Budget, Element, Matrix, Outline, Result, Segment, Vector, segment};

/// Outlines are alike when they are nowhere farther apart than this share of their radius.
const ALIKE: f64 = 0.08;

/// Colours are alike when no channel differs by more.
const COLOUR: f64 = 0.06;

/// Work for a corner and an edge that are compared.
const COMPARE: u64 = 2;

/// An element about its place.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    class: usize,
    colour: [f64; 3],
    radius: f64,
    area: f64,
    /// Corners and middles of edges, and the edges.
    points: Vec<Vector<2>>,
    edges: Vec<Segment<2>>,
}

impl Shape {
    pub(super) fn of(element: &Element<2>, place: Vector<2>) -> Self {
        let outline: &Outline<2> = &element.outline;
        let edges: Vec<Segment<2>> = outline.edges().map(|(a, b)| (a - place, b - place)).collect();
        let points = edges.iter().flat_map(|&(a, b)| [a, (a + b) * 0.5]).collect();
        let (class, colour) = (element.class, element.colour);
        Self { class, colour, radius: outline.radius(place), area: outline.area().abs(), points, edges }
    }

    /// Whether this one, after `by`, looks like the other.
    pub(super) fn becomes(&self, other: &Self, by: &Matrix<2>, budget: &Budget) -> Result<bool> {
        if self.edges.is_empty() || other.edges.is_empty() {
            return Ok(self.class == other.class && self.edges.len() == other.edges.len());
        }
        let slack = ALIKE * self.radius.max(other.radius);
        let is_near = |a: f64, b: f64| (a - b).abs() <= 2.5 * ALIKE * a.max(b);
        if (self.radius - other.radius).abs() > slack
            || !is_near(self.area, other.area)
            || self.colour.iter().zip(&other.colour).any(|(a, b)| (a - b).abs() > COLOUR)
        {
            return Ok(false);
        }
        Ok(self.lies_on(other, by, slack, budget)? && other.lies_on(self, &by.transpose(), slack, budget)?)
    }

    fn lies_on(&self, other: &Self, by: &Matrix<2>, slack: f64, budget: &Budget) -> Result<bool> {
        for &p in &self.points {
            budget.spend(COMPARE * other.edges.len() as u64)?;
            let p = by.apply(p);
            if !other.edges.iter().any(|&edge| segment::distance(edge, p) <= slack) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
