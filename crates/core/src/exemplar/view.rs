//! The part of the plane or of space of which an exemplar tells everything.

use crate::space::{Bounds, Vector};

/// What an exemplar shows: everything in a box, except in a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<const D: usize> {
    /// The box.
    pub window: Bounds<D>,
    /// The hole in it.
    pub hole: Option<Bounds<D>>,
}

impl<const D: usize> From<Bounds<D>> for View<D> {
    /// The whole box.
    fn from(window: Bounds<D>) -> Self {
        Self { window, hole: None }
    }
}

impl<const D: usize> View<D> {
    /// Whether a place is shown.
    pub fn contains(&self, p: Vector<D>) -> bool {
        self.window.contains(p) && !self.hole.is_some_and(|hole| hole.contains(p))
    }

    /// Distance to the border of what is shown: positive inside, negative outside.
    pub fn signed_distance(&self, p: Vector<D>) -> f64 {
        self.window.signed_distance(p).min(self.from_hole(p))
    }

    /// Distance to the hole; infinite without one.
    pub fn from_hole(&self, p: Vector<D>) -> f64 {
        self.hole.map_or(f64::INFINITY, |hole| -hole.signed_distance(p))
    }

    /// How far across it can be seen at least: the shorter side of the box, or of the widest of the strips beside the hole.
    pub fn side(&self) -> f64 {
        let across = |b: &Bounds<D>| b.size().0.into_iter().fold(f64::INFINITY, f64::min);
        let Some(hole) = self.hole else { return across(&self.window) };
        let strips = (0..D).flat_map(|k| {
            let (mut before, mut after) = (self.window, self.window);
            before.max[k] = before.max[k].min(hole.min[k]);
            after.min[k] = after.min[k].max(hole.max[k]);
            [before, after]
        });
        strips.map(|strip| across(&strip)).fold(0.0, f64::max)
    }

    /// Area or volume of what is shown.
    pub fn measure(&self) -> f64 {
        let common = |hole: Bounds<D>| {
            Bounds::new(hole.min.zip(self.window.min, f64::max), hole.max.zip(self.window.max, f64::min))
        };
        let lost = self.hole.map(common).filter(|hole| !hole.is_empty()).map_or(0.0, |hole| hole.measure());
        self.window.measure() - lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(min: f64, max: f64) -> Bounds<2> {
        Bounds::new(Vector::xy(min, min), Vector::xy(max, max))
    }

    #[test]
    fn a_hole_is_not_shown() {
        let view = View { window: square(0.0, 100.0), hole: Some(square(40.0, 60.0)) };
        assert!(view.contains(Vector::xy(30.0, 50.0)) && !view.contains(Vector::xy(50.0, 50.0)));
        assert!(!view.contains(Vector::xy(101.0, 50.0)));
        assert_eq!(view.signed_distance(Vector::xy(30.0, 50.0)), 10.0);
        assert_eq!(view.signed_distance(Vector::xy(5.0, 50.0)), 5.0);
        assert!(view.signed_distance(Vector::xy(45.0, 50.0)) < 0.0);
        assert_eq!((view.measure(), view.side()), (9600.0, 40.0));
        let whole = View::from(square(0.0, 100.0));
        assert_eq!((whole.measure(), whole.side(), whole.from_hole(Vector::ZERO)), (1e4, 100.0, f64::INFINITY));
    }

    #[test]
    fn only_what_a_hole_takes_of_the_window_counts() {
        let window = square(0.0, 100.0);
        assert_eq!(View { window, hole: Some(square(90.0, 120.0)) }.measure(), 9900.0);
        assert_eq!(View { window, hole: Some(square(120.0, 130.0)) }.measure(), 1e4);
    }
}
