//! Whether points spread over the plane or space, or lie at one place, on a line or in a plane: the one answer that everybody goes by.

use crate::space::Vector;

/// What is thinner than this share of its length counts as having no width.
const THIN: f64 = 1e-9;

/// Coordinates of this size relative to each other cannot be told apart for certain.
const ROUNDING: f64 = 1e-12;

/// Over how many dimensions points spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Spread {
    /// There are no points.
    Nowhere,
    /// At one place.
    Place,
    /// On one line.
    Line,
    /// In one plane.
    Plane,
    /// In none.
    Space,
}

impl Spread {
    /// Looks at points, up to rounding: what is a thousand millionth as wide as it is long lies on a line. Takes time in proportion to the
    /// number of points.
    pub fn of<const D: usize>(points: impl Iterator<Item = Vector<D>> + Clone) -> Self {
        let Some(origin) = points.clone().next() else { return Self::Nowhere };
        let largest = points.clone().flat_map(|p| p.0).fold(0.0, |most: f64, v| most.max(v.abs()));
        let mut axes: Vec<Vector<D>> = Vec::new();
        let mut length = 0.0_f64;
        while axes.len() < D {
            // What the axes found so far leave of the way to the farthest point.
            let rest = |p: Vector<D>| axes.iter().fold(p - origin, |rest, axis| rest - *axis * rest.dot(*axis));
            let far = points.clone().map(rest).max_by(|a, b| a.norm2().total_cmp(&b.norm2())).unwrap_or(Vector::ZERO);
            length = length.max(far.norm());
            if far.norm() <= (THIN * length).max(ROUNDING * largest) {
                break;
            }
            axes.push(far.unit());
        }
        [Self::Place, Self::Line, Self::Plane, Self::Space][axes.len().min(3)]
    }

    /// Whether the points fill the plane, or in three dimensions space.
    pub fn fills<const D: usize>(self) -> bool {
        self as usize > D
    }

    /// Where the points lie, in words: `on one line`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Nowhere => "nowhere",
            Self::Place => "at one place",
            Self::Line => "on one line",
            Self::Plane => "in one plane",
            Self::Space => "in space",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread<const D: usize>(points: &[[f64; D]]) -> Spread {
        Spread::of(points.iter().map(|&p| Vector(p)))
    }

    #[test]
    fn points_at_one_place_on_a_line_and_in_a_plane() {
        assert_eq!(spread::<2>(&[]), Spread::Nowhere);
        assert_eq!(spread(&[[7.0, 3.0]; 4]), Spread::Place);
        assert_eq!(spread(&[[1e9, 0.1], [1e9 + 1e-4, 0.1]]), Spread::Place);
        assert_eq!(spread(&[[0.0, 0.1], [0.3, 0.4], [0.1, 0.2], [7.0, 7.1]]), Spread::Line);
        assert_eq!(spread(&[[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [0.0, 1.0, 3.0], [2.0, 2.0, 7.0]]), Spread::Plane);
        let space = spread(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(space == Spread::Space && space.fills::<3>());
    }

    #[test]
    fn a_small_set_far_from_the_origin_is_not_one_place() {
        let plane = spread(&[[1e6, 1e6], [1e6 + 1.0, 1e6], [1e6, 1e6 + 1.0]]);
        assert!(plane == Spread::Plane && plane.fills::<2>() && !plane.fills::<3>());
    }

    #[test]
    fn a_long_thin_set_is_a_line_only_when_it_has_no_width() {
        assert_eq!(spread(&[[0.0, 0.0], [1e3, 1.0], [2e3, 0.0]]), Spread::Plane);
        assert_eq!(spread(&[[0.0, 0.0], [1e3, 1e-8], [2e3, 0.0]]), Spread::Line);
    }
}
